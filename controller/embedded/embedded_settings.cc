#include "controller/embedded/embedded_settings.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "controller/angle.h"
#include "controller/angle_estimator.h"
#include "controller/controller.h"
#include "controller/embedded/embedded_controller.h"
#include "controller/filters/per_channel_settings.h"
#include "controller/filters/steady_gains.h"
#include "controller/joint_map.h"
#include "controller/linearisation/linearisation.h"
#include "controller/prediction/adaptive_bank.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {
namespace {

[[noreturn]] void Refuse(const std::string& key, const std::string& problem) {
  throw SettingError("controller." + key, problem + " in the embedded form");
}

/// Gains on position, velocity and acceleration, 3 x channels.
Eigen::ArrayXXd GainsOf(const ControllerConfig& config, int channels, double rate_hz) {
  Eigen::ArrayXXd gains = Eigen::ArrayXXd::Zero(3, channels);
  gains.row(0) = 1.0;  // passes its input on
  if (config.filters.empty()) return gains;
  if (config.filters.size() > 1) Refuse("filter", "has several filters, must be one at most");
  if (!config.filters[0].channels.empty()) Refuse("filter[0].channels", "is given, must be absent");
  const auto& settings = config.filters[0].settings;
  const auto* kalman = std::get_if<KalmanSteadyConfig>(&settings);
  if (kalman != nullptr && kalman->start != Start::kFirst) {
    Refuse("filter[0].start", "is zero, must be first");
  }
  if (std::holds_alternative<KalmanConfig>(settings)) {
    Refuse("filter[0]", "is kalman, must be kalman_steady, to which it settles (--settle),");
  }
  if (!ConstantGains(settings, channels, rate_hz)) {
    Refuse("filter[0]", "is " + std::string(KindName(settings)) +
                            ", must be none, exponential, alpha_beta, alpha_beta_gamma or "
                            "kalman_steady");
  }
  for (int c = 0; c < channels; ++c) {  // each with its values of the lists
    const FilterSettings own = SettingsOfChannel(config.filters[0], c, channels);
    gains.col(c) = ConstantGains(own, channels, rate_hz)->row(c).transpose();
  }
  return gains;
}

/// Makes a 1 euro filter what it is at rest: an exponential one, with a list where the cutoff has
/// one.
void SettleAtRest(const OneEuroConfig& one_euro, double rate_hz, FilterConfig& filter) {
  const auto alpha_of = [rate_hz](double cutoff_hz) {
    return 1.0 / (1.0 + rate_hz / (2.0 * std::numbers::pi * cutoff_hz));
  };
  const double alpha = alpha_of(one_euro.min_cutoff_hz);
  std::erase_if(filter.per_channel,
                [](const ChannelValues& list) { return list.key != "min_cutoff_hz"; });
  for (ChannelValues& list : filter.per_channel) {
    list.key = "alpha";
    std::ranges::transform(list.values, list.values.begin(), alpha_of);
  }
  filter.settings = ExponentialConfig{.alpha = alpha};
}

/// Corners of each channel's broken line, counts growing; as many for each.
std::vector<std::vector<double>> CornersOf(const RobotConfig& robot) {
  const LinearisationConfig& config = robot.controller.linearisation;
  const auto& names = robot.glove.channel_names;
  std::vector<std::vector<double>> corners(names.size());
  if (config.kind == LinearisationKind::kPolynomial) {
    Refuse("linearisation.kind", "is polynomial, must be glove or table");
  }
  std::size_t most = 2;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (config.kind == LinearisationKind::kGlove) {
      corners[i] = {robot.glove.low_counts[i], robot.glove.high_counts[i]};
      std::ranges::sort(corners[i]);
    } else {
      const auto named = std::ranges::find(config.channels, names[i], &ChannelCurve::channel);
      corners[i] = named != config.channels.end() ? named->counts : config.channels[i].counts;
    }
    most = std::max(most, corners[i].size());
  }
  for (auto& list : corners) {  // the last piece goes on
    while (list.size() < most) list.push_back(list.back() + 1.0);
  }
  return corners;
}

class Builder {
 public:
  explicit Builder(const RobotConfig& robot)
      : robot_(robot),
        config_(robot.controller),
        channels_(robot.glove.channel_names.size()),
        checked_(robot),
        converters_(ConvertersOf(robot.glove)) {}

  EmbeddedSettings Build() {
    AddGuard();
    AddLinearisation();
    AddFilter();
    AddJoints();
    AddMotors();
    AddPrediction();
    return std::move(settings_);
  }

 private:
  static constexpr double kNever = std::numeric_limits<std::uint32_t>::max();
  static constexpr double kNoLimit = 1e30;
  static constexpr int kMost = 1 << 24;  // whole numbers beyond have no value of their own in float

  void Add(std::string_view name, double value, EmbeddedValue::Type type) {
    settings_.values.push_back({.group = group_, .name = name, .type = type, .values = {value}});
  }
  void AddList(std::string_view name, std::vector<double> values,
               EmbeddedValue::Type type = EmbeddedValue::kFloat, std::size_t columns = 0) {
    settings_.values.push_back({.group = group_,
                                .name = name,
                                .type = type,
                                .values = std::move(values),
                                .columns = columns,
                                .is_list = true});
  }
  void AddMatrix(std::string_view name, const Eigen::ArrayXXd& matrix) {
    const Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
    AddList(name, {rows.data(), rows.data() + rows.size()}, EmbeddedValue::kFloat,
            static_cast<std::size_t>(rows.cols()));
  }
  void AddCounts(std::string_view name, const std::vector<int>& counts) {
    AddList(name, {counts.begin(), counts.end()}, EmbeddedValue::kInteger);
  }
  double SamplesOf(double duration_ms) const {  // as SampleGuard
    return std::ceil(duration_ms * 1e-3 * robot_.timing.sample_rate_hz() - 1e-6);
  }

  void AddGuard() {
    const SampleGuardConfig& guard = config_.untrusted;
    std::vector<double> least, most, jump;
    for (std::size_t i = 0; i < channels_; ++i) {
      const ConverterRange& range = converters_[i];
      CheckConverter(i);
      least.push_back(range.min_counts);
      most.push_back(range.full_scale_counts);
      jump.push_back(guard.jump_share > 0.0 ? guard.jump_share * range.span_counts() : kNoLimit);
    }
    AddList("min_counts", least);
    AddList("full_scale_counts", most);
    Add("trust_full_scale", guard.full_scale ? 0.0 : 1.0, EmbeddedValue::kFlag);
    AddList("jump_counts", jump);
    Add("jump_confirm_samples", SamplesOf(guard.jump_confirm_ms), EmbeddedValue::kInteger);
    Add("stuck_samples", guard.stuck_after_ms > 0.0 ? SamplesOf(guard.stuck_after_ms) : kNever,
        EmbeddedValue::kInteger);
    AddLostGlove();
  }
  /// As GloveWatch and Controller.
  void AddLostGlove() {
    const SampleGuardConfig& guard = config_.untrusted;
    const double ticks =
        std::clamp(std::ceil(robot_.timing.TicksOf(guard.lost_after_ms)), 1.0, kNever - 1.0);
    Add("lost_ticks", guard.lost_after_ms > 0.0 ? ticks : 0.0, EmbeddedValue::kInteger);
    Add("lost_rests", guard.when_lost == WhenLost::kRest ? 1.0 : 0.0, EmbeddedValue::kFlag);
    Add("lost_step_rad", guard.lost_speed_deg_s * kRadPerDeg / robot_.timing.event_rate_hz(),
        EmbeddedValue::kFloat);
    const AngleEstimator estimator(robot_, config_);
    std::vector<double> rest_rad(estimator.middle_rad().begin(), estimator.middle_rad().end());
    JointMap(robot_.joint_map, robot_.glove.channel_names, robot_.hand)
        .ToChannels(robot_.hand.reference_angle_rad, rest_rad);
    AddList("rest_rad", rest_rad);
  }
  void AddLinearisation() {
    const auto line =
        MakeLinearisation(config_.linearisation, robot_.glove, robot_.glove.channel_names);
    const std::span<const double> start_rad = checked_.linearised_angle_rad();
    std::vector<double> start_counts(channels_);
    line->ToCounts(start_rad, start_counts);
    for (std::size_t i = 0; i < channels_; ++i) {
      start_counts[i] =
          std::clamp(start_counts[i], converters_[i].min_counts, converters_[i].full_scale_counts);
    }
    AddList("start_counts", start_counts);

    const auto corners = CornersOf(robot_);
    const std::size_t count = settings_.corner_count = corners[0].size();
    std::vector<double> counts, angles_rad, slopes, at(channels_), angle_rad(channels_);
    angles_rad.resize(channels_ * count);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < channels_; ++i) at[i] = corners[i][k];
      line->ToAngles(at, angle_rad);
      for (std::size_t i = 0; i < channels_; ++i) angles_rad[i * count + k] = angle_rad[i];
    }
    for (std::size_t i = 0; i < channels_; ++i) {
      counts.insert(counts.end(), corners[i].begin(), corners[i].end());
      for (std::size_t k = 0; k + 1 < count; ++k) {
        const double* angle = &angles_rad[i * count + k];
        slopes.push_back((angle[1] - angle[0]) / (corners[i][k + 1] - corners[i][k]));
      }
    }
    AddList("corner_counts", counts, EmbeddedValue::kFloat, count);
    AddList("corner_rad", angles_rad, EmbeddedValue::kFloat, count);
    AddList("rad_per_count", slopes, EmbeddedValue::kFloat, count - 1);
  }
  void AddFilter() {
    const bool at_event = config_.filter_at == FilterAt::kEvent;
    Add("filter_angles", config_.filter_on == FilterOn::kAngle ? 1.0 : 0.0, EmbeddedValue::kFlag);
    Add("filter_at_event", at_event ? 1.0 : 0.0, EmbeddedValue::kFlag);
    AddMatrix("gain", GainsOf(config_, static_cast<int>(channels_), StepRate()));
  }
  double StepRate() const {
    const bool at_event = config_.filter_at == FilterAt::kEvent;
    return at_event ? robot_.timing.event_rate_hz() : robot_.timing.sample_rate_hz();
  }
  void AddPrediction() {
    const auto& prediction = config_.prediction.settings;
    if (std::holds_alternative<NoPredictionConfig>(prediction)) return;
    const auto* adaptive = std::get_if<AdaptivePredictionConfig>(&prediction);
    if (adaptive == nullptr) {
      Refuse("prediction",
             "is " + std::string(KindName(prediction)) + ", must be none or adaptive");
    }
    const auto channels = static_cast<int>(channels_);
    const AdaptiveBank bank = BankOf(*adaptive, channels, StepRate(), channels);
    settings_.step_count = static_cast<std::size_t>(bank.kept_steps());
    const auto members = static_cast<Eigen::Index>(bank.members.size());
    Eigen::ArrayXXd transition(3 * members, 3), angle_of_state(members, 2);
    Eigen::ArrayXXd gain(3 * members, channels), look_ahead(3 * members, channels);
    for (Eigen::Index m = 0; m < members; ++m) {
      const AdaptiveBank::Member& member = bank.members[static_cast<std::size_t>(m)];
      transition.middleRows(3 * m, 3) = member.transition.array();
      angle_of_state.row(m) = member.angle_of_state.head<2>().array();
      gain.middleRows(3 * m, 3) = member.gain;
      look_ahead.middleRows(3 * m, 3) = member.look_ahead;
    }
    static_assert(embedded::Prediction<1, 1>::kFilters == std::size(kPredictionBank));
    group_ = "prediction";
    AddMatrix("transition", transition);
    AddMatrix("angle_of_state", angle_of_state);
    AddMatrix("gain", gain);
    AddMatrix("look_ahead", look_ahead);
    AddList("inverse_r", bank.inverse_r);
    AddCounts("delay_steps", bank.delay_steps);
    Add("forget", bank.forget, EmbeddedValue::kFloat);
    Add("least_miss", AdaptiveBank::kLeastMiss, EmbeddedValue::kFloat);
    Add("most_miss", AdaptiveBank::kMostMiss, EmbeddedValue::kFloat);
  }
  void AddJoints() {
    if (config_.model_predictive.kind != ModelPredictiveKind::kNone) {
      Refuse("model_predictive.kind", "is second_order, must be none");
    }
    if (config_.joint_loop.kind != JointLoopKind::kNone) {
      Refuse("joint_loop.kind", "is pi, must be none");
    }
    const JointMap map(robot_.joint_map, robot_.glove.channel_names, robot_.hand);
    const auto joints = static_cast<std::size_t>(map.joint_count());
    std::vector<double> offset, weight(joints * channels_);
    for (std::size_t j = 0; j < joints; ++j) {
      offset.push_back(map.offset_rad(static_cast<int>(j)));
      for (const JointMap::Term& term : map.terms(static_cast<int>(j))) {
        weight[j * channels_ + static_cast<std::size_t>(term.channel)] += term.weight;
      }
    }
    joint_of_channel_.assign(channels_, -1.0);
    for (std::size_t j = joints; j-- > 0;) {  // as JointMap::ToChannels()
      const auto terms = map.terms(static_cast<int>(j));
      if (terms.size() != 1 || terms[0].weight == 0.0) continue;
      joint_of_channel_[static_cast<std::size_t>(terms[0].channel)] = static_cast<double>(j);
    }
    AddList("joint_offset_rad", offset);
    AddList("joint_weight", weight, EmbeddedValue::kFloat, channels_);
    AddList("joint_min_rad", robot_.hand.joint_min_rad);
    AddList("joint_max_rad", robot_.hand.joint_max_rad);
    AddList("joint_reference_rad", robot_.hand.reference_angle_rad);
  }
  void CheckConverter(std::size_t channel) const {
    const ConverterRange& range = converters_[channel];
    const bool fits = range.min_counts >= -kMost;
    if (fits && range.full_scale_counts <= kMost) return;
    throw SettingError(fits ? "calibration.full_scale_counts" : "calibration.min_counts",
                       "channel " + robot_.glove.channel_names[channel] + ": is " +
                           NumberText(fits ? range.full_scale_counts : range.min_counts) +
                           ", must be from -" + std::to_string(kMost) + " to " +
                           std::to_string(kMost) + " in the embedded form");
  }
  void CheckMotorRange() const {
    const TendonTransmission& hand = robot_.hand;
    for (std::size_t m = 0; m < hand.motor_names.size(); ++m) {
      const int beyond = hand.max_counts[m] > kMost ? hand.max_counts[m] : hand.min_counts[m];
      if (hand.max_counts[m] <= kMost && hand.min_counts[m] >= -kMost) continue;
      throw SettingError(beyond > 0 ? "transmission.max_counts" : "transmission.min_counts",
                         "motor " + hand.motor_names[m] + ": is " + std::to_string(beyond) +
                             ", must be from -" + std::to_string(kMost) + " to " +
                             std::to_string(kMost) + " in the embedded form");
    }
  }
  void AddMotors() {
    const TendonTransmission& hand = robot_.hand;
    const std::size_t joints = hand.joint_names.size();
    const TendonMap map(hand, config_.coupling_compensation);
    std::vector<double> counts_per_rad, limit;
    const double per_event = config_.motor.speed_limit_rad_s > 0.0
                                 ? config_.motor.speed_limit_rad_s / robot_.timing.event_rate_hz()
                                 : kNoLimit;
    for (std::size_t m = 0; m < hand.motor_names.size(); ++m) {
      const auto row = map.spool_per_joint().row(static_cast<Eigen::Index>(m));
      for (const double turn : row) counts_per_rad.push_back(hand.counts_per_rad[m] * turn);
      limit.push_back(std::min(std::abs(hand.counts_per_rad[m]) * per_event, kNoLimit));
    }
    CheckMotorRange();
    AddList("motor_counts_per_rad", counts_per_rad, EmbeddedValue::kFloat, joints);
    AddCounts("motor_center_counts", hand.center_counts);
    AddCounts("motor_min_counts", hand.min_counts);
    AddCounts("motor_max_counts", hand.max_counts);
    AddList("motor_limit_counts", limit);
    AddMatrix("joint_rad_per_count", map.AnglePerCount().array().unaryExpr(
                                         [](double v) { return std::isfinite(v) ? v : 0.0; }));
    AddList("joint_of_channel", joint_of_channel_, EmbeddedValue::kInteger);
    if (config_.motor.rounding == Rounding::kNoiseShaping) {
      Refuse("motor.rounding", "is noise_shaping, must be nearest or hysteresis");
    }
    const bool stays = config_.motor.rounding == Rounding::kHysteresis;
    Add("motor_stay_counts", stays ? 0.5 + config_.motor.hysteresis_counts : 0.0,
        EmbeddedValue::kFloat);
    const double ticks = robot_.timing.TicksOf(robot_.timing.event_period_ms);
    if (ticks != std::round(ticks) || ticks < 1.0) {
      throw SettingError("timing.event_period_ms", "is " + NumberText(ticks) +
                                                       " ticks, must be a whole number in the "
                                                       "embedded form (export: --tick-rate-hz)");
    }
    Add("ticks_per_event", ticks, EmbeddedValue::kInteger);
  }

  const RobotConfig& robot_;
  const ControllerConfig& config_;
  std::size_t channels_;
  Controller checked_;  // throws for what no controller can be made of
  std::vector<ConverterRange> converters_;
  EmbeddedSettings settings_;
  std::string_view group_;                // of the members that are added
  std::vector<double> joint_of_channel_;  // -1: none
};

}  // namespace

ControllerConfig Settled(const RobotConfig& robot, std::vector<std::string>& replaced) {
  ControllerConfig config = robot.controller;
  const double rate_hz = config.filter_at == FilterAt::kEvent ? robot.timing.event_rate_hz()
                                                              : robot.timing.sample_rate_hz();
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    FilterSettings& settings = config.filters[i].settings;
    const std::string before(KindName(settings));
    std::string how;
    if (const auto* kalman = std::get_if<KalmanConfig>(&settings);
        kalman != nullptr && kalman->acceleration_window == 0) {
      settings = KalmanSteadyConfig{.noise = KalmanNoise(kalman->noise), .states = kalman->states};
    } else if (const auto* adaptive = std::get_if<KalmanAdaptiveConfig>(&settings)) {
      settings = KalmanSteadyConfig{.noise = KalmanNoise(adaptive->noise)};
      how = ", which no longer learns r and q";
    } else if (const auto* one_euro = std::get_if<OneEuroConfig>(&settings)) {
      SettleAtRest(*one_euro, rate_hz, config.filters[i]);
      how = " of min_cutoff_hz, which no longer opens with the speed";
    } else if (auto* steady = std::get_if<KalmanSteadyConfig>(&settings);
               steady != nullptr && steady->start == Start::kZero) {
      steady->start = Start::kFirst;
      how = " that starts at the first sample";
    } else {
      continue;
    }
    replaced.push_back("filter[" + std::to_string(i) + "] " + before + " by " +
                       std::string(KindName(settings)) + how);
  }
  return config;
}

EmbeddedSettings EmbeddedSettingsOf(const RobotConfig& robot) { return Builder(robot).Build(); }

}  // namespace gauntlet::controller
