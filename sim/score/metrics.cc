#include <algorithm>
#include <array>

#include "sim/score/channel_scores.h"
#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

struct Row {
  Metric metric;
  double ChannelScores::*field;
};

constexpr Row kRows[] = {
    {{.key = "tracking_rmse_deg",
      .help = "how far the hand is from the wearer, RMS",
      .definition = "sqrt(mean((hand - reference)^2))"},
     &ChannelScores::tracking_rmse_deg},
    {{.key = "delay_ms",
      .help = "how late the hand is",
      .definition = "lag of the largest Pearson correlation over the overlap, within half the "
                    "dominant period, refined by a parabola (Knapp and Carter 1976)"},
     &ChannelScores::delay_ms},
    {{.key = "aligned_rmse_deg",
      .help = "how far the hand is from the wearer once the delay is taken out, RMS",
      .definition = "sqrt(mean((hand(t + delay_ms) - reference(t))^2)); the plain difference where "
                    "there is no delay"},
     &ChannelScores::aligned_rmse_deg},
    {{.key = "peak_error_deg",
      .help = "the largest distance between hand and wearer",
      .definition = "max |hand - reference|"},
     &ChannelScores::peak_error_deg},
    {{.key = "jitter_rms_deg",
      .help = "trembling of the hand: its angle above 10 Hz, RMS",
      .definition = "RMS behind a zero-phase high pass at 10 Hz: linear phase, Kaiser window, 8 to "
                    "12 Hz, 80 dB; 0.63 s at both ends left out"},
     &ChannelScores::jitter_rms_deg},
    {{.key = "command_reversals_per_s",
      .help = "local jumps: how often the motor command turns round",
      .definition = "sign changes between successive non-zero increments of the integer command, "
                    "per second (Bai, Jiang, Yokoi 2021, figure 12)"},
     &ChannelScores::command_reversals_per_s},
};

constexpr int kCount = static_cast<int>(std::size(kRows));

constexpr std::array<Metric, kCount> kMetrics = [] {
  std::array<Metric, kCount> metrics;
  for (int i = 0; i < kCount; ++i) metrics[i] = kRows[i].metric;
  return metrics;
}();

}  // namespace

std::span<const Metric> Metrics() { return kMetrics; }

std::size_t MetricIndex(std::string_view key) {
  const auto found = std::find_if(std::begin(kMetrics), std::end(kMetrics),
                                  [key](const Metric& metric) { return metric.key == key; });
  return static_cast<std::size_t>(found - std::begin(kMetrics));
}

double ChannelScores::*MetricField(int metric) { return kRows[metric].field; }

}  // namespace gauntlet::sim
