#include "controller/filters/filter_parts.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

class FilterOfParts final : public Filter {
 public:
  FilterOfParts(std::vector<FilterPart> parts, int channel_count)
      : Filter(channel_count),
        parts_(std::move(parts)),
        buffer_(static_cast<std::size_t>(channel_count)) {
    for (const FilterPart& part : parts_) {
      GAUNTLET_ASSERT(std::ssize(part.channels) == part.filter->channel_count());
    }
  }

  void Reset() noexcept override {
    for (const FilterPart& part : parts_) part.filter->Reset();
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (input.data() != output.data()) std::copy(input.begin(), input.end(), output.begin());
    for (const FilterPart& part : parts_) {
      const std::span<double> values = Gather(part, output);
      part.filter->Step(values, values);
      for (std::size_t i = 0; i < values.size(); ++i) {
        output[static_cast<std::size_t>(part.channels[i])] = values[i];
      }
    }
  }
  void ResetChecked(int channel) noexcept override {
    for (const FilterPart& part : parts_) {
      const auto found = std::ranges::find(part.channels, channel);
      if (found == part.channels.end()) continue;
      part.filter->ResetChannel(static_cast<int>(found - part.channels.begin()));
    }
  }
  void StartChecked(std::span<const double> values) noexcept override {
    for (const FilterPart& part : parts_) part.filter->StartAt(Gather(part, values));
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FilterOfParts*>(&from);
    if (other == nullptr || other->parts_.size() != parts_.size()) return false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (other->parts_[i].channels != parts_[i].channels) return false;
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i].filter->SwapMemory(*other->parts_[i].filter)) continue;
      for (std::size_t k = 0; k < i; ++k) {  // an exchange: once more is as before
        parts_[k].filter->SwapMemory(*other->parts_[k].filter);
      }
      return false;
    }
    return true;
  }

  std::span<double> Gather(const FilterPart& part, std::span<const double> values) noexcept {
    for (std::size_t i = 0; i < part.channels.size(); ++i) {
      buffer_[i] = values[static_cast<std::size_t>(part.channels[i])];
    }
    return std::span(buffer_).first(part.channels.size());
  }

  std::vector<FilterPart> parts_;
  std::vector<double> buffer_;
};

}  // namespace

std::unique_ptr<Filter> JoinParts(std::vector<FilterPart> parts, int channel_count) {
  return std::make_unique<FilterOfParts>(std::move(parts), channel_count);
}

}  // namespace gauntlet::controller
