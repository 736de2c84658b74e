#include "controller/filters/no_filter.h"

#include <algorithm>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"

namespace gauntlet::controller {
namespace {

class NoFilter final : public Filter {
 public:
  explicit NoFilter(int channel_count) : Filter(channel_count) {}
  void Reset() noexcept override {}

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (input.data() != output.data()) std::copy(input.begin(), input.end(), output.begin());
  }
  void ResetChecked(int) noexcept override {}
  void StartChecked(std::span<const double>) noexcept override {}
  bool SwapChecked(Filter& from) noexcept override {
    return dynamic_cast<NoFilter*>(&from) != nullptr;
  }
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const NoFilterConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<NoFilter>(channel_count);
}

}  // namespace gauntlet::controller
