#include "sim/score/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "sim/score/delay.h"
#include "sim/score/fingertip_error.h"
#include "sim/score/grasp.h"
#include "sim/score/grip.h"
#include "sim/score/jitter.h"
#include "sim/score/motors.h"
#include "sim/score/no_score.h"
#include "sim/score/steps.h"
#include "sim/score/tracking.h"

namespace gauntlet::sim {
namespace {

/// Standard deviation about the mean of each range, pooled.
double PooledDeviation(std::span<const double> values, const std::vector<TickRange>& ranges) {
  double squares = 0.0;
  int count = 0;
  for (const TickRange& range : ranges) {
    const auto part = values.subspan(range.begin, range.end - range.begin);
    double mean = 0.0;
    for (const double value : part) mean += value;
    mean /= static_cast<double>(part.size());
    for (const double value : part) squares += (value - mean) * (value - mean);
    count += static_cast<int>(part.size());
  }
  return count == 0 ? kNoScore : std::sqrt(squares / count);
}

/// Mean over ranges of the size of the mean of each.
double MeanOffset(std::span<const double> error, const std::vector<TickRange>& ranges) {
  double offsets = 0.0;
  for (const TickRange& range : ranges) {
    const auto part = error.subspan(range.begin, range.end - range.begin);
    offsets +=
        std::abs(std::accumulate(part.begin(), part.end(), 0.0)) / static_cast<double>(part.size());
  }
  return ranges.empty() ? kNoScore : offsets / static_cast<double>(ranges.size());
}

double PeakTension(const ScoredCable& cable) {
  return cable.tension_n.empty() ? kNoScore : PeakWithin(cable.tension_n, cable.counted);
}

/// At a quantile [ms].
double AgeMs(const ScoredHand& hand, double share) {
  return hand.link.exist() ? 1e3 * SampleAge(hand.link, share, hand.counted) : kNoScore;
}

double Millimetres(double metres) { return 1e3 * metres; }

// The smallest differences that matter, each with its source or reason.
constexpr RelevantDifference kFeltAngle = {
    .absolute = 0.5,
    .reason =
        "below the smallest angle that people feel at a joint: 0.8 deg at the shoulder, 2.5 "
        "deg at a finger (Tan, Srinivasan, Eberman, Cheng 1994)"};
constexpr RelevantDifference kFeltPeak = {
    .absolute = 2.5,
    .reason = "the smallest angle that people feel at a finger joint (Tan et al. 1994)"};
constexpr RelevantDifference kVisibleTrembling = {
    .absolute = 0.05,
    .reason =
        "0.14 deg to and fro move a fingertip 9 cm away by 0.2 mm; an eye resolves 0.15 mm "
        "from half a metre (1 minute of arc)"};
constexpr RelevantDifference kPalmVibration = {
    .absolute = 0.1, .relative = 0.1, .reason = "a tenth, and not less than 0.1: a convention"};
constexpr RelevantDifference kNoticedDelay = {
    .absolute = 5.0,
    .reason =
        "people who drag something by a finger notice improvements well below 10 ms (Ng, "
        "Lepinski, Wigdor, Sanders, Dietz 2012)"};
constexpr RelevantDifference kPitch = {
    .absolute = 0.5,
    .relative = 0.1,
    .reason = "a tenth, and not less than half a hertz: a convention"};
constexpr RelevantDifference kReversals = {
    .absolute = 0.5,
    .relative = 0.1,
    .reason = "a tenth, and not less than one in two seconds: a convention"};
constexpr RelevantDifference kSpectralArc = {.absolute = 0.1, .reason = "a convention"};
constexpr RelevantDifference kJerk = {
    .absolute = 0.2, .reason = "a tenth of the RMS of the jerk, 2 ln(1.1) = 0.19: a convention"};
constexpr RelevantDifference kLoudness = {
    .absolute = 0.1,
    .relative = 0.12,
    .reason = "1 dB; of steady noise people hear changes from 0.4 dB on (Miller 1947)"};
constexpr RelevantDifference kShareOfTime = {.absolute = 0.01,
                                             .reason = "one sample in a hundred: a convention"};
constexpr RelevantDifference kSquaredAngle = {
    .absolute = 0.25,
    .relative = 0.1,
    .reason =
        "a tenth, and not less than the square of the 0.5 deg of tracking_rmse_deg: a "
        "convention"};
constexpr RelevantDifference kFeltForce = {
    .absolute = 0.01,
    .relative = 0.07,
    .reason =
        "people tell forces apart from 7 % on (Pang, Tan, Durlach 1991); 0.01 N is the "
        "weight of 1 g"};

constexpr RelevantDifference kMillimetre = {
    .absolute = 1.0, .relative = 0.1, .reason = "a tenth, and not less than 1 mm: a convention"};
constexpr RelevantDifference kTilt = {
    .absolute = 2.0,
    .relative = 0.1,
    .reason =
        "a tenth, and not less than 2 deg: a convention; benchmarks of grasps count 15 deg "
        "as failed (DexGraspBench)"};
constexpr RelevantDifference kForceRatio = {
    .absolute = 0.1,
    .relative = 0.07,
    .reason =
        "people tell forces apart from 7 % on (Pang, Tan, Durlach 1991); they hold 0.1 to "
        "0.4 above slip"};

// Rows that are alike but for a regime, group, tier or cause.
template <Regime regime>
constexpr MetricRow TrackingDuring(std::string_view key, std::string_view help,
                                   std::string_view definition) {
  return {{.key = key, .help = help, .definition = definition, .relevant_difference = kFeltAngle},
          [](const ScoredJoint& j) { return kDegPerRad * j.ErrorDuring(regime); }};
}

template <Regime regime>
constexpr MetricRow JitterDuring(std::string_view key, std::string_view help,
                                 std::string_view definition) {
  return {{.key = key,
           .help = help,
           .definition = definition,
           .relevant_difference = kVisibleTrembling},
          [](const ScoredJoint& j) { return kDegPerRad * j.TremblingDuring(regime); }};
}

template <ScoredGroup group>
constexpr MetricRow JitterOf(std::string_view key, std::string_view name, std::string_view help,
                             std::string_view definition) {
  return {{.key = key,
           .name = name,
           .unit = "deg RMS",
           .help = help,
           .definition = definition,
           .detailed = true,
           .needs_stretch = true,
           .relevant_difference = kVisibleTrembling},
          [](const ScoredHand& h) { return kDegPerRad * h.JitterOf_rad(group); }};
}

template <int tier>
constexpr MetricRow ShareOfTier(std::string_view key, std::string_view name, std::string_view help,
                                std::string_view definition) {
  return {{.key = key,
           .name = name,
           .unit = "share",
           .help = help,
           .definition = definition,
           .needs_link = true,
           .relevant_difference = kShareOfTime},
          [](const ScoredHand& h) {
            return h.link.exist() ? TierShare(h.link, tier, h.counted) : kNoScore;
          }};
}

template <ErrorCause cause>
constexpr MetricRow PartOfError(std::string_view key, std::string_view help,
                                std::string_view definition) {
  return {{.key = key,
           .help = help,
           .definition = definition,
           .needs_chain = true,
           .needs_link = cause == ErrorCause::kLinkLoss || cause == ErrorCause::kLinkJitter,
           .relevant_difference = kSquaredAngle},
          [](const ScoredJoint& j) { return kDegPerRad * kDegPerRad * j.PartOfError(cause); }};
}

template <ErrorCause cause>
constexpr MetricRow ErrorWithout(std::string_view key, std::string_view name, std::string_view help,
                                 std::string_view definition) {
  return {{.key = key,
           .name = name,
           .unit = "deg RMS",
           .help = help,
           .definition = definition,
           .needs_switched = true,
           .relevant_difference = kFeltAngle},
          [](const ScoredJoint& j) { return kDegPerRad * j.ErrorWithout(cause); }};
}

constexpr MetricRow kRows[] = {
    {{.key = "tracking_rmse_deg",
      .name = "tracking error",
      .unit = "deg RMS",
      .help = "RMS of hand minus wearer",
      .definition = "sqrt(mean((hand - reference)^2))",
      .main = true,
      .relevant_difference = kFeltAngle},
     [](const ScoredJoint& j) { return kDegPerRad * RmsWithin(j.error_rad(), 0, j.counted); }},
    {{.key = "delay_ms",
      .name = "delay",
      .unit = "ms",
      .help = "lag of the hand behind the wearer",
      .definition = "lag of the largest Pearson correlation over the overlap, within half the "
                    "dominant period, refined by a parabola (Knapp and Carter 1976)",
      .main = true,
      .relevant_difference = kNoticedDelay},
     [](const ScoredJoint& j) {
       return j.delay_ticks() ? 1000.0 * *j.delay_ticks() / j.rate_hz : kNoScore;
     }},
    {{.key = "aligned_rmse_deg",
      .name = "aligned error",
      .unit = "deg RMS",
      .help = "RMS of hand minus wearer, without the delay",
      .definition = "sqrt(mean((hand(t + delay_ms) - reference(t))^2)); the plain difference where "
                    "there is no delay",
      .main = true,
      .relevant_difference = kFeltAngle},
     [](const ScoredJoint& j) {
       return kDegPerRad * (j.delay_ticks() ? AlignedRms(j.reference_rad, j.hand_rad,
                                                         *j.delay_ticks(), j.counted)
                                            : RmsWithin(j.error_rad(), 0, j.counted));
     }},
    {{.key = "peak_error_deg",
      .help = "largest difference between hand and wearer",
      .definition = "max |hand - reference|",
      .relevant_difference = kFeltPeak},
     [](const ScoredJoint& j) { return kDegPerRad * PeakWithin(j.error_rad(), j.counted); }},
    {{.key = "jitter_rms_deg",
      .name = "jitter",
      .unit = "deg RMS",
      .help = "RMS of the hand's angle above score.jitter_above_hz (10 Hz)",
      .definition = "RMS behind a zero-phase high pass at score.jitter_above_hz: linear phase, "
                    "Kaiser window, 0.8 to 1.2 of it (8 to 12 Hz), 80 dB; 6.3 of its periods (0.63 "
                    "s) at both ends left out; 3 to 10 % too large with the default hand.step_ms",
      .main = true,
      .needs_stretch = true,
      .relevant_difference = kVisibleTrembling},
     [](const ScoredJoint& j) { return kDegPerRad * j.jitter_rad(); }},
    {{.key = "noise_jitter_rms_deg",
      .name = "noise jitter",
      .unit = "deg RMS",
      .help = "jitter caused by the glove's noise, without that of command frames and limits",
      .definition = "jitter_rms_deg of the hand less the hand of the same trial with a noise-free "
                    "glove",
      .main = true,
      .needs_twin = true,
      .needs_stretch = true,
      .relevant_difference = kVisibleTrembling},
     [](const ScoredJoint& j) { return kDegPerRad * j.noise_jitter_rad(); }},
    {{.key = "command_reversals_per_s",
      .name = "command reversals",
      .unit = "per s",
      .help = "reversals of the motor command",
      .definition = "sign changes between successive non-zero increments of the integer command, "
                    "per second (Bai, Jiang, Yokoi 2021, figure 12)",
      .main = true,
      .relevant_difference = kReversals},
     [](const ScoredMotor& m) {
       return m.command_counts.empty() ? kNoScore
                                       : ReversalsPerSecond(m.command_counts, m.rate_hz, m.counted);
     }},
    TrackingDuring<Regime::kRest>(
        "rest_tracking_rmse_deg", "tracking error while the wearer holds still",
        "tracking_rmse_deg where the wearer is slower than 5 deg/s for 0.3 s, without "
        "the first 0.5 s; or in segments labelled rest"),
    {{.key = "rest_jitter_deg",
      .help = "drift of the hand while the wearer holds still",
      .definition = "standard deviation of the hand about its mean of each rest, pooled over rests",
      .relevant_difference = kVisibleTrembling},
     [](const ScoredJoint& j) {
       return kDegPerRad * PooledDeviation(j.hand_rad, j.wearer().Of(Regime::kRest));
     }},
    {{.key = "rest_offset_deg",
      .help = "offset of the hand while the wearer holds still",
      .definition = "mean over rests of |mean(hand - reference)|: what no filter of noise changes",
      .relevant_difference = kFeltAngle},
     [](const ScoredJoint& j) {
       return kDegPerRad * MeanOffset(j.error_rad(), j.wearer().Of(Regime::kRest));
     }},
    TrackingDuring<Regime::kSlow>(
        "slow_tracking_rmse_deg", "tracking error in slow motion",
        "tracking_rmse_deg where the wearer is below 60 deg/s and not at rest; or in "
        "segments labelled slow"),
    JitterDuring<Regime::kSlow>(
        "slow_jitter_rms_deg", "jitter in slow motion",
        "jitter_rms_deg where the wearer is below 60 deg/s and not at rest; or in "
        "segments labelled slow"),
    TrackingDuring<Regime::kFast>(
        "fast_tracking_rmse_deg", "tracking error in fast motion",
        "tracking_rmse_deg where the wearer has 60 deg/s or more; or in segments labelled fast"),
    JitterDuring<Regime::kFast>(
        "fast_jitter_rms_deg", "jitter in fast motion",
        "jitter_rms_deg where the wearer has 60 deg/s or more; or in segments labelled fast"),
    TrackingDuring<Regime::kOnset>(
        "onset_tracking_rmse_deg", "tracking error after a start from rest",
        "tracking_rmse_deg where 0.3 s have not passed since a movement began from "
        "rest; or in segments labelled onset"),
    JitterDuring<Regime::kOnset>(
        "onset_jitter_rms_deg", "jitter after a start from rest",
        "jitter_rms_deg where 0.3 s have not passed since a movement began from rest; "
        "or in segments labelled onset"),
    TrackingDuring<Regime::kReversal>(
        "reversal_tracking_rmse_deg", "tracking error around a change of direction",
        "tracking_rmse_deg where the wearer turns round within 0.15 s; or in segments "
        "labelled reversal"),
    JitterDuring<Regime::kReversal>(
        "reversal_jitter_rms_deg", "jitter around a change of direction",
        "jitter_rms_deg where the wearer turns round within 0.15 s; or in segments "
        "labelled reversal"),
    {{.key = "sparc",
      .help = "smoothness of the movements (0 is smoothest)",
      .definition = "minus the arc length of the normalised amplitude spectrum of the velocity up "
                    "to 10 Hz, mean over movements (Balasubramanian et al. 2015)",
      .lower_is_better = false,
      .relevant_difference = kSpectralArc},
     [](const ScoredJoint& j) { return j.smoothness().sparc; }},
    {{.key = "ldlj",
      .help = "smoothness of the movements (0 is smoothest)",
      .definition = "-ln(duration^3 / peak speed^2 * integral of jerk^2), mean over movements "
                    "(Balasubramanian et al. 2015)",
      .lower_is_better = false,
      .relevant_difference = kJerk},
     [](const ScoredJoint& j) { return j.smoothness().ldlj; }},
    {{.key = "overshoot_deg",
      .help = "overshoot of the hand where the wearer stops or turns",
      .definition = "mean over movements of the largest excursion beyond the end of the movement, "
                    "the mean error taken off",
      .relevant_difference = kFeltAngle},
     [](const ScoredJoint& j) {
       return kDegPerRad * Overshoot(j.reference_rad, j.hand_rad, j.rate_hz, j.wearer().movements,
                                     j.delay_ticks().value_or(0.0), j.counted);
     }},
    {{.key = "onset_delay_ms",
      .help = "delay of the hand when it leaves rest",
      .definition = "mean over movements from rest of the time between wearer and hand passing 10 "
                    "% of the amplitude",
      .relevant_difference = kNoticedDelay},
     [](const ScoredJoint& j) {
       return 1000.0 / j.rate_hz *
              OnsetDelay(j.reference_rad, j.hand_rad, j.rate_hz, j.wearer().movements);
     }},
    {{.key = "motor_speed_rms_deg_s",
      .help = "loudness of the motors",
      .definition = "RMS of the speed of the spool",
      .relevant_difference = kLoudness},
     [](const ScoredMotor& m) { return kDegPerRad * RmsWithin(m.speed_rad_s, 0, m.counted); }},
    {{.key = "motor_speed_centroid_hz",
      .help = "mean frequency of the motors' sound, with the wearer's motion",
      .definition = "centre of the power spectrum of the speed of the spool (Welch 1967); less "
                    "noise moves it to the motion: of noise motor_noise_centroid_hz tells",
      .relevant_difference = kPitch},
     [](const ScoredMotor& m) {
       return m.speed_rad_s.empty()
                  ? kNoScore
                  : SpectralCentroid(m.speed_rad_s, m.rate_hz, m.counted, m.fourier);
     }},
    {{.key = "motor_noise_rms_deg_s",
      .help = "loudness of the motors caused by the glove's noise",
      .definition = "RMS of the speed of the spool less that of the same trial with a noise-free "
                    "glove",
      .needs_twin = true,
      .relevant_difference = kLoudness},
     [](const ScoredMotor& m) { return kDegPerRad * RmsWithin(m.noise_rad_s, 0, m.counted); }},
    {{.key = "motor_noise_centroid_hz",
      .help = "mean frequency of the motors' sound caused by the glove's noise",
      .definition = "centre of the power spectrum (Welch 1967) of the speed of the spool less that "
                    "of the same trial with a noise-free glove",
      .needs_twin = true,
      .relevant_difference = kPitch},
     [](const ScoredMotor& m) {
       return m.noise_rad_s.empty()
                  ? kNoScore
                  : SpectralCentroid(m.noise_rad_s, m.rate_hz, m.counted, m.fourier);
     }},
    {{.key = "saturation_share",
      .help = "share of time with actuator saturation",
      .definition =
          "share of samples in which the servo wants more torque than it has at this speed",
      .relevant_difference = kShareOfTime},
     [](const ScoredMotor& m) { return m.saturation_share.value_or(kNoScore); }},
    {{.key = "slack_share",
      .help = "share of time with a slack cable",
      .definition = "share of samples with 0.01 N or less, per cable",
      .relevant_difference = kShareOfTime},
     [](const ScoredCable& c) {
       return c.tension_n.empty() ? kNoScore : SlackShare(c.tension_n, c.counted);
     }},
    {{.key = "tension_peak_n",
      .help = "largest tension of each cable",
      .definition = "largest tension, per cable",
      .alike = false,
      .relevant_difference = kFeltForce},
     [](const ScoredCable& c) { return PeakTension(c); }},
    {{.key = "tension_peak_share",
      .help = "largest tension, as a share of the stall tension of its motor",
      .definition = "largest tension over (stall torque of the motor / radius of its spool), per "
                    "cable",
      .relevant_difference = kFeltForce},
     [](const ScoredCable& c) {
       return c.stall_tension_n ? PeakTension(c) / *c.stall_tension_n : kNoScore;
     }},
    {{.key = "grip_force_ripple_n",
      .name = "grip force ripple",
      .unit = "N",
      .help = "RMS of the grip force above score.jitter_above_hz (10 Hz)",
      .definition =
          "RMS of the grip force behind the high pass of jitter_rms_deg, over stretches of "
          "grip, 6.3 periods (0.63 s) at both ends left out; of the whole hand",
      .main = true,
      .relevant_difference = kFeltForce},
     [](const ScoredHand& h) {
       return h.grip_force_n.empty() ? kNoScore
                                     : GripForceRipple(h.grip_force_n, h.rate_hz, h.jitter_above_hz,
                                                       h.counted, h.fourier);
     }},
    {{.key = "object_slip_mm",
      .name = "object slip",
      .unit = "mm",
      .help = "largest shift of the held object in the palm",
      .definition = "largest distance of the object's centre, in the frame of the palm, from where "
                    "it was when the hand lifted it off its support, while the hand touches it",
      .main = true,
      .extreme = true,
      .relevant_difference = kMillimetre},
     [](const ScoredHand& h) {
       return h.grasp.exist() ? Millimetres(ObjectSlip(h.grasp, h.counted)) : kNoScore;
     }},
    {{.key = "object_tilt_deg",
      .name = "object tilt",
      .unit = "deg",
      .help = "largest tilt of the object",
      .definition = "largest angle of the object's axis: against the vertical until the hand lifts "
                    "it; then in the frame of the palm against where it was when lifted",
      .main = true,
      .extreme = true,
      .relevant_difference = kTilt},
     [](const ScoredHand& h) {
       return h.grasp.exist() ? kDegPerRad * ObjectTilt(h.grasp, h.counted) : kNoScore;
     }},
    {{.key = "grip_force_ratio",
      .name = "grip force ratio",
      .help = "least grip force on the held object, over the least that holds it (slips at 1)",
      .definition =
          "min of mu sum(N) / |sum(f)|, means over 20 ms, while held: f forces of the hand "
          "on the object, N their normal parts, mu hand.object.friction (Westling and "
          "Johansson 1984)",
      .lower_is_better = false,
      .detailed = true,
      .extreme = true,
      .relevant_difference = kForceRatio},
     [](const ScoredHand& h) {
       return h.grasp.exist() ? GripForceRatio(h.grasp, h.counted) : kNoScore;
     }},
    {{.key = "lost_contact_share",
      .name = "lost contact",
      .unit = "share",
      .help = "share of time in which the hand does not touch the lifted object",
      .definition =
          "share of samples with a grip force below 0.1 N, from lifting the object off its "
          "support until it stands there again, or to the end if it falls",
      .detailed = true,
      .relevant_difference = kShareOfTime},
     [](const ScoredHand& h) {
       return h.grasp.exist() ? LostContactShare(h.grasp, h.counted) : kNoScore;
     }},
    {{.key = "object_dropped_share",
      .name = "dropped",
      .unit = "share",
      .help = "share of trials in which the hand drops the lifted object",
      .definition = "1 if, after a hold, neither the hand nor the support touches the object for "
                    "0.1 s, else 0",
      .detailed = true,
      .relevant_difference = kShareOfTime},
     [](const ScoredHand& h) { return h.grasp.exist() ? ObjectDropped(h.grasp) : kNoScore; }},
    {{.key = "fingertip_error_mm",
      .name = "fingertip error",
      .unit = "mm RMS",
      .help = "RMS distance between the fingertips of hand and wearer",
      .definition =
          "sqrt(mean(|p_hand - p_reference|^2)) over fingertips, every 10 ms: both by the "
          "hand's kinematics from joint angles, in the frame of the palm",
      .detailed = true,
      .needs_fingertips = true,
      .relevant_difference = kMillimetre},
     [](const ScoredHand& h) {
       return h.fingertips.exist() ? Millimetres(FingertipError(h.fingertips, h.counted))
                                   : kNoScore;
     }},
    {{.key = "pinch_distance_error_mm",
      .name = "pinch error",
      .unit = "mm RMS",
      .help = "RMS error of the distance of thumb and finger in a pinch",
      .definition = "RMS of d_hand - d_reference, every 10 ms where d_reference is below 40 mm: d "
                    "the distance of thumb tip and fingertip as for fingertip_error_mm",
      .detailed = true,
      .needs_fingertips = true,
      .relevant_difference = kMillimetre},
     [](const ScoredHand& h) {
       return h.fingertips.exist() ? Millimetres(PinchDistanceError(h.fingertips, h.counted))
                                   : kNoScore;
     }},
    JitterOf<ScoredGroup::kFinger>(
        "finger_jitter_rms_deg", "finger jitter",
        "jitter_rms_deg of the joints of fingers and thumb",
        "mean of jitter_rms_deg over the measured joints between palm and fingertips"),
    JitterOf<ScoredGroup::kWrist>(
        "wrist_jitter_rms_deg", "wrist jitter", "jitter_rms_deg of the joints of wrist and forearm",
        "the same over joints that move the palm, with motors of hand.servo"),
    JitterOf<ScoredGroup::kArm>(
        "arm_jitter_rms_deg", "arm jitter", "jitter_rms_deg of elbow and shoulder",
        "the same over joints that move the palm, with motors of hand.arm_servo"),
    {{.key = "arm_share_of_finger_jitter",
      .help = "share of finger jitter that is not there with an arm at rest",
      .definition = "1 - finger_jitter_rms_deg of the same trial in which the joints of "
                    "hand.arm_servo hold their first posture / finger_jitter_rms_deg; below 0 "
                    "where the arm calms the fingers",
      .needs_switched = true,
      .relevant_difference = kShareOfTime},
     [](const ScoredHand& h) { return h.ArmShareOfJitter(); }},
    {{.key = "palm_acceleration_m_s2",
      .name = "palm vibration",
      .unit = "m/s2 RMS",
      .help = "RMS of the palm's acceleration above score.jitter_above_hz (10 Hz)",
      .definition = "sqrt(sum over x, y, z of mean(a^2)), a the difference of the palm's velocity "
                    "from tick to tick, behind the high pass of jitter_rms_deg",
      .detailed = true,
      .needs_stretch = true,
      .relevant_difference = kPalmVibration},
     [](const ScoredHand& h) {
       return h.palm_velocity_m_s == nullptr
                  ? kNoScore
                  : AccelerationAbove(*h.palm_velocity_m_s, h.rate_hz, h.jitter_above_hz, h.counted,
                                      h.fourier);
     }},
    {{.key = "digit_overlap_share",
      .help = "share of time with interpenetration of fingers",
      .definition =
          "share of samples in which two fingers interpenetrate by more than 2 mm, looked at every "
          "10 ms; of the whole hand",
      .relevant_difference = kShareOfTime},
     [](const ScoredHand& h) {
       constexpr double kDeepM = 2e-3;
       const auto is_deep = [&](int n) { return h.digit_overlap_m[n] > kDeepM; };
       return h.digit_overlap_m.empty() ? kNoScore : ShareOfTicks(h.counted, is_deep);
     }},
    {{.key = "sample_age_p50_ms",
      .name = "sample age p50",
      .unit = "ms",
      .help = "median age of the glove sample behind the command that the servos hold",
      .definition = "quantile 0.5 over time of now - capture of that sample; with a link alone",
      .needs_link = true,
      .relevant_difference = kNoticedDelay},
     [](const ScoredHand& h) { return AgeMs(h, 0.5); }},
    {{.key = "sample_age_p99_ms",
      .name = "sample age p99",
      .unit = "ms",
      .help = "age of that sample which is exceeded in 1 % of the time",
      .definition = "quantile 0.99 of the same",
      .needs_link = true,
      .relevant_difference = kNoticedDelay},
     [](const ScoredHand& h) { return AgeMs(h, 0.99); }},
    {{.key = "sample_age_max_ms",
      .name = "largest sample age",
      .unit = "ms",
      .help = "largest age of that sample",
      .definition = "largest value of the same",
      .needs_link = true,
      .extreme = true,
      .relevant_difference = kNoticedDelay},
     [](const ScoredHand& h) { return AgeMs(h, 1.0); }},
    {{.key = "frozen_share",
      .name = "frozen",
      .unit = "share",
      .help = "share of time in which the command is not renewed by a newer glove sample",
      .definition = "share of samples at which the command is from the same glove sample as one "
                    "period of command frames before",
      .needs_link = true,
      .relevant_difference = kShareOfTime},
     [](const ScoredHand& h) {
       return h.link.exist() ? FrozenShare(h.link, h.rate_hz, h.counted) : kNoScore;
     }},
    ShareOfTier<1>("watchdog_hold_share", "watchdog: hold",
                   "share of time in which a watchdog holds the command",
                   "share of samples whose higher tier of the two watchdogs is hold"),
    ShareOfTier<2>("watchdog_relax_share", "watchdog: relax",
                   "share of time in which a watchdog relaxes the hand", "the same for relax"),
    ShareOfTier<3>("watchdog_off_share", "watchdog: off",
                   "share of time in which a watchdog has the motors off, or sends no commands",
                   "the same for off"),
    {{.key = "command_jump_deg",
      .name = "command jump",
      .unit = "deg",
      .help = "largest jump of the motor command, as an angle of the spool",
      .definition = "max |command(n) - command(n - 1)| over the counts per degree, per motor; with "
                    "a link alone",
      .needs_link = true,
      .extreme = true,
      .relevant_difference = kFeltPeak},
     [](const ScoredMotor& m) {
       return m.command_counts.empty() || !m.deg_per_count
                  ? kNoScore
                  : *m.deg_per_count * LargestJump(m.command_counts, m.counted);
     }},
    PartOfError<ErrorCause::kNoise>(
        "error_noise_deg2", "part of the mean square error: noise and faults of the glove",
        "mean((h_0 - h_1) (h_0 - reference)): h_0 the hand, h_1 that of the same trial "
        "with a noise-free glove"),
    PartOfError<ErrorCause::kGlove>(
        "error_glove_deg2", "part of the mean square error: calibration errors of the glove",
        "the same with h_1 - h_2: also with sensors as the controller takes them to be"),
    PartOfError<ErrorCause::kLinkLoss>(
        "error_link_loss_deg2", "part of the mean square error: frames that a link loses",
        "the same with h_2 - h_3: also without losses; with a link alone"),
    PartOfError<ErrorCause::kLinkJitter>(
        "error_link_jitter_deg2", "part of the mean square error: link delays that vary",
        "the same with h_3 - h_4: also with every delay at its mean; with a link alone"),
    PartOfError<ErrorCause::kLink>(
        "error_link_deg2", "part of the mean square error: command frames and link delay",
        "the same with h_4 - h_5: also with commands at once, at every tick"),
    PartOfError<ErrorCause::kSaturation>(
        "error_saturation_deg2", "part of the mean square error: actuator saturation",
        "the same with h_5 - h_6: also with motors of unlimited torque and speed"),
    PartOfError<ErrorCause::kFriction>("error_friction_deg2",
                                       "part of the mean square error: friction and backlash",
                                       "the same with h_6 - h_7: also without these"),
    PartOfError<ErrorCause::kServo>(
        "error_servo_deg2", "part of the mean square error: lag, steps and dead band of the servos",
        "the same with h_7 - h_8: also with ideal servos"),
    PartOfError<ErrorCause::kRest>(
        "error_rest_deg2",
        "part of the mean square error: masses, cable stretch and coupling of the hand",
        "the same with h_8 - h_9, h_9 what the controller asks the joints for"),
    PartOfError<ErrorCause::kController>(
        "error_controller_deg2", "part of the mean square error: filter and prediction",
        "the same with h_9 - reference; all parts sum to tracking_rmse_deg^2"),
    {{.key = "error_with_all_deg",
      .name = "error with all causes",
      .unit = "deg RMS",
      .help = "tracking error in the time of the trials with one cause switched off",
      .definition =
          "tracking_rmse_deg over the motion, or over its first seconds where these trials "
          "are cut",
      .needs_switched = true,
      .relevant_difference = kFeltAngle},
     [](const ScoredJoint& j) { return kDegPerRad * j.ErrorWithAll(); }},
    ErrorWithout<ErrorCause::kNoise>(
        "error_without_noise_deg", "error without noise",
        "tracking error without noise and faults of the glove",
        "the same of a trial with a noise-free glove, all else as it is"),
    ErrorWithout<ErrorCause::kGlove>("error_without_glove_deg", "error without glove",
                                     "tracking error without calibration errors of the glove",
                                     "the same with sensors as the controller takes them to be"),
    ErrorWithout<ErrorCause::kLink>("error_without_link_deg", "error without link",
                                    "tracking error without link and command frames",
                                    "the same with commands at once, at every tick"),
    ErrorWithout<ErrorCause::kSaturation>("error_without_saturation_deg",
                                          "error without saturation",
                                          "tracking error without actuator saturation",
                                          "the same with motors of unlimited torque and speed"),
    ErrorWithout<ErrorCause::kFriction>("error_without_friction_deg", "error without friction",
                                        "tracking error without friction and backlash",
                                        "the same without these"),
    ErrorWithout<ErrorCause::kServo>(
        "error_without_servo_deg", "error without servo",
        "tracking error without lag, steps and dead band of the servos",
        "the same with ideal servos, which hold against friction, too"),
};

constexpr int kCount = static_cast<int>(std::size(kRows));

constexpr std::array<Metric, kCount> kMetrics = [] {
  std::array<Metric, kCount> metrics;
  for (int i = 0; i < kCount; ++i) {
    metrics[i] = kRows[i].metric;
    metrics[i].part = static_cast<ScoredPart>(kRows[i].measure.index());
  }
  return metrics;
}();

template <std::size_t count>
constexpr std::array<CauseMetric, count> Placed(std::array<CauseMetric, count> metrics) {
  for (CauseMetric& one : metrics) {
    while (kMetrics[one.metric].key != one.key) ++one.metric;  // a misspelt key: no constant
  }
  return metrics;
}

constexpr auto kTrackingErrorParts = Placed<kErrorCauseCount>({{
    {.key = "error_noise_deg2", .name = "noise"},
    {.key = "error_glove_deg2", .name = "glove"},
    {.key = "error_link_loss_deg2", .name = "link loss"},
    {.key = "error_link_jitter_deg2", .name = "link jitter"},
    {.key = "error_link_deg2", .name = "link"},
    {.key = "error_saturation_deg2", .name = "motor limit"},
    {.key = "error_friction_deg2", .name = "friction"},
    {.key = "error_servo_deg2", .name = "servo"},
    {.key = "error_rest_deg2", .name = "rest"},
    {.key = "error_controller_deg2", .name = "control"},
}});

constexpr auto kSwitchedErrors = Placed<kSwitchedCauseCount>({{
    {.key = "error_without_noise_deg", .name = "glove noise"},
    {.key = "error_without_glove_deg", .name = "glove errors"},
    {.key = "error_without_link_deg", .name = "the link"},
    {.key = "error_without_saturation_deg", .name = "motor limits"},
    {.key = "error_without_friction_deg", .name = "friction"},
    {.key = "error_without_servo_deg", .name = "the servo"},
}});

}  // namespace

std::span<const CauseMetric> TrackingErrorParts() { return kTrackingErrorParts; }

std::span<const CauseMetric> SwitchedErrors() { return kSwitchedErrors; }

std::size_t ErrorWithAll() { return MetricIndex("error_with_all_deg"); }

std::span<const MetricRow> MetricRows() { return kRows; }

std::span<const Metric> Metrics() { return kMetrics; }

double RelevantDifferenceBetween(const Metric& metric, double first, double second) {
  const RelevantDifference& least = metric.relevant_difference;
  const double size = std::min(std::abs(first), std::abs(second));
  if (std::isnan(first) || std::isnan(second)) return kNoScore;
  return std::max(least.absolute, least.relative * size);
}

std::optional<std::size_t> FindMetric(std::string_view key) {
  const auto found = std::ranges::find(kMetrics, key, &Metric::key);
  if (found == kMetrics.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kMetrics.begin());
}

std::size_t MetricIndex(std::string_view key) {
  if (const auto index = FindMetric(key)) return *index;
  throw std::invalid_argument("no metric is called " + std::string(key));
}

}  // namespace gauntlet::sim
