#pragma once

#include <cstddef>
#include <cstdint>

/// The controller for a microcontroller: one header in `float`, no library, no memory but its own,
/// neither exceptions nor run-time types. `gauntlet export --embedded` writes its settings as
/// constants.
namespace gauntlet::embedded {

/// A bank of Kalman filters that are mixed by how far each has missed of late, as
/// controller::AdaptivePredictionConfig says; kept for so many `Steps`. None: no prediction.
template <std::size_t Channels, std::size_t Steps>
struct Prediction {
  static constexpr std::size_t kFilters = 6;
  float transition[kFilters * 3][3];  // A of each filter, row below row
  float angle_of_state[kFilters][2];  // H; no filter has its third state in the angle
  float gain[kFilters * 3][Channels];
  float look_ahead[kFilters * 3][Channels];
  float inverse_r[Channels];  // 1/rad^2
  std::uint32_t delay_steps[Channels];
  float forget;
  float least_miss;
  float most_miss;
};
template <std::size_t Channels>
struct Prediction<Channels, 0> {};

/// State of the bank.
template <std::size_t Channels, std::size_t Steps>
struct PredictionState {
  static constexpr std::size_t kFilters = Prediction<Channels, Steps>::kFilters;
  struct Channel {
    float x[kFilters][3];
    float miss[kFilters];
    float start_rad;    // where it was before its first sample
    std::uint32_t age;  // in steps since then, up to Steps
    bool fresh;         // its next sample is its first
  };
  Channel channels[Channels];
  float expected_rad[Steps][kFilters][Channels];  // by each filter, one step in each row
  std::size_t newest;                             // row
};
template <std::size_t Channels>
struct PredictionState<Channels, 0> {};

/// Settings that `gauntlet export --embedded` writes. They belong into read-only memory.
///
/// Shapes: as the arrays say. Units: counts of the converter, rad, motor counts, samples or ticks.
template <std::size_t Channels, std::size_t Joints, std::size_t Motors, std::size_t Corners,
          std::size_t Steps = 0>
struct Settings {
  // Which samples are trusted, as SampleGuard does.
  float min_counts[Channels];  // of the converter
  float full_scale_counts[Channels];
  bool trust_full_scale;
  float jump_counts[Channels];
  std::uint32_t jump_confirm_samples;
  std::uint32_t stuck_samples;

  // A channel without a trusted value for so long goes where the glove is lost to.
  std::uint32_t lost_ticks;  // 0: never
  bool lost_rests;           // to rest_rad, else to its last trusted value
  float lost_step_rad;       // per command frame
  float rest_rad[Channels];

  float start_counts[Channels];  // of a channel that decides no joint

  // A broken line per channel; its first and last pieces go on.
  float corner_counts[Channels][Corners];
  float corner_rad[Channels][Corners];
  float rad_per_count[Channels][Corners - 1];

  // A filter of constant gains on position, velocity and acceleration in steps of one sample.
  bool filter_angles;  // else counts
  bool filter_at_event;
  float gain[3][Channels];

  // joint = offset + weight channel
  float joint_offset_rad[Joints];
  float joint_weight[Joints][Channels];
  float joint_min_rad[Joints];
  float joint_max_rad[Joints];
  float joint_reference_rad[Joints];

  // motor = center + counts_per_rad (joint - reference)
  float motor_counts_per_rad[Motors][Joints];
  std::int32_t motor_center_counts[Motors];
  std::int32_t motor_min_counts[Motors];
  std::int32_t motor_max_counts[Motors];
  float motor_limit_counts[Motors];           // per event
  float joint_rad_per_count[Joints][Motors];  // back; 0 where motors do not decide the joint
  std::int32_t joint_of_channel[Channels];    // whose angle decides where it starts; -1: none
  float motor_stay_counts;  // a command stays while it is no farther off; 0: nearest

  std::uint32_t ticks_per_event;

  [[no_unique_address]] Prediction<Channels, Steps> prediction = {};
};

/// From glove to motors, one call per tick of the control loop: controller::Controller for what
/// Settings holds. It is all the memory that there is: make it static, next to its settings.
///
///     filter   x^- = x + w + a/2,  w^- = w + a,  e = z - x^-
///              x = x^- + k1 e,  w = w^- + k2 e,  a = a + k3 e
///     bank     x^- = A x,  x = x^- + K (z - H x^-),  y = look_ahead x  for each filter
///
/// Its commands are at most one count (with a wider hysteresis, that much) beside those of
/// controller::Controller, which has the same equations in `double` and says where they come from
/// (tests/settings/embedded_test.cc). It starts and loses samples as that one does: until the first
/// good sample of its channel a joint stays where Reset() says that the motors are. One difference:
/// frames have no numbers.
template <std::size_t Channels, std::size_t Joints, std::size_t Motors, std::size_t Corners,
          std::size_t Steps = 0>
class Controller {
 public:
  using Constants = Settings<Channels, Joints, Motors, Corners, Steps>;

  /// The motors are at their centers. `settings` is not copied.
  explicit Controller(const Constants& settings) noexcept : settings_(settings) {
    Reset(settings.motor_center_counts);
  }

  /// Forgets the glove; the motors are at these counts, one per motor, as the robot reads them.
  void Reset(const std::int32_t* motor_counts) noexcept {
    ticks_to_event_ = 0;
    for (std::size_t j = 0; j < Joints; ++j) {
      joint_rad_[j] = settings_.joint_reference_rad[j];
      for (std::size_t m = 0; m < Motors; ++m) {
        const float turned = static_cast<float>(motor_counts[m]) -
                             static_cast<float>(settings_.motor_center_counts[m]);
        joint_rad_[j] += settings_.joint_rad_per_count[j][m] * turned;
      }
    }
    for (std::size_t i = 0; i < Channels; ++i) {
      channels_[i] = Channel{};
      channels_[i].trusted = StartCounts(i);
      channels_[i].raw = settings_.min_counts[i] - 2.0F;  // no sample: out of range
      channels_[i].silent_ticks = ~std::uint32_t{0};      // the first tick makes it 0
      Start(i);
    }
    for (std::size_t i = 0; i < Motors; ++i) {
      motors_[i].limited = static_cast<float>(motor_counts[i]);
      motors_[i].command = motor_counts[i];
    }
  }

  /// A tick, with a new sample of the glove (a value per channel; NaN for a missing one) or without
  /// (null). True if a frame is due: `motor_counts` has new commands then, within each motor's
  /// range, and is not touched else.
  bool Step(const float* counts, std::int32_t* motor_counts) noexcept {
    for (Channel& channel : channels_) {
      if (channel.silent_ticks != settings_.lost_ticks) ++channel.silent_ticks;
    }
    if (counts != nullptr) {
      for (std::size_t i = 0; i < Channels; ++i) AcceptSample(i, counts[i]);
      if (!settings_.filter_at_event) Filter();
    }
    if (ticks_to_event_-- > 0) return false;
    ticks_to_event_ = settings_.ticks_per_event - 1;
    if (settings_.filter_at_event) Filter();
    if (settings_.lost_ticks > 0) MoveLostChannels();
    MoveJoints();
    MoveMotors();
    for (std::size_t i = 0; i < Motors; ++i) motor_counts[i] = motors_[i].command;
    return true;
  }

  /// True if a channel had no trusted value for `untrusted.lost_after_ms` of the settings.
  bool lost(std::size_t channel) const noexcept {
    return settings_.lost_ticks > 0 && channels_[channel].silent_ticks == settings_.lost_ticks;
  }
  /// How many samples of a channel could not be trusted since Reset().
  std::uint32_t untrusted_samples(std::size_t channel) const noexcept {
    return channels_[channel].untrusted;
  }

 private:
  struct Channel {
    float trusted, raw, candidate;
    float x, w, a;    // of the filter
    float angle_rad;  // behind it
    float lost_rad;   // where it is while it is lost
    std::uint32_t same, confirmed, untrusted;
    std::uint32_t silent_ticks;  // since the last trusted value
    bool seen, moves_lost;
    bool starts;  // its filter, with its next step
  };
  struct Motor {
    float limited;
    std::int32_t command;
  };

  static float Distance(float from, float to) noexcept { return from < to ? to - from : from - to; }
  static float Clamp(float value, float low, float high) noexcept {
    return value < low ? low : value > high ? high : value;
  }

  /// A sample; its filter starts with the first one that is trusted, and with one after a loss.
  void AcceptSample(std::size_t i, float counts) noexcept {
    Channel& channel = channels_[i];
    if (!IsTrusted(i, counts)) {
      ++channel.untrusted;
      return;
    }
    channel.trusted = counts;
    channel.silent_ticks = 0;
    if (channel.seen && !channel.moves_lost) return;
    channel.seen = true;
    channel.moves_lost = false;
    Start(i);
  }
  bool IsTrusted(std::size_t i, float counts) noexcept {
    Channel& channel = channels_[i];
    const float least = settings_.min_counts[i];
    const float most = settings_.full_scale_counts[i];
    const float jump = settings_.jump_counts[i];
    const bool inside = counts > least && counts < most;
    const bool at_end = counts == least || counts == most;
    if (!inside && !(at_end && settings_.trust_full_scale)) return false;
    if (Distance(counts, channel.trusted) <= jump) {
      channel.confirmed = 0;
    } else {
      const bool stays = channel.confirmed > 0 && Distance(counts, channel.candidate) <= jump;
      channel.candidate = counts;
      channel.confirmed = stays ? channel.confirmed + 1 : 1;
      if (channel.confirmed <= settings_.jump_confirm_samples) return false;
    }
    const bool again = counts == channel.raw;
    channel.raw = counts;
    if (!again) channel.same = 0;
    if (again && channel.same < settings_.stuck_samples) ++channel.same;
    return channel.same < settings_.stuck_samples;
  }

  float AngleOf(std::size_t i, float counts) const noexcept {
    const float* corner = settings_.corner_counts[i];
    std::size_t piece = 0;
    while (piece + 2 < Corners && counts >= corner[piece + 1]) ++piece;
    return settings_.corner_rad[i][piece] +
           (counts - corner[piece]) * settings_.rad_per_count[i][piece];
  }

  /// The inverse of AngleOf().
  float CountsOf(std::size_t i, float angle_rad) const noexcept {
    const float* corner = settings_.corner_rad[i];
    const bool rises = corner[0] < corner[Corners - 1];
    std::size_t piece = 0;
    while (piece + 2 < Corners &&
           (rises ? angle_rad >= corner[piece + 1] : angle_rad <= corner[piece + 1])) {
      ++piece;
    }
    return settings_.corner_counts[i][piece] +
           (angle_rad - corner[piece]) / settings_.rad_per_count[i][piece];
  }
  /// Counts of a channel whose joint is at joint_rad_.
  float StartCounts(std::size_t i) const noexcept {
    if (settings_.joint_of_channel[i] < 0) return settings_.start_counts[i];
    const auto j = static_cast<std::size_t>(settings_.joint_of_channel[i]);
    const float angle_rad =
        (joint_rad_[j] - settings_.joint_offset_rad[j]) / settings_.joint_weight[j][i];
    return Clamp(CountsOf(i, angle_rad), settings_.min_counts[i], settings_.full_scale_counts[i]);
  }

  /// Input of the filter: counts, or an angle [rad].
  float Measured(std::size_t i) const noexcept {
    const float counts = channels_[i].trusted;
    return settings_.filter_angles ? AngleOf(i, counts) : counts;
  }
  void Start(std::size_t i) noexcept {
    Channel& channel = channels_[i];
    channel.starts = true;
    channel.angle_rad = AngleOf(i, channel.trusted);
    if constexpr (Steps > 0) prediction_.channels[i].fresh = true;
  }
  void Filter() noexcept {
    for (std::size_t i = 0; i < Channels; ++i) {
      Channel& channel = channels_[i];
      if (channel.starts) {
        channel.starts = false;
        channel.x = Measured(i);
        channel.w = 0.0F;
        channel.a = 0.0F;
      }
      channel.x += channel.w + 0.5F * channel.a;
      channel.w += channel.a;
      const float error = Measured(i) - channel.x;
      channel.x += settings_.gain[0][i] * error;
      channel.w += settings_.gain[1][i] * error;
      channel.a += settings_.gain[2][i] * error;
      channel.angle_rad = settings_.filter_angles ? channel.x : AngleOf(i, channel.x);
    }
    if constexpr (Steps > 0) Predict();
  }

  void Predict() noexcept {
    std::size_t& newest = prediction_.newest;
    newest = newest + 1 == Steps ? 0 : newest + 1;
    for (std::size_t i = 0; i < Channels; ++i) {
      auto& bank = prediction_.channels[i];
      float& angle_rad = channels_[i].angle_rad;
      if (bank.fresh) {
        bank = {};
        bank.start_rad = angle_rad;
        for (auto& x : bank.x) x[0] = angle_rad;
        for (float& miss : bank.miss) miss = 1.0F;
        continue;
      }
      if (bank.age < Steps) ++bank.age;
      angle_rad = Mixed(i, angle_rad);
    }
  }
  /// One step of all filters of a channel; what they expect, weighted by (mean square miss)^-3.
  float Mixed(std::size_t i, float measured_rad) noexcept {
    const auto& bank = settings_.prediction;
    auto& channel = prediction_.channels[i];
    const std::size_t newest = prediction_.newest;
    const std::size_t delay = bank.delay_steps[i];
    const std::size_t then = newest >= delay ? newest - delay : newest + Steps - delay;
    float sum = 0.0F;
    float shares = 0.0F;
    for (std::size_t m = 0; m < bank.kFilters; ++m) {
      const float was_expected =
          channel.age <= delay ? channel.start_rad : prediction_.expected_rad[then][m][i];
      const float off = measured_rad - was_expected;
      const float square = Clamp(off * off * bank.inverse_r[i], bank.least_miss, bank.most_miss);
      float& miss = channel.miss[m];
      miss += bank.forget * (square - miss);

      float* x = channel.x[m];
      float prior[3];
      for (std::size_t s = 0; s < 3; ++s) {
        const float* a = bank.transition[3 * m + s];
        prior[s] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
      }
      const float* h = bank.angle_of_state[m];
      const float error = measured_rad - (h[0] * prior[0] + h[1] * prior[1]);
      float ahead = 0.0F;
      for (std::size_t s = 0; s < 3; ++s) {
        x[s] = prior[s] + bank.gain[3 * m + s][i] * error;
        ahead += bank.look_ahead[3 * m + s][i] * x[s];
      }
      prediction_.expected_rad[newest][m][i] = ahead;
      const float share = 1.0F / (miss * miss * miss);
      sum += share * ahead;
      shares += share;
    }
    return sum / shares;
  }

  void MoveLostChannels() noexcept {
    for (std::size_t i = 0; i < Channels; ++i) {
      Channel& channel = channels_[i];
      if (!lost(i)) continue;
      if (!channel.moves_lost) channel.lost_rad = channel.angle_rad;
      channel.moves_lost = true;
      const float goal_rad =
          settings_.lost_rests ? settings_.rest_rad[i] : AngleOf(i, channel.trusted);
      const float step_rad = settings_.lost_step_rad;
      channel.lost_rad += Clamp(goal_rad - channel.lost_rad, -step_rad, step_rad);
      channel.angle_rad = channel.lost_rad;
    }
  }
  void MoveJoints() noexcept {
    for (std::size_t j = 0; j < Joints; ++j) {
      float angle = settings_.joint_offset_rad[j];
      for (std::size_t i = 0; i < Channels; ++i) {
        angle += settings_.joint_weight[j][i] * channels_[i].angle_rad;
      }
      joint_rad_[j] = Clamp(angle, settings_.joint_min_rad[j], settings_.joint_max_rad[j]) -
                      settings_.joint_reference_rad[j];
    }
  }
  void MoveMotors() noexcept {
    for (std::size_t m = 0; m < Motors; ++m) {
      float exact = static_cast<float>(settings_.motor_center_counts[m]);
      for (std::size_t j = 0; j < Joints; ++j) {
        exact += settings_.motor_counts_per_rad[m][j] * joint_rad_[j];
      }
      const float low = static_cast<float>(settings_.motor_min_counts[m]);
      const float high = static_cast<float>(settings_.motor_max_counts[m]);
      const float limit = settings_.motor_limit_counts[m];
      Motor& motor = motors_[m];
      motor.limited += Clamp(Clamp(exact, low, high) - motor.limited, -limit, limit);
      const float off = Distance(motor.limited, static_cast<float>(motor.command));
      if (off <= settings_.motor_stay_counts) continue;
      const float half = motor.limited < 0.0F ? -0.5F : 0.5F;
      motor.command = static_cast<std::int32_t>(Clamp(motor.limited + half, low, high));
    }
  }

  const Constants& settings_;
  Channel channels_[Channels];
  [[no_unique_address]] PredictionState<Channels, Steps> prediction_ = {};
  float joint_rad_[Joints];
  Motor motors_[Motors];
  std::uint32_t ticks_to_event_;
};

}  // namespace gauntlet::embedded
