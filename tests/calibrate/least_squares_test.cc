#include "sim/fit/least_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "tests/support/gram_schmidt.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// y = a + b x + c x^2, with c within bounds.
class Parabola : public LeastSquaresProblem {
 public:
  Parabola(VectorXd x, VectorXd y) : columns_(x.size(), 3), y_(std::move(y)) {
    columns_ << VectorXd::Ones(x.size()), x, x.cwiseAbs2();
  }
  VectorXd Residual(const VectorXd& parameters) override { return y_ - columns_ * parameters; }
  MatrixXd Derivatives(const VectorXd& /*parameters*/) override { return columns_; }
  void KeepWithinBounds(VectorXd& parameters) const override {
    parameters[2] = std::clamp(parameters[2], -most_, most_);
  }

  const MatrixXd& columns() const { return columns_; }
  const VectorXd& y() const { return y_; }
  void set_most(double most) { most_ = most; }

 private:
  MatrixXd columns_;
  VectorXd y_;
  double most_ = 1e9;
};

Parabola NoisyParabola(Index rows, double noise) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const VectorXd x = VectorXd::LinSpaced(rows, -1.0, 3.0);
  VectorXd y = 2.0 - 3.0 * x.array() + 0.5 * x.array().square();
  for (double& value : y) value += noise * normal(random);
  return {x, y};
}

/// Parameters fitted to all rows but those from begin to end.
VectorXd SolveWithout(const Parabola& parabola, Index begin, Index end) {
  const Index rows = parabola.y().size();
  MatrixXd columns(rows - (end - begin), 3);
  MatrixXd y(columns.rows(), 1);
  columns << parabola.columns().topRows(begin), parabola.columns().bottomRows(rows - end);
  y << parabola.y().head(begin), parabola.y().tail(rows - end);
  return test::SolveByGramSchmidt(columns, y).value();
}

TEST(LeastSquares, FindsWhatQrFinds) {
  Parabola parabola = NoisyParabola(203, 0.3);
  const LeastSquaresFit fit = Minimise(parabola, VectorXd::Zero(3));
  EXPECT_TRUE(fit.parameters.isApprox(SolveWithout(parabola, 0, 0), 1e-8)) << fit.parameters;
  EXPECT_DOUBLE_EQ(fit.squares, parabola.Residual(fit.parameters).squaredNorm());
}

TEST(LeastSquares, StaysWithinItsBounds) {
  Parabola parabola = NoisyParabola(203, 0.0);
  parabola.set_most(0.25);
  EXPECT_DOUBLE_EQ(Minimise(parabola, VectorXd::Zero(3)).parameters[2], 0.25);
}

TEST(LeastSquares, WithoutABlockIsAFitOfTheOtherRows) {
  Parabola parabola = NoisyParabola(203, 0.3);  // blocks of 10 and 11 rows
  const LeastSquaresFit fit = Minimise(parabola, VectorXd::Zero(3));
  const auto without = WithoutEachBlock(fit);
  ASSERT_TRUE(without);
  ASSERT_EQ(without->size(), kBlocks);
  for (Index block = 0; block < kBlocks; ++block) {
    const VectorXd expected =
        SolveWithout(parabola, 203 * block / kBlocks, 203 * (block + 1) / kBlocks);
    EXPECT_TRUE((*without)[static_cast<std::size_t>(block)].parameters.isApprox(expected, 1e-7))
        << block;
  }
}

TEST(LeastSquares, HoldsAParameterWithoutABlock) {
  Parabola parabola = NoisyParabola(203, 0.3);
  const LeastSquaresFit fit = Minimise(parabola, VectorXd::Zero(3));
  const auto without = WithoutEachBlock(fit, 1);
  ASSERT_TRUE(without);
  for (const auto& [parameters, pull] : *without) {
    EXPECT_EQ(parameters[1], fit.parameters[1]);
    EXPECT_NE(parameters[0], fit.parameters[0]);
    EXPECT_EQ(pull.col(1).norm(), 0.0);
  }
}

TEST(LeastSquares, SaysWhereRowsDoNotTellParametersApart) {
  Parabola parabola(VectorXd::Ones(100), VectorXd::Random(100));
  EXPECT_FALSE(WithoutEachBlock(Minimise(parabola, VectorXd::Zero(3))));
}

// The mean of n values whose blocks have means m: its standard error is that of the mean of m.
TEST(LeastSquares, StandardErrorOfAMeanIsThatOfItsBlocks) {
  constexpr Index kRows = 400;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  LeastSquaresFit fit{.parameters = VectorXd::Zero(1),
                      .residual = VectorXd(kRows),
                      .derivatives = MatrixXd::Ones(kRows, 1)};
  for (double& value : fit.residual) value = normal(random);
  fit.residual.array() -= fit.residual.mean();
  const VectorXd means =
      Eigen::Map<const MatrixXd>(fit.residual.data(), kRows / kBlocks, kBlocks).colwise().mean();
  const auto without = WithoutEachBlock(fit);
  ASSERT_TRUE(without);
  EXPECT_NEAR(StandardErrorOf(fit, *without, [](const VectorXd& p) { return p[0]; }),
              means.norm() / std::sqrt(kBlocks * (kBlocks - 1.0)), 1e-12);
}

/// A value that is seen in some of the blocks, in noise.
LeastSquaresFit SeenInBlocks(int blocks, std::mt19937& random) {
  constexpr Index kRows = 400;
  std::normal_distribution<double> normal;
  LeastSquaresFit fit{.parameters = VectorXd::Zero(1),
                      .residual = VectorXd(kRows),
                      .derivatives = MatrixXd::Zero(kRows, 1)};
  fit.derivatives.topRows(blocks * kRows / kBlocks).setOnes();
  for (double& value : fit.residual) value = normal(random);
  fit.parameters[0] = fit.derivatives.col(0).dot(fit.residual) / fit.derivatives.squaredNorm();
  fit.residual -= fit.derivatives * fit.parameters;
  return fit;
}

TEST(LeastSquares, HasAsManyDegreesOfFreedomAsBlocksTellOfAValueButOne) {
  std::mt19937 random(3);
  for (const int blocks : {2, 4, 10, kBlocks}) {
    LeastSquaresFit fit = SeenInBlocks(blocks, random);
    fit.parameters[0] = 2.0;
    const auto without = WithoutEachBlock(fit);
    ASSERT_TRUE(without);
    const auto degrees = [&](const auto& value_of) {
      return DegreesOfFreedomOf(fit, *without, value_of);
    };
    EXPECT_NEAR(degrees([](const VectorXd& p) { return p[0]; }), blocks - 1.0, 1e-9);
    EXPECT_NEAR(degrees([](const VectorXd& p) { return std::log(p[0]); }), blocks - 1.0, 1e-9);
  }
}

// Of 19 degrees of freedom, as of all blocks, intervals would hold it in 90 %.
TEST(LeastSquares, IntervalsOfAValueThatFewBlocksTellHoldIt) {
  constexpr int kFits = 4000;
  std::mt19937 random(5);
  int held = 0;
  for (int i = 0; i < kFits; ++i) {
    const LeastSquaresFit fit = SeenInBlocks(4, random);
    const auto without = WithoutEachBlock(fit);
    const auto value_of = [](const VectorXd& p) { return p[0]; };
    const double half_width = HalfWidthOf(StandardErrorOf(fit, *without, value_of),
                                          DegreesOfFreedomOf(fit, *without, value_of));
    held += std::abs(fit.parameters[0]) < half_width;
  }
  EXPECT_GT(held, 0.94 * kFits);
  EXPECT_LT(held, 0.98 * kFits);
}

// Tables of Student's t for 19 degrees of freedom: 1.729 (5 % to one side), 2.093 (5 % to both),
// 3.174 (0.25 % to one side).
TEST(LeastSquares, ChanceIsThatOfTheTables) {
  EXPECT_TRUE(IsByChance(1.728, 1));
  EXPECT_FALSE(IsByChance(1.730, 1));
  EXPECT_TRUE(IsByChance(3.17, 20));
  EXPECT_FALSE(IsByChance(3.18, 20));
  EXPECT_TRUE(IsByChance(-5.0, 1));
  EXPECT_NEAR(HalfWidthOf(2.0, 19.0), 4.186, 1e-3);
}

TEST(LeastSquares, GainIsComparedFromBlockToBlock) {
  constexpr Index kRows = 400;
  LeastSquaresFit better{.parameters = {}, .residual = VectorXd::Ones(kRows), .derivatives = {}};
  LeastSquaresFit other = better;
  // Blocks of 20 rows. The logarithms of their ratios are 3 and 1 by turns, mean 2.
  for (Index row = 0; row < kRows; ++row) {
    other.residual[row] = std::exp(0.5 * (row * kBlocks / kRows % 2 == 0 ? 3.0 : 1.0));
  }
  // Standard error: sqrt(20 / 19) / sqrt(20).
  EXPECT_NEAR(StudentOfGain(better.residual, other.residual), 2.0 * std::sqrt(19.0), 1e-9);
  EXPECT_NEAR(StudentOfGain(other.residual, better.residual), -2.0 * std::sqrt(19.0), 1e-9);
}

}  // namespace
}  // namespace gauntlet::sim
