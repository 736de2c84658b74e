#include "sim/trial/external/external_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/base/hash.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/trial/external/command_words.h"
#include "sim/trial/external/own_objects.h"
#include "sim/trial/external/program.h"
#include "sim/trial/external/stepper.h"
#include "sim/trial/external/supervised_process.h"

namespace gauntlet::sim {
namespace {

using controller::ControllerConfig;
using controller::ExternalConfig;
using controller::Filter;
using controller::FilterConfig;

std::atomic<bool> programs_allowed{false};
std::atomic<unsigned> consents{0};  // given or withdrawn
std::atomic<const char*> consent_option{"--allow-programs"};

/// The number of each filter that is external, and its settings.
template <class See>
void ForEachExternal(const ControllerConfig& config, const See& see) {
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    const auto* external = std::get_if<ExternalConfig>(&config.filters[i].settings);
    if (external == nullptr) continue;
    controller::WithinSetting(fmt::format("filter[{}]", i), [&] { see(i, *external); });
  }
}

/// Makes the other side of a filter at its first sample.
using MakeStepper = std::function<std::unique_ptr<Stepper>()>;

/// The files that decide what a program or library does. Errors: SettingError if it is not there.
std::vector<std::filesystem::path> FilesOf(const ExternalConfig& config) {
  if (!config.library.empty()) return {FindLibrary(config)};
  if (!config.answers.empty()) {
    std::vector<std::filesystem::path> files = {config.answers};
    if (!config.answers_map.empty()) files.emplace_back(config.answers_map);
    return files;
  }
  return FilesOf(FindProgram(config));
}

/// Errors: SettingError for a program, library or object that is not there.
MakeStepper MakerOf(const ExternalConfig& config, std::span<const std::string> channel_names,
                    double rate_hz) {
  FilterFacts facts = {.rate_hz = rate_hz,
                       .channels = {channel_names.begin(), channel_names.end()},
                       .parameters = config.parameters};
  if (NamesObject(config)) {
    return [object = FindObject(config), facts = std::move(facts)] { return object->make(facts); };
  }
  if (!config.library.empty()) {
    return [make = LoadLibrary(config), facts = std::move(facts)] { return make(facts); };
  }
  const auto limit = std::chrono::duration_cast<Program::Duration>(
      std::chrono::duration<double, std::milli>(config.timeout_ms));
  return [command = FindProgram(config), facts = std::move(facts), limit] {
    return StartProgram(command, facts, limit);
  };
}

/// The filter whose equation is a program or an object.
class ExternalFilter final : public Filter {
 public:
  ExternalFilter(const ExternalConfig& config, std::span<const std::string> channel_names,
                 double rate_hz, std::shared_ptr<TrialProblem> problem)
      : Filter(static_cast<int>(channel_names.size())),
        make_(MakerOf(config, channel_names, rate_hz)),
        text_(OneLine(config.library.empty() ? config.command : config.library)),
        problem_(std::move(problem)) {}

  /// A new program or object at the next sample.
  void Reset() noexcept override {
    stepper_.reset();
    samples_ = 0;
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    const bool has_answer = problem_->text.empty() && Try([&] {
                              ++samples_;
                              if (!stepper_) stepper_ = make_();
                              stepper_->Step(input, output);
                            });
    if (!has_answer && input.data() != output.data()) {
      std::copy(input.begin(), input.end(), output.begin());
    }
  }
  void ResetChecked(int channel) noexcept override {
    if (!stepper_) return;  // nothing to forget, or failed
    Try([this, channel] { stepper_->StartChannel(channel); });
  }
  void StartChecked(std::span<const double> /*values*/) noexcept override {}
  bool SwapChecked(Filter& /*from*/) noexcept override { return false; }

  /// False if it fails.
  template <class Work>
  bool Try(const Work& work) noexcept {
    try {
      work();
      return true;
    } catch (const controller::SettingError& error) {
      problem_->mistake = std::current_exception();
      Fail(error.problem().c_str());
    } catch (const std::exception& error) {
      Fail(error.what());
    } catch (...) {
      Fail("failed");
    }
    return false;
  }

  void Fail(const char* problem) noexcept {
    stepper_.reset();
    try {
      problem_->text = fmt::format("{}: at sample {}: {}", text_, samples_, problem);
    } catch (...) {
      problem_->text = "failed";  // short: needs no memory
    }
  }

  MakeStepper make_;
  std::string text_;  // of the command
  std::shared_ptr<TrialProblem> problem_;
  std::unique_ptr<Stepper> stepper_;
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

std::mutex run_mutex;
std::string run_name;

/// A text that no other run of Gauntlet has, and no other consent in it: what is known by it is not
/// found again.
std::string OnlyOnce() {
  if (const std::lock_guard lock(run_mutex); !run_name.empty()) return run_name;
  static const std::string kOnce = [] {
    std::random_device source;
    return fmt::format("{:x} {:x} {:x} {:x}", source(), source(), source(), source());
  }();
  return fmt::format("{} {}", kOnce, consents.load());
}

/// Errors: SettingError for answers that no filter can give.
void CheckAnswers(const ExternalConfig& external, const ControllerConfig& config, std::size_t i) {
  if (!external.command.empty() || !external.library.empty()) {
    throw controller::SettingError("answers",
                                   "is there beside a command or library, must be one of them");
  }
  if (i > 0 || config.filter_on != controller::FilterOn::kCounts) {
    throw controller::SettingError(
        "answers", "must be the first filter, with filter_on: counts: they are of the recording");
  }
  InputFile(external.answers);
}

class ExternalMaker final : public controller::FilterMaker {
 public:
  /// `problem`: where a filter notes why it failed.
  explicit ExternalMaker(std::shared_ptr<TrialProblem> problem) : problem_(std::move(problem)) {}

  std::unique_ptr<Filter> Make(const ExternalConfig& config, std::span<const std::string> names,
                               double rate_hz) const override {
    return std::make_unique<ExternalFilter>(config, names, rate_hz, problem_);
  }

 private:
  std::shared_ptr<TrialProblem> problem_;
};

}  // namespace

void NameRun(const std::string& name) {
  const std::lock_guard lock(run_mutex);
  run_name = name;
}

void AllowPrograms(bool allowed) {
  programs_allowed = allowed;
  ++consents;
  if (!allowed) ForgetSurroundings();
}

void NameConsent(const char* option) { consent_option = option; }

bool HasPrograms(const ControllerConfig& config) {
  return std::ranges::any_of(config.filters, [](const FilterConfig& filter) {
    return std::holds_alternative<ExternalConfig>(filter.settings);
  });
}

bool HasSlowPrograms(const ControllerConfig& config) {
  bool has = false;
  ForEachExternal(config, [&has](std::size_t, const ExternalConfig& external) {
    has = has || external.library.empty();
  });
  return has;
}

void CheckPrograms(const ControllerConfig& config) {
  ForEachExternal(config, [&config](std::size_t i, const ExternalConfig& external) {
    controller::CheckSettings(external);
    if (const auto& lists = config.filters[i].per_channel; !lists.empty()) {
      throw controller::SettingError(lists[0].key, "is a list, must be one value for a program");
    }
    if (NamesObject(external)) {
      FindObject(external);
      return;
    }
    if (!external.answers.empty()) {
      CheckAnswers(external, config, i);
      return;
    }
    const bool is_library = !external.library.empty();
    if (is_library != external.command.empty()) {
      throw controller::SettingError(
          "command", is_library ? "is there beside a library, must be one of both"
                                : "is missing, must be there unless there is a library");
    }
    if (!programs_allowed) {
      throw controller::SettingError(
          is_library ? "library" : "command",
          fmt::format("is the {} {}, which runs only with {}", is_library ? "library" : "program",
                      Shown(is_library ? external.library : external.command),
                      consent_option.load()));
    }
    const std::vector<std::filesystem::path> files = FilesOf(external);
    for (std::size_t k = is_library ? 0 : 1; k < files.size(); ++k) InputFile(files[k]);
    if (is_library) LoadLibrary(external);
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
  ForEachExternal(config, [&files](std::size_t, const ExternalConfig& external) {
    if (NamesObject(external)) return;
    try {
      std::ranges::copy(FilesOf(external), std::back_inserter(files));
    } catch (const controller::SettingError&) {  // not on this machine
    }
  });
  return files;
}

std::string HashOfPrograms(const ControllerConfig& config) {
  if (!HasPrograms(config)) return "";
  Hash hash;
  ForEachExternal(config, [&hash](std::size_t, const ExternalConfig& external) {
    if (!external.deterministic && external.answers.empty()) hash.Add(OnlyOnce());
    if (NamesObject(external)) {
      hash.Add(FindObject(external)->identity);
      return;
    }
    for (const std::filesystem::path& file : FilesOf(external)) {
      hash.Add(HashSince(file));
    }
  });
  return hash.Text();
}

TrialPrograms::TrialPrograms(const ControllerConfig& config)
    : problem_(std::make_shared<TrialProblem>()),
      maker_(std::make_shared<ExternalMaker>(problem_)),
      config_(config) {
  CheckPrograms(config);
  for (FilterConfig& filter : config_.filters) {
    auto* external = std::get_if<ExternalConfig>(&filter.settings);
    if (external == nullptr || !external->answers.empty()) continue;  // the study makes those
    external->make = maker_.get();
  }
}

void TrialPrograms::ThrowMistake(const std::string& controller) const {
  if (!problem_->mistake) return;
  controller::WithinSetting(fmt::format("controllers.{}.filter", controller),
                            [this] { std::rethrow_exception(problem_->mistake); });
}

}  // namespace gauntlet::sim
