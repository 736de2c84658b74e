#include "tests/controller/textbook_kalman.h"

#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

RealMatrix InverseOf(const RealMatrix& matrix) {
  return test::SolveByGramSchmidt<RealMatrix>(matrix,
                                              RealMatrix::Identity(matrix.rows(), matrix.cols()))
      .value();
}

}  // namespace

RealVector TextbookKalman::Step(const RealVector& z, const RealVector& input_term) {
  x_prior = a * x + input_term;
  p_prior = a * p * a.transpose() + q;
  gain = p_prior * h.transpose() * InverseOf(h * p_prior * h.transpose() + r);
  x = x_prior + gain * (z - h * x_prior);
  p = (RealMatrix::Identity(x.size(), x.size()) - gain * h) * p_prior;
  return h * x;
}

RealVector TextbookKalman::Smoothed(const TextbookKalman& next,
                                    const RealVector& next_smoothed) const {
  const RealMatrix back = p * a.transpose() * InverseOf(next.p_prior);
  return x + back * (next_smoothed - next.x_prior);
}

TextbookKalman MakeTextbookKalman(int channels, int states, const RealMatrix& q,
                                  const RealMatrix& r) {
  const int size = channels * states;
  RealMatrix a = RealMatrix::Zero(size, size);
  for (int i = 0; i < states; ++i) {
    Real factor = 1;
    for (int j = i; j < states; ++j) {
      a.block(i * channels, j * channels, channels, channels).diagonal().setConstant(factor);
      factor /= static_cast<Real>(j - i + 1);
    }
  }
  return {.a = a,
          .h = RealMatrix::Identity(channels, size),
          .q = q,
          .r = r,
          .x = RealVector::Zero(size),
          .p = RealMatrix::Identity(size, size)};
}

}  // namespace gauntlet::controller
