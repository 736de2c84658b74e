#include "controller/filters/recursive_filter.h"

#include <typeinfo>
#include <utility>

namespace gauntlet::controller {

void RecursiveFilter::StepChecked(std::span<const double> input,
                                  std::span<double> output) noexcept {
  if (fresh_.any()) {
    fresh_.StartAll(input, [this](int channel, double value) { SettleAt(channel, value); });
  }
  StepAll(input.data(), output.data());
}

void RecursiveFilter::Reset() noexcept {
  for (int channel = 0; channel < channel_count(); ++channel)
    RecursiveFilter::ResetChecked(channel);
}

void RecursiveFilter::ResetChecked(int channel) noexcept {
  for (int index = 0; index < arrays_.array_count(); ++index) arrays_[index][channel] = 0.0;
  if (start_ == Start::kFirst) fresh_.Add(channel);
}

void RecursiveFilter::StartChecked(std::span<const double> values) noexcept {
  arrays_.SetZero();
  fresh_.AddAll();
  fresh_.StartAll(values, [this](int channel, double value) { SettleAt(channel, value); });
}

bool RecursiveFilter::SwapChecked(Filter& from) noexcept {
  if (typeid(from) != typeid(*this)) return false;
  auto& other = static_cast<RecursiveFilter&>(from);
  if (other.arrays_.array_count() != arrays_.array_count()) return false;
  std::swap(arrays_, other.arrays_);
  std::swap(fresh_, other.fresh_);
  return true;
}

}  // namespace gauntlet::controller
