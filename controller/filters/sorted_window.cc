#include "controller/filters/sorted_window.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// From rank to rank: once the leaving value has been met, rows move up by one; the entering value
/// sinks to its place as the larger of each pair is carried on. `gone` is 0 before the leaving
/// value and 1 after.
GAUNTLET_VECTORISED void Replace(double* sorted, int length, const double* leaving, double* carried,
                                 double* gone, int channel_count) {
  for (int rank = 0; rank + 1 < length; ++rank) {
    double* row = sorted + std::ptrdiff_t{rank} * channel_count;
    const double* above = row + channel_count;
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      const double now_gone = row[i] == leaving[i] ? 1.0 : gone[i];
      const double value = now_gone == 1.0 ? above[i] : row[i];
      const double smaller = value < carried[i] ? value : carried[i];
      const double larger = value < carried[i] ? carried[i] : value;
      gone[i] = now_gone;
      row[i] = smaller;
      carried[i] = larger;
    }
  }
  double* last = sorted + std::ptrdiff_t{length - 1} * channel_count;
  for (int i = 0; i < channel_count; ++i) last[i] = carried[i];
}

GAUNTLET_VECTORISED void Middle(const double* low, const double* high, double* median,
                                int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) median[i] = 0.5 * (low[i] + high[i]);
}

double KthDeviation(const SortedWindow& window, int channel, int count, double center, int k) {
  // Deviations grow outwards on both sides of the center; the k-th smallest of two sorted lists is
  // the least, over all ways to take k from both, of the larger of the last ones taken.
  const int below = count / 2;  // samples of rank < below are the lower list
  double least = std::numeric_limits<double>::infinity();
  for (int lower = std::max(0, k - (count - below)); lower <= std::min(k, below); ++lower) {
    const int upper = k - lower;
    const double low = lower == 0 ? 0.0 : center - window.row(below - lower)[channel];
    const double high = upper == 0 ? 0.0 : window.row(below + upper - 1)[channel] - center;
    least = std::min(least, std::max(low, high));
  }
  return least;
}

double MedianDeviation(const SortedWindow& window, int channel, double center) {
  const int count = window.count(channel);
  const double upper = KthDeviation(window, channel, count, center, count / 2 + 1);
  if (count % 2 == 1) return upper;
  return 0.5 * (KthDeviation(window, channel, count, center, count / 2) + upper);
}

/// KthDeviation() of full windows, all channels at once.
GAUNTLET_VECTORISED void KthDeviations(const double* sorted, int length, const double* center,
                                       int k, double* least, int channel_count) {
  const int below = length / 2;
  for (int i = 0; i < channel_count; ++i) least[i] = std::numeric_limits<double>::infinity();
  const int first = k - (length - below) > 0 ? k - (length - below) : 0;
  const int last = k < below ? k : below;
  for (int lower = first; lower <= last; ++lower) {
    const int upper = k - lower;
    // A list of which nothing is taken has no deviation: its row stands in, with factor 0.
    const double take_low = lower == 0 ? 0.0 : 1.0;
    const double take_high = upper == 0 ? 0.0 : 1.0;
    const double* low_row = sorted + std::ptrdiff_t{lower == 0 ? 0 : below - lower} * channel_count;
    const double* high_row =
        sorted + std::ptrdiff_t{upper == 0 ? 0 : below + upper - 1} * channel_count;
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      const double low = take_low * (center[i] - low_row[i]);
      const double high = take_high * (high_row[i] - center[i]);
      const double larger = low < high ? high : low;
      least[i] = larger < least[i] ? larger : least[i];
    }
  }
}

}  // namespace

SortedWindow::SortedWindow(int length, int channel_count)
    : window_(length, channel_count, kEmpty),
      sorted_(length, channel_count),
      carried_(channel_count),
      removed_(channel_count) {
  sorted_.setConstant(kEmpty);
}

void SortedWindow::Push(std::span<const double> sample) noexcept {
  GAUNTLET_ASSERT(std::ssize(sample) == channel_count());
  CopyWithoutSubnormals(sample.data(), carried_.data(), channel_count());
  std::fill(removed_.begin(), removed_.end(), 0.0);
  Replace(sorted_.data(), length(), window_.Leaving(), carried_.data(), removed_.data(),
          channel_count());
  window_.Push(sample);
}

void SortedWindow::Reset() noexcept {
  window_.Reset();
  sorted_.setConstant(kEmpty);
}

void SortedWindow::ResetChannel(int channel) noexcept {
  if (count(channel) == 0) return;
  window_.ResetChannel(channel);
  sorted_.col(channel).setConstant(kEmpty);
}

void Medians(const SortedWindow& window, double* median) noexcept {
  if (window.all_full()) {
    Middle(window.row((window.length() - 1) / 2), window.row(window.length() / 2), median,
           window.channel_count());
    return;
  }
  for (int i = 0; i < window.channel_count(); ++i) {
    const int count = window.count(i);
    median[i] = 0.5 * (window.row((count - 1) / 2)[i] + window.row(count / 2)[i]);
  }
}

void MedianDeviations(const SortedWindow& window, const double* center,
                      double* deviation) noexcept {
  const int length = window.length();
  if (window.all_full() && length % 2 == 1) {
    KthDeviations(window.row(0), length, center, length / 2 + 1, deviation, window.channel_count());
    return;
  }
  for (int i = 0; i < window.channel_count(); ++i) {
    deviation[i] = MedianDeviation(window, i, center[i]);
  }
}

}  // namespace gauntlet::controller
