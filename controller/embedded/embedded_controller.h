#pragma once

#include <cstddef>
#include <cstdint>

/// The controller for a microcontroller: one header in `float`, no library, no memory but its own,
/// neither exceptions nor run-time types. `gauntlet export --embedded` writes its settings as
/// constants.
namespace gauntlet::embedded {

/// What `gauntlet export --embedded` writes. Belongs into read-only memory.
///
/// Shapes: as the arrays say. Units: counts of the converter, rad, motor counts, samples or ticks.
template <std::size_t Channels, std::size_t Joints, std::size_t Motors, std::size_t Corners>
struct Settings {
  // Which samples are trusted, as SampleGuard does.
  float min_counts[Channels];  // of the converter
  float full_scale_counts[Channels];
  bool trust_full_scale;
  float jump_counts[Channels];
  std::uint32_t jump_confirm_samples;
  std::uint32_t stuck_samples;
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
};

/// From glove to motors, one call per tick of the control loop: controller::Controller for what
/// Settings holds. It is all the memory that there is: make it static, next to its settings.
///
///     filter   x^- = x + w + a/2,  w^- = w + a,  e = z - x^-
///              x = x^- + k1 e,  w = w^- + k2 e,  a = a + k3 e
///
/// Its commands are at most one count (with a wider hysteresis, that much) beside those of
/// controller::Controller, which has the same equations in `double` and says where they come from
/// (tests/settings/embedded_test.cc). It starts and loses samples as that one does: until the first
/// good sample of its channel a joint stays where Reset() says that the motors are. One difference:
/// frames have no numbers.
template <std::size_t Channels, std::size_t Joints, std::size_t Motors, std::size_t Corners>
class Controller {
 public:
  using Constants = Settings<Channels, Joints, Motors, Corners>;

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
    if (counts != nullptr) {
      for (std::size_t i = 0; i < Channels; ++i) Take(i, counts[i]);
      if (!settings_.filter_at_event) Filter();
    }
    if (ticks_to_event_-- > 0) return false;
    ticks_to_event_ = settings_.ticks_per_event - 1;
    if (settings_.filter_at_event) Filter();
    MoveJoints();
    MoveMotors();
    for (std::size_t i = 0; i < Motors; ++i) motor_counts[i] = motors_[i].command;
    return true;
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
    std::uint32_t same, confirmed, untrusted;
    bool seen;
  };
  struct Motor {
    float limited;
    std::int32_t command;
  };

  static float Distance(float from, float to) noexcept { return from < to ? to - from : from - to; }
  static float Clamp(float value, float low, float high) noexcept {
    return value < low ? low : value > high ? high : value;
  }

  /// A sample that can be trusted; `start` if it is the first one.
  void Take(std::size_t i, float counts) noexcept {
    Channel& channel = channels_[i];
    if (!IsTrusted(i, counts)) {
      ++channel.untrusted;
      return;
    }
    channel.trusted = counts;
    if (channel.seen) return;
    channel.seen = true;
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
  /// Of a channel whose joint is at joint_rad_.
  float StartCounts(std::size_t i) const noexcept {
    if (settings_.joint_of_channel[i] < 0) return settings_.start_counts[i];
    const auto j = static_cast<std::size_t>(settings_.joint_of_channel[i]);
    const float angle_rad =
        (joint_rad_[j] - settings_.joint_offset_rad[j]) / settings_.joint_weight[j][i];
    return Clamp(CountsOf(i, angle_rad), settings_.min_counts[i], settings_.full_scale_counts[i]);
  }

  /// What the filter sees.
  float Measured(std::size_t i) const noexcept {
    const float counts = channels_[i].trusted;
    return settings_.filter_angles ? AngleOf(i, counts) : counts;
  }
  void Start(std::size_t i) noexcept {
    Channel& channel = channels_[i];
    channel.x = Measured(i);
    channel.w = 0.0F;
    channel.a = 0.0F;
    channel.angle_rad = AngleOf(i, channel.trusted);
  }
  void Filter() noexcept {
    for (std::size_t i = 0; i < Channels; ++i) {
      Channel& channel = channels_[i];
      channel.x += channel.w + 0.5F * channel.a;
      channel.w += channel.a;
      const float error = Measured(i) - channel.x;
      channel.x += settings_.gain[0][i] * error;
      channel.w += settings_.gain[1][i] * error;
      channel.a += settings_.gain[2][i] * error;
      channel.angle_rad = settings_.filter_angles ? channel.x : AngleOf(i, channel.x);
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
  float joint_rad_[Joints];
  Motor motors_[Motors];
  std::uint32_t ticks_to_event_;
};

}  // namespace gauntlet::embedded
