#include "sim/trial/external/answer_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

class AnswerFilter final : public controller::Filter {
 public:
  /// `columns`: of the answers, one for each channel.
  AnswerFilter(std::shared_ptr<const Signal> answers, std::vector<Eigen::Index> columns)
      : Filter(static_cast<int>(columns.size())),
        answers_(std::move(answers)),
        columns_(std::move(columns)),
        last_(columns_.size(), kNaN) {}

  void Reset() noexcept override {
    row_ = 0;
    std::ranges::fill(last_, kNaN);
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const double answer = row_ < answers_->rows() ? (*answers_)(row_, columns_[i]) : kNaN;
      if (std::isfinite(answer)) last_[i] = answer;
      output[i] = std::isfinite(last_[i]) ? last_[i] : input[i];
    }
    ++row_;
  }
  void ResetChecked(int /*channel*/) noexcept override {}  // the answers know of every gap
  void StartChecked(std::span<const double> /*values*/) noexcept override {}
  bool SwapChecked(Filter& /*from*/) noexcept override { return false; }

  std::shared_ptr<const Signal> answers_;
  std::vector<Eigen::Index> columns_;
  std::vector<double> last_;
  Eigen::Index row_ = 0;
};

class AnswerMaker final : public controller::FilterMaker {
 public:
  AnswerMaker(Signal answers, std::vector<std::string> channel_names)
      : answers_(std::make_shared<const Signal>(std::move(answers))),
        channel_names_(std::move(channel_names)) {
    GAUNTLET_ASSERT(answers_->cols() == std::ssize(channel_names_));
  }

  std::unique_ptr<controller::Filter> Make(const controller::ExternalConfig& /*config*/,
                                           std::span<const std::string> names,
                                           double /*rate_hz*/) const override {
    std::vector<Eigen::Index> columns;
    for (const std::string& name : names) {
      const auto found = std::ranges::find(channel_names_, name);
      GAUNTLET_ASSERT(found != channel_names_.end());
      columns.push_back(found - channel_names_.begin());
    }
    return std::make_unique<AnswerFilter>(answers_, std::move(columns));
  }

 private:
  std::shared_ptr<const Signal> answers_;
  std::vector<std::string> channel_names_;
};

}  // namespace

std::shared_ptr<const controller::FilterMaker> MakerOfAnswers(
    Signal answers, std::vector<std::string> channel_names) {
  return std::make_shared<AnswerMaker>(std::move(answers), std::move(channel_names));
}

}  // namespace gauntlet::sim
