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
    {{.key = "rest_tracking_rmse_deg",
      .help = "distance to the wearer who holds still, RMS",
      .definition = "tracking_rmse_deg where the wearer is slower than 5 deg/s for 0.3 s, without "
                    "the first 0.5 s; or in segments labelled rest"},
     &ChannelScores::rest_tracking_rmse_deg},
    {{.key = "rest_jitter_deg",
      .help = "how much the hand wanders while the wearer holds still",
      .definition =
          "standard deviation of the hand about its mean of each rest, pooled over rests"},
     &ChannelScores::rest_jitter_deg},
    {{.key = "slow_tracking_rmse_deg",
      .help = "distance to the wearer while the wearer moves slowly, RMS",
      .definition = "tracking_rmse_deg where the wearer is below 60 deg/s and not at rest; or in "
                    "segments labelled slow"},
     &ChannelScores::slow_tracking_rmse_deg},
    {{.key = "slow_jitter_rms_deg",
      .help = "trembling while the wearer moves slowly, RMS",
      .definition = "jitter_rms_deg where the wearer is below 60 deg/s and not at rest; or in "
                    "segments labelled slow"},
     &ChannelScores::slow_jitter_rms_deg},
    {{.key = "fast_tracking_rmse_deg",
      .help = "distance to the wearer while the wearer moves fast, RMS",
      .definition =
          "tracking_rmse_deg where the wearer has 60 deg/s or more; or in segments labelled fast"},
     &ChannelScores::fast_tracking_rmse_deg},
    {{.key = "fast_jitter_rms_deg",
      .help = "trembling while the wearer moves fast, RMS",
      .definition =
          "jitter_rms_deg where the wearer has 60 deg/s or more; or in segments labelled fast"},
     &ChannelScores::fast_jitter_rms_deg},
    {{.key = "onset_tracking_rmse_deg",
      .help = "distance to the wearer just after the wearer starts from rest, RMS",
      .definition = "tracking_rmse_deg where 0.3 s have not passed since a movement began from "
                    "rest; or in segments labelled onset"},
     &ChannelScores::onset_tracking_rmse_deg},
    {{.key = "onset_jitter_rms_deg",
      .help = "trembling just after the wearer starts from rest, RMS",
      .definition = "jitter_rms_deg where 0.3 s have not passed since a movement began from rest; "
                    "or in segments labelled onset"},
     &ChannelScores::onset_jitter_rms_deg},
    {{.key = "reversal_tracking_rmse_deg",
      .help = "distance to the wearer around a change of direction, RMS",
      .definition = "tracking_rmse_deg where the wearer turns round within 0.15 s; or in segments "
                    "labelled reversal"},
     &ChannelScores::reversal_tracking_rmse_deg},
    {{.key = "reversal_jitter_rms_deg",
      .help = "trembling around a change of direction, RMS",
      .definition = "jitter_rms_deg where the wearer turns round within 0.15 s; or in segments "
                    "labelled reversal"},
     &ChannelScores::reversal_jitter_rms_deg},
    {{.key = "sparc",
      .help = "smoothness of the movements (0 is smoothest)",
      .definition = "minus the arc length of the normalised amplitude spectrum of the velocity up "
                    "to 10 Hz, mean over movements (Balasubramanian et al. 2015)",
      .lower_is_better = false},
     &ChannelScores::sparc},
    {{.key = "ldlj",
      .help = "smoothness of the movements (0 is smoothest)",
      .definition = "-ln(duration^3 / peak speed^2 * integral of jerk^2), mean over movements "
                    "(Balasubramanian et al. 2015)",
      .lower_is_better = false},
     &ChannelScores::ldlj},
    {{.key = "overshoot_deg",
      .help = "how far the hand goes beyond where the wearer stops or turns",
      .definition = "mean over movements of the largest excursion beyond the end of the movement, "
                    "the mean error taken off"},
     &ChannelScores::overshoot_deg},
    {{.key = "onset_delay_ms",
      .help = "how late the hand leaves its rest",
      .definition = "mean over movements from rest of the time between wearer and hand passing 10 "
                    "% of the amplitude"},
     &ChannelScores::onset_delay_ms},
    {{.key = "motor_speed_rms_deg_s",
      .help = "how loud the motors are",
      .definition = "RMS of the speed of the spool"},
     &ChannelScores::motor_speed_rms_deg_s},
    {{.key = "motor_speed_centroid_hz",
      .help = "how high the motors sound",
      .definition = "centre of the power spectrum of the speed of the spool (Welch 1967)"},
     &ChannelScores::motor_speed_centroid_hz},
    {{.key = "saturation_share",
      .help = "how often the servo gives all it has",
      .definition = "share of samples at the torque limit"},
     &ChannelScores::saturation_share},
    {{.key = "slack_share",
      .help = "how often a cable is slack",
      .definition = "share of samples with 0.01 N or less, mean over the cables of the channel"},
     &ChannelScores::slack_share},
    {{.key = "tension_peak_n",
      .help = "the largest pull",
      .definition = "largest tension of the cables of the channel"},
     &ChannelScores::tension_peak_n},
    {{.key = "grip_force_ripple_n",
      .help = "trembling of the grip: the force on a held object above 10 Hz, RMS",
      .definition =
          "RMS of the grip force behind the high pass of jitter_rms_deg, over stretches of "
          "grip, 0.63 s at both ends left out; of the whole hand"},
     &ChannelScores::grip_force_ripple_n},
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
