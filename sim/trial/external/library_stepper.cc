#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/c_api/gauntlet_filter.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/trial/external/command_words.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::sim {
namespace {

using controller::SettingError;
namespace fs = std::filesystem;

class LibraryStepper final : public Stepper {
 public:
  LibraryStepper(std::shared_ptr<const gauntlet_filter> functions, const FilterFacts& facts)
      : functions_(std::move(functions)), answer_(facts.channels.size()) {
    std::vector<const char*> channels;
    for (const std::string& name : facts.channels) channels.push_back(name.c_str());
    std::vector<const char*> names;
    std::vector<double> values;
    for (const auto& [name, value] : facts.parameters) {
      names.push_back(name.c_str());
      values.push_back(value);
    }
    const gauntlet_filter_facts told = {.rate_hz = facts.rate_hz,
                                        .channel_count = static_cast<int>(channels.size()),
                                        .channels = channels.data(),
                                        .parameter_count = static_cast<int>(names.size()),
                                        .parameter_names = names.data(),
                                        .parameter_values = values.data()};
    const char* problem = nullptr;
    filter_ = functions_->create(&told, &problem);
    if (filter_ == nullptr) {
      throw SettingError(
          "library",
          fmt::format("refuses: {}", problem == nullptr ? "without a reason" : Shown(problem)));
    }
  }
  ~LibraryStepper() override { functions_->destroy(filter_); }
  LibraryStepper(const LibraryStepper&) = delete;
  LibraryStepper& operator=(const LibraryStepper&) = delete;

  void Step(std::span<const double> input, std::span<double> output) override {
    // Not into `output`, which may be the input: a filter that fails passes that on.
    if (const int code = functions_->step(filter_, input.data(), answer_.data()); code != 0) {
      throw RunError(fmt::format("returned {}, must be 0", code));
    }
    if (!std::ranges::all_of(answer_, [](double value) { return std::isfinite(value); })) {
      throw RunError("returned a value that is not finite");
    }
    std::ranges::copy(answer_, output.begin());
  }

  void StartChannel(int channel) override {
    if (functions_->start_channel != nullptr) functions_->start_channel(filter_, channel);
  }

 private:
  std::shared_ptr<const gauntlet_filter> functions_;
  std::vector<double> answer_;
  void* filter_ = nullptr;
};

[[noreturn]] void Fail(const fs::path& file, const std::string& problem) {
  throw SettingError("library", fmt::format("{}: {}", Shown(file.string()), problem));
}

/// The functions of a library, which stays loaded as long as they are used.
std::shared_ptr<const gauntlet_filter> FunctionsOf(const fs::path& file) {
  void* const opened = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (opened == nullptr) Fail(file, OneLine(dlerror()));
  const std::shared_ptr<void> library(opened, dlclose);
  const auto functions =
      reinterpret_cast<decltype(&gauntlet_filter_1)>(dlsym(opened, "gauntlet_filter_1"));
  if (functions == nullptr) Fail(file, "has no function gauntlet_filter_1()");
  const gauntlet_filter* const found = functions();
  if (found == nullptr || found->version != GAUNTLET_FILTER_VERSION) {
    Fail(file, fmt::format("is for version {} of gauntlet_filter.h, must be for {}",
                           found == nullptr ? 0 : found->version, GAUNTLET_FILTER_VERSION));
  }
  if (found->create == nullptr || found->step == nullptr || found->destroy == nullptr) {
    Fail(file, "lacks create, step or destroy");
  }
  return {library, found};
}

}  // namespace

fs::path FindLibrary(const controller::ExternalConfig& config) {
  fs::path file = (FolderOf(config) / config.library).lexically_normal();
  std::error_code unreadable;
  if (fs::is_regular_file(file, unreadable)) return file;
  throw SettingError("library", fmt::format("{}: no such file", Shown(file.string())));
}

std::function<std::unique_ptr<Stepper>(const FilterFacts&)> LoadLibrary(
    const controller::ExternalConfig& config) {
  return [functions = FunctionsOf(FindLibrary(config))](const FilterFacts& facts) {
    return std::make_unique<LibraryStepper>(functions, facts);
  };
}

}  // namespace gauntlet::sim
