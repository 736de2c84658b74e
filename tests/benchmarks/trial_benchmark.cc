// How much of a trial's time is physics?
//
// Runs scenarios/paper.yaml with one controller (glove, controller, hand, scores and trace file),
// and then, in the same run, a bare mj_step loop on the same model that gets the same forces from
// memory. Prints medians of several repetitions, in seconds of processor time.
//
//   trial_benchmark [repetitions]
#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <vector>

#include "sim/answers/compare/study_files.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

/// Processor time of this program: what other programs take meanwhile does not count.
double Seconds(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Forces of every step, as the cables of a trial gave them.
struct RecordedForces {
  std::vector<mjtNum> joint;  // steps x nv
};

RecordedForces RecordForces(const Study& study, const Trace& trace, const GloveSignal& glove) {
  const mjModel& model = study.hand->physics().model();
  const Eigen::Index steps = trace.command_counts.rows();
  RecordedForces forces;
  forces.joint.resize(static_cast<std::size_t>(steps * model.nv));
  Hand hand(study.hand);
  const Eigen::VectorXd start = glove.true_angle_rad.row(0);
  hand.Reset({start.data(), static_cast<std::size_t>(start.size())});
  std::vector<std::int32_t> command(static_cast<std::size_t>(trace.command_counts.cols()));
  for (Eigen::Index k = 0; k < steps; ++k) {
    bool changed = false;
    for (std::size_t m = 0; m < command.size(); ++m) {
      const int value = trace.command_counts(k, static_cast<Eigen::Index>(m));
      changed |= k > 0 && value != command[m];
      command[m] = value;
    }
    if (changed) hand.SetCommand(command);
    hand.Step();
    std::memcpy(&forces.joint[static_cast<std::size_t>(k * model.nv)], hand.data().qfrc_applied,
                sizeof(mjtNum) * static_cast<std::size_t>(model.nv));
  }
  return forces;
}

void BareLoop(const Study& study, const GloveSignal& glove, const RecordedForces& forces,
              Eigen::Index steps) {
  const mjModel& model = study.hand->physics().model();
  Hand start(study.hand);
  const Eigen::VectorXd posture = glove.true_angle_rad.row(0);
  start.Reset({posture.data(), static_cast<std::size_t>(posture.size())});
  mjData* data = mj_makeData(&model);
  mju_copy(data->qpos, start.data().qpos, model.nq);
  for (Eigen::Index k = 0; k < steps; ++k) {
    mju_copy(data->qfrc_applied, &forces.joint[static_cast<std::size_t>(k * model.nv)], model.nv);
    mj_step(&model, data);
  }
  mj_deleteData(data);
}

void Run(int repetitions) {
  Scenario scenario = LoadScenario(GAUNTLET_SOURCE_DIR "/scenarios/paper.yaml", {});
  scenario.controllers = {scenario.controllers.back()};
  const Study study = PrepareStudy(std::move(scenario));
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("gauntlet_benchmark_{}", getpid());
  std::filesystem::create_directories(folder);

  StudyResult result = RunStudy(study, {});
  const Eigen::Index steps = result.first_traces[0].hand_angle_rad.rows();
  const RecordedForces forces = RecordForces(study, result.first_traces[0], *result.first_glove);
  const FinishedStudy finished{
      .study = study, .result = result, .summary = Summarise(study, result)};
  std::vector<double> trial_s;
  std::vector<double> loop_s;
  std::vector<double> glove_s;
  std::vector<double> files_s;
  std::vector<double> bare_s;
  for (int i = 0; i < repetitions; ++i) {
    loop_s.push_back(Seconds([&] {
      RunTrial(SetupOf(study, study.scenario.controllers[0], study.scenario.seed),
               *result.first_glove);
    }));
    trial_s.push_back(Seconds([&] {
      FinishedStudy timed{.study = study, .result = RunStudy(study, {}), .summary = {}};
      timed.summary = Summarise(study, timed.result);
      WriteStudyFiles(folder, timed);
    }));
    glove_s.push_back(Seconds([&] { SynthesiseGlove(study.scenario.glove, 1); }));
    files_s.push_back(Seconds([&] { WriteStudyFiles(folder, finished); }));
    bare_s.push_back(Seconds([&] { BareLoop(study, *result.first_glove, forces, steps); }));
  }
  std::filesystem::remove_all(folder);

  const double simulated_s = static_cast<double>(steps) / study.scenario.glove.rate_hz;
  const auto print = [&](const char* name, double seconds) {
    fmt::print("{:<44} {:7.2f} s {:8.0f} steps/s {:6.1f} x real time\n", name, seconds,
               static_cast<double>(steps) / seconds, simulated_s / seconds);
  };
  fmt::print("{} steps, one controller, median of {}\n", steps, repetitions);
  print("whole trial (glove, loop, scores, trace file)", Median(trial_s));
  print("trial loop alone", Median(loop_s));
  print("glove alone", Median(glove_s));
  print("files alone", Median(files_s));
  print("bare mj_step, same forces", Median(bare_s));
  std::vector<double> trial_ratio;
  std::vector<double> loop_ratio;
  for (std::size_t i = 0; i < bare_s.size(); ++i) {
    trial_ratio.push_back(bare_s[i] / trial_s[i]);
    loop_ratio.push_back(bare_s[i] / loop_s[i]);
  }
  fmt::print("steps/s against bare: whole trial {:.3f}, loop alone {:.3f}\n", Median(trial_ratio),
             Median(loop_ratio));
}

}  // namespace
}  // namespace gauntlet::sim

int main(int argc, char** argv) {
  gauntlet::sim::Run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5);
  return 0;
}
