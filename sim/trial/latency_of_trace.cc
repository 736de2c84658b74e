#include "sim/trial/latency_of_trace.h"

#include <Eigen/LU>
#include <cmath>

namespace gauntlet::sim {
namespace {

/// The low pass of the measurement reaches half a second to both sides; the rest must move.
constexpr double kShortest_s = 2.0;

/// Inverse of the tendon map: joint angles per motor count, channels x motors.
Eigen::MatrixXd AnglePerCount(const controller::TendonTransmission& hand) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto motors = static_cast<Eigen::Index>(hand.counts_per_rad.size());
  const auto channels = static_cast<Eigen::Index>(hand.channel_names.size());
  const Eigen::Map<const RowMajor> coupling(hand.coupling.data(), motors, channels);
  const Eigen::Map<const Eigen::VectorXd> counts_per_rad(hand.counts_per_rad.data(), motors);
  return (counts_per_rad.asDiagonal() * coupling).inverse();
}

}  // namespace

std::optional<LatencyBudget> LatencyOfTrace(const HandModel& hand, const EventConfig& event,
                                            const GloveSignal& glove, const Trace& trace) {
  const double rate_hz = glove.rate_hz;
  if (static_cast<double>(trace.hand_angle_rad.rows()) < kShortest_s * rate_hz) return std::nullopt;
  const auto samples = [rate_hz](double duration_ms) {
    return static_cast<int>(std::lround(duration_ms * 1e-3 * rate_hz));
  };
  LatencyInput input;
  input.rate_hz = rate_hz;
  input.wearer_angle_rad = &glove.true_angle_rad;
  input.linearised_angle_rad = &trace.linearised_angle_rad;
  input.filtered_angle_rad = &trace.filtered_angle_rad;
  input.command_counts = &trace.command_counts;
  input.hand_angle_rad = &trace.hand_angle_rad;
  input.angle_per_count_rad = AnglePerCount(hand.transmission());
  input.samples_per_event = samples(event.period_ms);
  input.samples_per_servo_frame = samples(hand.config().servo.frame_ms);
  // The servo's clock starts with the first command that arrives.
  input.first_servo_frame = samples(event.delay_ms);
  LatencyBudget budget = MeasureLatency(input);
  if (!std::isfinite(budget.total_ms)) return std::nullopt;
  return budget;
}

}  // namespace gauntlet::sim
