#include "controller/filters/sorted_window.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

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

/// The k-th smallest deviation of full windows, all channels at once, as KthDeviation() below.
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

/// Sorted samples, one row of all channels per rank: one pass of minima and maxima takes the
/// leaving sample out and the entering one in, in a time that does not depend on the data.
class SortedRows final : public SortedWindow {
 public:
  SortedRows(int length, int channel_count)
      : SortedWindow(length, channel_count),
        sorted_(length, channel_count),
        carried_(channel_count),
        removed_(channel_count) {
    sorted_.setConstant(kEmpty);
  }

  void Push(std::span<const double> sample) noexcept override {
    GAUNTLET_ASSERT(std::ssize(sample) == channel_count());
    CopyWithoutSubnormals(sample.data(), carried_.data(), channel_count());
    std::fill(removed_.begin(), removed_.end(), 0.0);
    Replace(sorted_.data(), length(), window_.Leaving(), carried_.data(), removed_.data(),
            channel_count());
    window_.Push(sample);
  }
  double Value(int rank, int channel) const noexcept override { return sorted_(rank, channel); }

  void Medians(double* median) const noexcept override {
    if (!window_.all_full()) return SortedWindow::Medians(median);
    Middle(Row((length() - 1) / 2), Row(length() / 2), median, channel_count());
  }
  void MedianDeviations(const double* center, double* deviation) const noexcept override {
    if (!window_.all_full() || length() % 2 == 0) {
      return SortedWindow::MedianDeviations(center, deviation);
    }
    KthDeviations(Row(0), length(), center, length() / 2 + 1, deviation, channel_count());
  }

 private:
  const double* Row(int rank) const noexcept { return sorted_.row(rank).data(); }
  void EmptyOrder(int channel) noexcept override { sorted_.col(channel).setConstant(kEmpty); }

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> sorted_;
  std::vector<double> carried_;  // scratch of Push()
  std::vector<double> removed_;
};

/// Places in the window, two bytes each, in the order of their samples, and of their age where
/// samples are equal. A step finds the leaving and the entering place by bisection, all channels
/// side by side so that their waits for memory overlap, and moves what is between the two.
class SortedPlaces final : public SortedWindow {
 public:
  SortedPlaces(int length, int channel_count)
      : SortedWindow(length, channel_count),
        order_(channel_count, length),
        entering_(channel_count),
        from_(channel_count),
        to_(channel_count) {
    GAUNTLET_ASSERT(length - 1 <= std::numeric_limits<Place>::max());
    for (int channel = 0; channel < channel_count; ++channel) SortedPlaces::EmptyOrder(channel);
  }

  void Push(std::span<const double> sample) noexcept override {
    GAUNTLET_ASSERT(std::ssize(sample) == channel_count());
    CopyWithoutSubnormals(sample.data(), entering_.data(), channel_count());
    Find();
    const Place place = window_.leaving_place();
    for (int channel = 0; channel < channel_count(); ++channel) {
      Place* order = order_.row(channel).data();
      const int from = from_[channel];
      int to = to_[channel];
      GAUNTLET_ASSERT(order[from] == place);
      if (to > from) {
        --to;  // what is above the leaving place moves down
        std::copy(order + from + 1, order + to + 1, order + from);
      } else {
        std::copy_backward(order + to, order + from, order + from + 1);
      }
      order[to] = place;
    }
    window_.Push(sample);
  }
  double Value(int rank, int channel) const noexcept override {
    return At(order_(channel, rank), channel);
  }

 private:
  using Place = std::uint16_t;

  double At(int place, int channel) const noexcept {
    return window_.rows()[std::ptrdiff_t{place} * channel_count() + channel];
  }
  /// Ranks of the first sample that is not below the leaving one, which is the leaving one itself
  /// as the oldest of its equals, and of the first that is above the entering one.
  void Find() noexcept {
    const double* leaving = window_.Leaving();
    std::fill(from_.begin(), from_.end(), 0);
    std::fill(to_.begin(), to_.end(), 0);
    int remaining = length();
    while (remaining > 0) {
      const int half = (remaining + 1) / 2;
      for (int channel = 0; channel < channel_count(); ++channel) {
        // Products in place of branches, which are taken at random.
        from_[channel] += half * (Value(from_[channel] + half - 1, channel) < leaving[channel]);
        to_[channel] += half * !(entering_[channel] < Value(to_[channel] + half - 1, channel));
      }
      remaining -= half;
    }
  }
  void EmptyOrder(int channel) noexcept override {
    const int oldest = window_.leaving_place();
    Place* order = order_.row(channel).data();
    std::iota(order, order + length() - oldest, static_cast<Place>(oldest));
    std::iota(order + length() - oldest, order + length(), Place{0});
  }

  Eigen::Matrix<Place, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> order_;
  std::vector<double> entering_;  // scratch of Push()
  std::vector<int> from_;
  std::vector<int> to_;
};

double KthDeviation(const SortedWindow& window, int channel, int count, double center, int k) {
  // Deviations grow outwards on both sides of the center; the k-th smallest of two sorted lists is
  // the least, over all ways to take k from both, of the larger of the last ones taken. The more
  // is taken from the lower list, the larger is its last one and the smaller the other.
  const int below = count / 2;  // samples of rank < below are the lower list
  const auto low = [&](int lower) {
    return lower == 0 ? 0.0 : center - window.Value(below - lower, channel);
  };
  const auto high = [&](int lower) {
    return lower == k ? 0.0 : window.Value(below + k - lower - 1, channel) - center;
  };
  int first = std::max(0, k - (count - below));
  int last = std::min(k, below);
  while (first < last) {
    const int middle = (first + last) / 2;
    if (low(middle) < high(middle)) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  const double least = std::max(low(first), high(first));
  return first == std::max(0, k - (count - below)) ? least : std::min(least, high(first - 1));
}

double MedianDeviation(const SortedWindow& window, int channel, double center) {
  const int count = window.count(channel);
  const double upper = KthDeviation(window, channel, count, center, count / 2 + 1);
  if (count % 2 == 1) return upper;
  return 0.5 * (KthDeviation(window, channel, count, center, count / 2) + upper);
}

}  // namespace

std::unique_ptr<SortedWindow> SortedWindow::Make(int length, int channel_count) {
  // With 18 channels, medians are as fast either way from 85 samples on, deviations from 160.
  constexpr int kLongestRows = 128;
  if (length <= kLongestRows) return std::make_unique<SortedRows>(length, channel_count);
  return std::make_unique<SortedPlaces>(length, channel_count);
}

void SortedWindow::Reset() noexcept {
  window_.Reset();
  for (int channel = 0; channel < channel_count(); ++channel) EmptyOrder(channel);
}

void SortedWindow::ResetChannel(int channel) noexcept {
  if (count(channel) == 0) return;
  window_.ResetChannel(channel);
  EmptyOrder(channel);
}

void SortedWindow::Medians(double* median) const noexcept {
  for (int i = 0; i < channel_count(); ++i) {
    median[i] = 0.5 * (Value((count(i) - 1) / 2, i) + Value(count(i) / 2, i));
  }
}

void SortedWindow::MedianDeviations(const double* center, double* deviation) const noexcept {
  for (int i = 0; i < channel_count(); ++i) deviation[i] = MedianDeviation(*this, i, center[i]);
}

}  // namespace gauntlet::controller
