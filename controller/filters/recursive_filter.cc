#include "controller/filters/recursive_filter.h"

#include <typeinfo>

namespace gauntlet::controller {

void RecursiveFilter::Step(std::span<const double> input, std::span<double> output) noexcept {
  if (fresh_.any()) {
    fresh_.StartAll(input, [this](int channel, double value) { SettleAt(channel, value); });
  }
  StepAll(input.data(), output.data());
}

void RecursiveFilter::Reset() noexcept {
  for (int channel = 0; channel < channel_count(); ++channel) ResetChannel(channel);
}

void RecursiveFilter::ResetChannel(int channel) noexcept {
  for (int index = 0; index < arrays_.array_count(); ++index) arrays_[index][channel] = 0.0;
  if (start_ == Start::kFirst) fresh_.Add(channel);
}

bool RecursiveFilter::CopyChannel(const Filter& from, int channel) noexcept {
  if (typeid(from) != typeid(*this)) return false;
  const auto& other = static_cast<const RecursiveFilter&>(from);
  if (other.arrays_.array_count() != arrays_.array_count()) return false;
  arrays_.CopyChannel(other.arrays_, channel);
  fresh_.CopyFrom(other.fresh_, channel);
  return true;
}

}  // namespace gauntlet::controller
