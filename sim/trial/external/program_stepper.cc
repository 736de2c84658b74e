#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::sim {
namespace {

std::string HeaderOf(const FilterFacts& facts) {
  Json header;
  header["rate_hz"] = facts.rate_hz;
  header["channel_count"] = facts.channels.size();
  header["channels"] = facts.channels;
  header["parameters"] = Json::object();
  for (const auto& [name, value] : facts.parameters) header["parameters"][name] = value;
  return header.dump() + "\n";
}

class ProgramStepper final : public Stepper {
 public:
  ProgramStepper(const ProgramCommand& command, const FilterFacts& facts, Program::Duration limit)
      : program_(command), limit_(limit) {
    program_.Tell(HeaderOf(facts), kPatienceAtStart * limit_);
  }

  void Step(std::span<const double> input, std::span<double> output) override {
    line_.clear();
    fmt::format_to(std::back_inserter(line_), "{}\n", fmt::join(input, ","));
    ParseAnswer(program_.Ask(line_, is_first_ ? kPatienceAtStart * limit_ : limit_), output);
    is_first_ = false;
  }

  /// A program is not told of it: it goes on from the last value.
  void StartChannel(int /*channel*/) override {}

 private:
  static constexpr int kPatienceAtStart = 10;  // it may load libraries

  /// Errors: RunError.
  void ParseAnswer(std::string_view answer, std::span<double> output) {
    values_.clear();
    for (std::string_view rest = answer;;) {
      const std::size_t end = std::min(rest.find(','), rest.size());
      std::string_view text = rest.substr(0, end);
      while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
      while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
      const std::optional<double> value = controller::ParseNumber(text);
      if (!value) {
        throw RunError(fmt::format("answered \"{}\", must be {} finite numbers with commas",
                                   Shown(answer), output.size()));
      }
      values_.push_back(*value);
      if (end == rest.size()) break;
      rest.remove_prefix(end + 1);
    }
    if (values_.size() != output.size()) {
      throw RunError(fmt::format("answered {} value{}, must be {}", values_.size(),
                                 values_.size() == 1 ? "" : "s", output.size()));
    }
    std::copy(values_.begin(), values_.end(), output.begin());
  }

  Program program_;
  Program::Duration limit_;
  bool is_first_ = true;
  std::string line_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<Stepper> StartProgram(const ProgramCommand& command, const FilterFacts& facts,
                                      Program::Duration limit) {
  return std::make_unique<ProgramStepper>(command, facts, limit);
}

}  // namespace gauntlet::sim
