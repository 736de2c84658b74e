#include "controller/filters/sample_window.h"

#include <algorithm>

#include "controller/assert.h"
#include "controller/filters/subnormal.h"

namespace gauntlet::controller {

SampleWindow::SampleWindow(int length, int channel_count, double empty)
    : rows_(Rows::Constant(length, channel_count, empty)),
      empty_(empty),
      counts_(channel_count, 0),
      filling_(channel_count) {
  GAUNTLET_ASSERT(length > 0 && channel_count > 0);
}

void SampleWindow::Push(std::span<const double> sample) noexcept {
  GAUNTLET_ASSERT(std::ssize(sample) == channel_count());
  CopyWithoutSubnormals(sample.data(), Advance(), channel_count());
}

double* SampleWindow::Advance() noexcept {
  double* row = rows_.row(next_).data();
  next_ = next_ + 1 == length() ? 0 : next_ + 1;
  if (filling_ > 0) {
    for (int channel = 0; channel < channel_count(); ++channel) {
      SetCount(channel, std::min(count(channel) + 1, length()));
    }
  }
  return row;
}

void SampleWindow::SetCount(int channel, int count) noexcept {
  GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
  int& current = counts_[channel];
  filling_ += (current == length()) - (count == length());
  current = count;
}

void SampleWindow::Reset() noexcept {
  rows_.setConstant(empty_);
  next_ = 0;
  std::fill(counts_.begin(), counts_.end(), 0);
  filling_ = channel_count();
}

void SampleWindow::ResetChannel(int channel) noexcept {
  if (count(channel) == 0) return;  // is empty: a first sample must not wait for a long window
  rows_.col(channel).setConstant(empty_);
  SetCount(channel, 0);
}

}  // namespace gauntlet::controller
