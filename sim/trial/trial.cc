#include "sim/trial/trial.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "controller/assert.h"
#include "controller/linearisation/linearisation.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/trial/external/external_filters.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

/// Lets the loop take one tick of the glove's signal.
void StepLoop(const GloveSignal& glove, Eigen::Index tick, std::vector<double>& counts,
              HandLoop& loop) {
  if (tick % glove.ticks_per_sample != 0) return loop.Step();
  const Eigen::Index sample = tick / glove.ticks_per_sample;
  for (Eigen::Index c = 0; c < glove.counts.cols(); ++c) counts[c] = glove.counts(sample, c);
  loop.Step({.counts = counts});
}

}  // namespace

Signal FirstAngles(const TrialSetup& setup, const GloveSignal& glove) {
  constexpr double kFirst_s = 0.1;
  const auto samples =
      std::clamp<Eigen::Index>(std::lround(kFirst_s * glove.rate_hz), 1, glove.counts.rows());
  Eigen::RowVectorXd counts(glove.counts.cols());
  for (Eigen::Index c = 0; c < counts.size(); ++c) {  // the median, as a sample may be a glitch
    std::vector<double> first(glove.counts.col(c).begin(), glove.counts.col(c).begin() + samples);
    const auto middle = first.begin() + samples / 2;
    std::ranges::nth_element(first, middle);
    counts[c] = *middle;
  }
  Signal angle_rad = counts;
  controller::MakeLinearisation(setup.controller.linearisation, setup.calibration,
                                glove.channel_names)
      ->ToAngles({counts.data(), static_cast<std::size_t>(counts.size())},
                 {angle_rad.data(), static_cast<std::size_t>(angle_rad.size())});
  angle_rad = angle_rad.array().isFinite().select(angle_rad, glove.true_angle_rad.topRows(1));
  return angle_rad;
}

Trace RunTrial(const TrialSetup& setup, const GloveSignal& glove, const TrialOptions& options) {
  GAUNTLET_ASSERT(glove.true_angle_rad.rows() > 0);
  GAUNTLET_ASSERT(glove.counts.cols() == std::ssize(glove.channel_names));
  const TrialPrograms programs(setup.controller);
  HandLoop loop(programs.config(), setup.calibration, setup.joint_map, setup.hand, setup.links);
  const controller::JointMap joint_map(setup.joint_map, glove.channel_names,
                                       setup.hand->transmission());
  const Signal start = JointAngles(joint_map, FirstAngles(setup, glove)).transpose();
  loop.Reset({start.data(), static_cast<std::size_t>(start.size())});

  Trace trace;
  trace.controller_name = setup.controller_name;
  const Eigen::Index ticks = glove.true_angle_rad.rows();
  TraceRecorder recorder(
      trace, ticks, TraceColumnNames(glove.channel_names, *setup.hand, setup.links.config.exist()),
      options.signals);
  std::vector<double> counts(glove.channel_names.size());
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    ThrowIfStopped();
    StepLoop(glove, tick, counts, loop);
    if (!loop.hand().health().ok) break;  // the engine has put the joints back to 0
    const bool is_asked = recorder.Record(loop) && options.keep_going;
    if (!programs.ok()) break;
    if (is_asked && !options.keep_going()) throw Cancelled{};
  }
  recorder.Finish();
  const auto untrusted = loop.controller().untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  trace.health = loop.hand().health();
  if (trace.health.ok && !programs.ok()) {
    ThrowIfStopped();  // which also ends a program's wait
    programs.ThrowMistake(setup.controller_name);
    trace.health = {.ok = false, .problem = programs.problem()};
  }
  return trace;
}

}  // namespace gauntlet::sim
