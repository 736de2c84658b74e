#include "sim/score/latency.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "controller/periodic_clock.h"
#include "sim/score/delay.h"
#include "sim/score/low_pass.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr double kCutoff_hz = 6.0;  // hands move below 4 Hz; half a second of reach
constexpr double kTransition_hz = 4.0;
constexpr double kStationRate_hz = 125.0;  // ample for 8 Hz
constexpr double kStageMargin_s = 0.05;
constexpr int kPredictionStage = 3;
constexpr Eigen::Index kMeansAtATime = 512;

struct StageName {
  std::string_view key;
  std::string_view help;
};
constexpr StageName kStages[] = {
    {"sensor_ms", "sensor and converter, until the next sample"},
    {"filter_ms", "filter"},
    {"event_wait_ms", "waiting for the command frame"},
    {"prediction_ms", "looking ahead"},
    {"event_delay_ms", "from the command frame to the servo"},
    {"servo_frame_ms", "waiting for the servo's frame"},
    {"servo_and_cables_ms", "servo and cables"},
};
constexpr int kStageCount = static_cast<int>(std::size(kStages));

using Column = Eigen::VectorXd;

/// Holds from each tick of a clock to the next what was there; the clock begins at tick `first`.
class Holder {
 public:
  Holder(double period_ticks, Eigen::Index first) : clock_(period_ticks), left_(first) {}

  /// The next values, in place.
  void Hold(Eigen::Ref<Column> signal) {
    for (Eigen::Index n = std::min(left_, signal.size()); n < signal.size(); ++n) {
      if (clock_.Tick()) held_ = signal[n];
      signal[n] = held_;
    }
    left_ -= std::min(left_, signal.size());
  }

 private:
  controller::PeriodicClock clock_;
  Eigen::Index left_;  // ticks until the clock begins
  double held_ = 0.0;
};

void CheckShapes(const LatencyInput& input) {
  for (const Signal* signal :
       {input.wearer_angle_rad, input.raw_angle_rad, input.filtered_angle_rad,
        input.target_angle_rad, input.command_angle_rad, input.hand_angle_rad}) {
    if (signal == nullptr || input.hand_angle_rad == nullptr ||
        signal->cols() != input.hand_angle_rad->cols() ||
        signal->rows() < input.hand_angle_rad->rows()) {
      throw std::invalid_argument("MeasureLatency: a signal is missing or has another shape");
    }
  }
  if (input.counted == nullptr) return;
  const auto is_within = [&input](const CountedTicks& counted) {
    return AreWithin(counted, input.hand_angle_rad->rows());
  };
  if (std::ssize(*input.counted) != input.hand_angle_rad->cols() ||
      !std::ranges::all_of(*input.counted, is_within)) {
    throw std::invalid_argument("MeasureLatency: what counts is of other signals");
  }
}

/// Place of a signal on the way from the wearer to the hand, and the clock that holds it there.
struct Station {
  const Signal* signal;
  double held_for_ticks = 1.0;
  Eigen::Index first_tick = 0;
};

/// The mean of each column. A joint without a number stands still here, and so has no latency; the
/// filter would spread it.
Column MeanOfEach(const Eigen::Map<const Eigen::MatrixXd>& blocks) {
  Column means = blocks.colwise().mean();
  if (means.hasNaN()) means = blocks.array().isNaN().select(0.0, blocks).colwise().mean();
  return means;
}

/// A station behind the low pass, at a lower rate: means of `step` ticks each, so that nothing
/// folds into the motion, which all stations delay alike.
Signal Behind(const LowPass& low_pass, const Station& station, Eigen::Index rows, int step,
              Fourier& fourier) {
  const Eigen::Index blocks = rows / step;
  Signal means(blocks, station.signal->cols());
  Column held;  // a piece that stays in the cache
  for (Eigen::Index channel = 0; channel < means.cols(); ++channel) {
    Holder holder(station.held_for_ticks, station.first_tick);
    for (Eigen::Index first = 0; first < blocks; first += kMeansAtATime) {
      const Eigen::Index count = std::min(kMeansAtATime, blocks - first);
      const auto signal = station.signal->col(channel).segment(first * step, count * step);
      const double* values = signal.data();
      if (station.held_for_ticks > 1.0) {
        held = signal;
        holder.Hold(held);
        values = held.data();
      }
      means.col(channel).segment(first, count) = MeanOfEach({values, step, count});
    }
    TrimSignals();
  }
  return Filter(low_pass, Band::kBelow, means, fourier).values;
}

std::vector<Signal> Stations(const LatencyInput& input, int step, Fourier& fourier) {
  const LowPass low_pass = DesignLowPass(kCutoff_hz, kTransition_hz, input.rate_hz / step);
  const Station stations[] = {
      {.signal = input.wearer_angle_rad},
      {.signal = input.raw_angle_rad},
      {.signal = input.filtered_angle_rad},
      {.signal = input.filtered_angle_rad, .held_for_ticks = input.ticks_per_event},
      {.signal = input.target_angle_rad, .held_for_ticks = input.ticks_per_event},
      {.signal = input.command_angle_rad},
      {.signal = input.command_angle_rad,
       .held_for_ticks = std::max(1.0, input.ticks_per_servo_frame),
       .first_tick = input.first_servo_frame},
      {.signal = input.hand_angle_rad},
  };
  std::vector<Signal> behind;
  for (const Station& station : stations) {
    behind.push_back(Behind(low_pass, station, input.hand_angle_rad->rows(), step, fourier));
  }
  return behind;
}

/// The rows of a joint's stations in which only ticks that count have a share.
CountedTicks CountedRows(const CountedTicks& counted, int step, int reach) {
  CountedTicks rows;
  for (const TickRange& range : counted) {
    const TickRange blocks{(range.begin + step - 1) / step, range.end / step};
    if (blocks.end - 2 * reach > blocks.begin) {
      rows.push_back({blocks.begin, blocks.end - 2 * reach});
    }
  }
  return rows;
}

std::span<const double> ColumnOf(const Signal& signal, Eigen::Index channel) {
  return {signal.col(channel).data(), static_cast<std::size_t>(signal.rows())};
}

LatencyBudget EmptyBudget() {
  LatencyBudget budget;
  for (const StageName& name : kStages) {
    budget.stages.push_back({.key = name.key, .help = name.help, .mean_ms = 0.0, .channel_ms = {}});
  }
  return budget;
}

}  // namespace

LatencyBudget MeasureLatency(const LatencyInput& input) {
  CheckShapes(input);
  Fourier fourier;
  const int step = std::max(1, static_cast<int>(input.rate_hz / kStationRate_hz));
  const double rate_hz = input.rate_hz / step;
  const std::vector<Signal> stations = Stations(input, step, fourier);
  const int reach = LowPassReach(kTransition_hz, rate_hz);
  const CountedTicks all{{0, static_cast<int>(input.hand_angle_rad->rows())}};
  const auto delay_ms = [&](int from, int to, Eigen::Index channel) {
    const CountedTicks& counted =
        input.counted == nullptr ? all : (*input.counted)[static_cast<std::size_t>(channel)];
    const bool is_stage = to == from + 1;
    const double look_ahead_s = from == kPredictionStage ? input.look_ahead_s : 0.0;
    const double earliest_s = is_stage ? -kStageMargin_s - look_ahead_s : input.earliest_delay_s;
    const auto delay =
        DelaySamples(ColumnOf(stations[from], channel), ColumnOf(stations[to], channel), rate_hz,
                     earliest_s, CountedRows(counted, step, reach), fourier);
    return delay ? 1000.0 * *delay / rate_hz : kNoScore;
  };

  LatencyBudget budget = EmptyBudget();
  int count = 0;
  for (Eigen::Index channel = 0; channel < input.hand_angle_rad->cols(); ++channel) {
    TrimSignals();
    const double total_ms = delay_ms(0, kStageCount, channel);
    bool whole = std::isfinite(total_ms);
    for (int i = 0; i < kStageCount; ++i) {
      budget.stages[i].channel_ms.push_back(delay_ms(i, i + 1, channel));
      whole = whole && std::isfinite(budget.stages[i].channel_ms.back());
    }
    if (!whole) continue;
    ++count;
    budget.total_ms += total_ms;
    for (LatencyStage& stage : budget.stages) stage.mean_ms += stage.channel_ms.back();
  }
  // No channel that moves: 0/0 makes every mean NaN.
  budget.total_ms /= count;
  for (LatencyStage& stage : budget.stages) {
    stage.mean_ms /= count;
    budget.sum_ms += stage.mean_ms;
  }
  return budget;
}

}  // namespace gauntlet::sim
