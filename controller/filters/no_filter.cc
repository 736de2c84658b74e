#include "controller/filters/no_filter.h"

#include <algorithm>

namespace gauntlet::controller {
namespace {

class NoFilter final : public Filter {
 public:
  explicit NoFilter(int channel_count) : channel_count_(channel_count) {}

  int channel_count() const noexcept override { return channel_count_; }
  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    if (input.data() != output.data()) std::copy(input.begin(), input.end(), output.begin());
  }
  void Reset() noexcept override {}
  void ResetChannel(int) noexcept override {}
  bool CopyChannel(const Filter& from, int) noexcept override {
    return dynamic_cast<const NoFilter*>(&from) != nullptr;
  }

 private:
  int channel_count_;
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const NoFilterConfig&, int channel_count, double) {
  return std::make_unique<NoFilter>(channel_count);
}

}  // namespace gauntlet::controller
