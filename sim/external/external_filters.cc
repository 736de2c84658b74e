#include "sim/external/external_filters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/external/command_words.h"
#include "sim/external/program.h"

namespace gauntlet::sim {
namespace {

using controller::ControllerConfig;
using controller::ExternalConfig;
using controller::Filter;
using controller::FilterConfig;

std::atomic<bool> programs_allowed{false};
std::atomic<const char*> consent_option{"--allow-programs"};

/// The number of its filters and of each its program.
template <class See>
void ForEachProgram(const ControllerConfig& config, const See& see) {
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    const auto* external = std::get_if<ExternalConfig>(&config.filters[i].settings);
    if (external == nullptr) continue;
    controller::WithinSetting(fmt::format("filter[{}]", i), [&] { see(i, *external); });
  }
}

std::string HeaderOf(const ExternalConfig& config, std::span<const std::string> channel_names,
                     double rate_hz) {
  nlohmann::ordered_json header;
  header["rate_hz"] = rate_hz;
  header["channel_count"] = channel_names.size();
  header["channels"] = std::vector<std::string>(channel_names.begin(), channel_names.end());
  header["parameters"] = nlohmann::ordered_json::object();
  for (const auto& [name, value] : config.parameters) header["parameters"][name] = value;
  return header.dump() + "\n";
}

/// The filter whose equation is a program.
class ExternalFilter final : public Filter {
 public:
  ExternalFilter(const ExternalConfig& config, std::span<const std::string> channel_names,
                 double rate_hz, std::shared_ptr<std::string> problem)
      : Filter(static_cast<int>(channel_names.size())),
        command_(FindProgram(config)),
        text_(OneLine(config.command)),
        header_(HeaderOf(config, channel_names, rate_hz)),
        limit_(std::chrono::duration_cast<Program::Duration>(
            std::chrono::duration<double, std::milli>(config.timeout_ms))),
        problem_(std::move(problem)) {}

  /// A new program at the next sample.
  void Reset() noexcept override {
    program_.reset();
    samples_ = 0;
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    const bool has_answer = problem_->empty() && Ask(input, output);
    if (!has_answer && input.data() != output.data()) {
      std::copy(input.begin(), input.end(), output.begin());
    }
  }
  /// A program is not told of a channel that starts anew: it goes on from the last value.
  void ResetChecked(int /*channel*/) noexcept override {}
  void StartChecked(std::span<const double> /*values*/) noexcept override {}
  bool TakeChecked(Filter& /*from*/) noexcept override { return false; }

  /// False, with `output` as it was, if the program failed.
  bool Ask(std::span<const double> input, std::span<double> output) noexcept {
    try {
      ++samples_;
      constexpr int kPatienceAtStart = 10;  // it may load libraries
      const bool starts = !program_;
      const auto limit = starts ? kPatienceAtStart * limit_ : limit_;
      if (starts) {
        program_.emplace(command_);
        program_->Tell(header_, limit);
      }
      line_.clear();
      fmt::format_to(std::back_inserter(line_), "{}\n", fmt::join(input, ","));
      Take(program_->Ask(line_, limit), output);
      return true;
    } catch (const std::exception& error) {
      Fail(error.what());
    } catch (...) {
      Fail("failed");
    }
    return false;
  }

  /// Errors: RunError.
  void Take(std::string_view answer, std::span<double> output) {
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

  void Fail(const char* problem) noexcept {
    program_.reset();
    try {
      *problem_ = fmt::format("{}: at sample {}: {}", text_, samples_, problem);
    } catch (...) {
      *problem_ = "failed";  // short: needs no memory
    }
  }

  ProgramCommand command_;
  std::string text_;  // of the command
  std::string header_;
  Program::Duration limit_;
  std::shared_ptr<std::string> problem_;
  std::optional<Program> program_;
  std::string line_;
  std::vector<double> values_;
  long samples_ = 0;
};

/// HashOfFile(), computed again only if the file was written since: every setting of a search asks
/// for that of the interpreter.
std::string HashSince(const std::filesystem::path& file) {
  using Version = std::pair<std::filesystem::file_time_type, std::uintmax_t>;
  static std::mutex mutex;
  static std::map<std::filesystem::path, std::pair<Version, std::string>> known;
  const std::lock_guard lock(mutex);
  std::error_code unreadable;
  const Version now = {std::filesystem::last_write_time(file, unreadable),
                       std::filesystem::file_size(file, unreadable)};
  auto& [version, hash] = known[file];
  if (hash.empty() || version != now) hash = HashOfFile(file);
  version = now;
  return hash;
}

class ProgramMaker final : public controller::FilterMaker {
 public:
  /// `problem`: where a filter notes why it failed.
  explicit ProgramMaker(std::shared_ptr<std::string> problem) : problem_(std::move(problem)) {}

  std::unique_ptr<Filter> Make(const ExternalConfig& config, std::span<const std::string> names,
                               double rate_hz) const override {
    return std::make_unique<ExternalFilter>(config, names, rate_hz, problem_);
  }

 private:
  std::shared_ptr<std::string> problem_;
};

}  // namespace

void AllowPrograms(bool allowed) { programs_allowed = allowed; }

void NameConsent(const char* option) { consent_option = option; }

bool HasPrograms(const ControllerConfig& config) {
  return std::ranges::any_of(config.filters, [](const FilterConfig& filter) {
    return std::holds_alternative<ExternalConfig>(filter.settings);
  });
}

bool IsDeterministic(const ControllerConfig& config) {
  bool all = true;
  ForEachProgram(config, [&all](std::size_t, const ExternalConfig& external) {
    all = all && external.deterministic;
  });
  return all;
}

void CheckPrograms(const ControllerConfig& config) {
  ForEachProgram(config, [&config](std::size_t i, const ExternalConfig& external) {
    controller::CheckSettings(external);
    if (const auto& lists = config.filters[i].per_channel; !lists.empty()) {
      throw controller::SettingError(lists[0].key, "is a list, must be one value for a program");
    }
    if (!programs_allowed) {
      throw controller::SettingError("command",
                                     fmt::format("is the program {}, which runs only with {}",
                                                 Shown(external.command), consent_option.load()));
    }
    const std::vector<std::filesystem::path> files = FilesOf(FindProgram(external));
    for (std::size_t k = 1; k < files.size(); ++k) InputFile(files[k]);
  });
}

ControllerConfig WithoutPrograms(ControllerConfig config) {
  for (FilterConfig& filter : config.filters) {
    if (std::holds_alternative<ExternalConfig>(filter.settings)) {
      filter.settings = controller::NoFilterConfig{};
    }
  }
  return config;
}

std::vector<std::filesystem::path> ProgramFiles(const ControllerConfig& config) {
  std::vector<std::filesystem::path> files;
  ForEachProgram(config, [&files](std::size_t, const ExternalConfig& external) {
    try {
      std::ranges::copy(FilesOf(FindProgram(external)), std::back_inserter(files));
    } catch (const controller::SettingError&) {  // not on this machine
    }
  });
  return files;
}

std::string HashOfPrograms(const ControllerConfig& config) {
  if (!HasPrograms(config)) return "";
  Hash hash;
  ForEachProgram(config, [&hash](std::size_t, const ExternalConfig& external) {
    for (const std::filesystem::path& file : FilesOf(FindProgram(external))) {
      hash.Add(HashSince(file));
    }
  });
  return hash.Text();
}

TrialPrograms::TrialPrograms(const ControllerConfig& config)
    : problem_(std::make_shared<std::string>()),
      maker_(std::make_shared<ProgramMaker>(problem_)),
      config_(config) {
  CheckPrograms(config);
  for (FilterConfig& filter : config_.filters) {
    auto* external = std::get_if<ExternalConfig>(&filter.settings);
    if (external == nullptr) continue;
    external->make = maker_.get();
  }
}

}  // namespace gauntlet::sim
