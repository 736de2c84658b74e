#include "sim/trial/trial.h"

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// A command frame on its way to the servos.
struct Frame {
  int arrival_sample = 0;
  std::vector<std::int32_t> motor_counts;
};

/// The link between controller and servos: takes a frame every period, gives it out after the
/// delay. A ring of fixed size, so that the loop does not allocate.
class EventLink {
 public:
  EventLink(const EventConfig& config, double rate_hz, int motors)
      : period_samples_(static_cast<int>(std::lround(config.period_ms * 1e-3 * rate_hz))),
        delay_samples_(static_cast<int>(std::lround(config.delay_ms * 1e-3 * rate_hz))),
        ring_(static_cast<std::size_t>(delay_samples_ / period_samples_ + 2)) {
    for (Frame& frame : ring_) frame.motor_counts.resize(static_cast<std::size_t>(motors));
  }

  bool IsEvent(int sample) const { return sample % period_samples_ == 0; }

  void Send(int sample, std::span<const std::int32_t> motor_counts) {
    Frame& frame = ring_[sent_++ % ring_.size()];
    frame.arrival_sample = sample + delay_samples_;
    std::copy(motor_counts.begin(), motor_counts.end(), frame.motor_counts.begin());
  }

  /// The frame that arrives at this sample, or null.
  const Frame* Arriving(int sample) {
    if (received_ == sent_) return nullptr;
    const Frame& frame = ring_[received_ % ring_.size()];
    if (frame.arrival_sample != sample) return nullptr;
    ++received_;
    return &frame;
  }

 private:
  int period_samples_;
  int delay_samples_;
  std::vector<Frame> ring_;
  std::size_t sent_ = 0;
  std::size_t received_ = 0;
};

/// Rows of the trace are collected in blocks of consecutive samples and then moved to the
/// column-major signals: a write per channel and sample would touch one cache line each.
template <class Scalar>
class ColumnRecorder {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  ColumnRecorder(Matrix& target, Eigen::Index samples, Eigen::Index columns)
      : target_(target), block_(columns, kBlockSamples) {
    target_.resize(samples, columns);
  }

  /// Where the values of the sample go, one per column.
  std::span<Scalar> Row(Eigen::Index sample) {
    return {block_.col(sample % kBlockSamples).data(), static_cast<std::size_t>(block_.rows())};
  }

  void Flush(Eigen::Index samples_done) {
    const Eigen::Index count = samples_done - first_;
    target_.middleRows(first_, count) = block_.leftCols(count).transpose();
    first_ = samples_done;
  }

  static constexpr Eigen::Index kBlockSamples = 64;

 private:
  Matrix& target_;
  Matrix block_;
  Eigen::Index first_ = 0;
};

/// The recorders of all signals of one trace.
struct Recorders {
  Recorders(Trace& trace, Eigen::Index samples, Eigen::Index channels, Eigen::Index motors,
            Eigen::Index cables, bool object)
      : linearised(trace.linearised_angle_rad, samples, channels),
        filtered(trace.filtered_angle_rad, samples, channels),
        command(trace.command_counts, samples, motors),
        spool_angle(trace.spool_angle_rad, samples, motors),
        spool_speed(trace.spool_speed_rad_s, samples, motors),
        hand(trace.hand_angle_rad, samples, channels),
        tension(trace.tension_n, samples, cables),
        grip(trace.grip_force_n, samples, object ? 1 : 0),
        pose(trace.object_pose, samples, object ? 7 : 0) {}

  void Flush(Eigen::Index samples_done) {
    linearised.Flush(samples_done);
    filtered.Flush(samples_done);
    command.Flush(samples_done);
    spool_angle.Flush(samples_done);
    spool_speed.Flush(samples_done);
    hand.Flush(samples_done);
    tension.Flush(samples_done);
    grip.Flush(samples_done);
    pose.Flush(samples_done);
  }

  ColumnRecorder<double> linearised;
  ColumnRecorder<double> filtered;
  ColumnRecorder<int> command;
  ColumnRecorder<double> spool_angle;
  ColumnRecorder<double> spool_speed;
  ColumnRecorder<double> hand;
  ColumnRecorder<double> tension;
  ColumnRecorder<double> grip;
  ColumnRecorder<double> pose;
};

template <class Scalar>
void Copy(std::span<const Scalar> from, std::span<Scalar> to) {
  std::copy(from.begin(), from.end(), to.begin());
}

void Truncate(Trace& trace, Eigen::Index samples) {
  for (Signal* signal : {&trace.linearised_angle_rad, &trace.filtered_angle_rad,
                         &trace.spool_angle_rad, &trace.spool_speed_rad_s, &trace.hand_angle_rad,
                         &trace.tension_n, &trace.grip_force_n, &trace.object_pose}) {
    signal->conservativeResize(samples, Eigen::NoChange);
  }
  trace.command_counts.conservativeResize(samples, Eigen::NoChange);
}

}  // namespace

Trace RunTrial(const std::string& controller_name,
               const controller::ControllerConfig& controller_config, const GloveSignal& glove,
               const controller::GloveCalibration& calibration, const EventConfig& event,
               std::shared_ptr<const HandModel> hand_model,
               const std::function<bool()>& keep_going) {
  const Eigen::Index samples = glove.counts.rows();
  const Eigen::Index channels = glove.counts.cols();
  const controller::TendonTransmission& transmission = hand_model->transmission();
  const auto motors = static_cast<Eigen::Index>(transmission.motor_names.size());
  const auto cables = static_cast<Eigen::Index>(hand_model->cable_names().size());

  controller::Controller controller(controller_config, calibration, transmission);
  EventLink link(event, glove.rate_hz, static_cast<int>(motors));
  Hand hand(hand_model);
  const Eigen::VectorXd start = glove.true_angle_rad.row(0);
  hand.Reset({start.data(), static_cast<std::size_t>(channels)});

  Trace trace;
  trace.controller_name = controller_name;
  trace.saturation_share.assign(static_cast<std::size_t>(motors), 0.0);
  const bool object = hand_model->grasp().exists();
  Recorders record(trace, samples, channels, motors, cables, object);
  std::vector<double> counts(static_cast<std::size_t>(channels));
  std::vector<std::uint8_t> saturated(static_cast<std::size_t>(motors));

  Eigen::Index sample = 0;
  for (; sample < samples; ++sample) {
    for (Eigen::Index c = 0; c < channels; ++c) counts[c] = glove.counts(sample, c);
    const controller::Command command = controller.Step({.counts = counts});
    const int now = static_cast<int>(sample);
    if (link.IsEvent(now)) link.Send(now, command.motor_counts);
    if (const Frame* frame = link.Arriving(now)) hand.SetCommand(frame->motor_counts);
    hand.Step();
    if (!hand.health().ok) break;  // the engine has put the joints back to 0

    Copy(controller.linearised_angle_rad(), record.linearised.Row(sample));
    Copy(controller.filtered_angle_rad(), record.filtered.Row(sample));
    Copy(hand.command(), record.command.Row(sample));
    hand.ReadSpoolAngles(record.spool_angle.Row(sample));
    hand.ReadSpoolSpeeds(record.spool_speed.Row(sample));
    hand.ReadJointAngles(record.hand.Row(sample));
    hand.ReadCableTensions(record.tension.Row(sample));
    if (object) {
      record.grip.Row(sample)[0] = hand.ReadGrip().force_n;
      hand.ReadObjectPose(record.pose.Row(sample));
    }
    hand.ReadSaturation(saturated);
    for (std::size_t m = 0; m < saturated.size(); ++m) trace.saturation_share[m] += saturated[m];

    const Eigen::Index done = sample + 1;
    if (done % ColumnRecorder<double>::kBlockSamples == 0) {
      record.Flush(done);
      if (keep_going && !keep_going()) throw Cancelled{};
    }
  }
  record.Flush(sample);
  if (sample < samples) Truncate(trace, sample);

  for (double& share : trace.saturation_share)
    share /= static_cast<double>(std::max<Eigen::Index>(sample, 1));
  const auto untrusted = controller.untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  trace.health = hand.health();
  return trace;
}

}  // namespace gauntlet::sim
