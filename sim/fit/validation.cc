#include "sim/fit/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/quantile.h"
#include "sim/base/threads.h"
#include "sim/fit/answering_servo.h"

namespace gauntlet::sim {
namespace {

constexpr const char* kOnlyJoint = "joint";  // of models/one_joint.xml
constexpr double kMostTravel_deg = 300.0;    // of models/one_joint.xml
constexpr double kRests_deg_s = 5.0;
constexpr std::size_t kMostEpisodes = 6;  // held-out ones that are simulated

Eigen::Index RowsIn(const ChainLog& log, double duration_s) {
  return static_cast<Eigen::Index>(std::llround(duration_s * log.rate_hz));
}

/// A log of one episode in four equal stretches.
ChainEpisodes Cut(ChainEpisodes episodes) {
  if (episodes.logs.size() > 1) return episodes;
  constexpr Eigen::Index kStretches = 4;
  const ChainLog whole = std::move(episodes.logs.front());
  episodes.logs.clear();
  const Eigen::Index rows = whole.command_deg.rows() / kStretches;
  if (rows < RowsIn(whole, kShortestChainLog_s)) {
    throw UserError(
        {.place = whole.name,
         .problem = fmt::format("is {:.3g} s long, must be at least {:g} s: half of it is held out",
                                static_cast<double>(whole.command_deg.rows()) / whole.rate_hz,
                                kStretches * kShortestChainLog_s)});
  }
  for (Eigen::Index i = 0; i < kStretches; ++i) {
    ChainLog& log = episodes.logs.emplace_back(whole);
    log.episode = static_cast<int>(i);
    for (Signal* signal : {&log.command_deg, &log.angle_deg, &log.motor_deg}) {
      if (signal->rows() > 0) *signal = Signal(signal->middleRows(i * rows, rows));
    }
  }
  return episodes;
}

/// Parts of the log that one simulated hand answers.
struct Group {
  std::vector<std::size_t> parts;
  std::vector<std::string> joints;
};

/// An episode as the joints of the hand see it: commands by gain and offset of the chain. A joint
/// of its own has the middle of its motion at 0.
struct SeenLog {
  ChainLog log;
  std::vector<double> middle_deg;
};

SeenLog SeenBy(const Group& group, const ChainLog& log, const std::vector<ChainFit>& fits,
               bool centred) {
  const auto columns = std::ssize(group.parts);
  SeenLog seen;
  seen.log.name = log.name;
  seen.log.parts = group.joints;
  seen.log.rate_hz = log.rate_hz;
  seen.log.held = log.held;
  seen.log.command_deg = seen.log.angle_deg = Signal(log.command_deg.rows(), columns);
  for (std::size_t i = 0; i < group.parts.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(group.parts[i]);
    const auto to = static_cast<Eigen::Index>(i);
    const ChainModel& model = fits[group.parts[i]].model;
    const auto command = (model.gain * log.command_deg.col(from).array() + model.offset_deg).eval();
    const double middle_deg = centred ? 0.5 * (command.minCoeff() + command.maxCoeff()) : 0.0;
    seen.middle_deg.push_back(middle_deg);
    seen.log.command_deg.col(to) = command - middle_deg;
    seen.log.angle_deg.col(to) = log.angle_deg.col(from).array() - middle_deg;
  }
  return seen;
}

/// The signal at the rows of another rate, by straight lines.
std::vector<double> AtRate(std::span<const double> values, double rate_hz, double other_hz,
                           Eigen::Index rows) {
  std::vector<double> result;
  for (Eigen::Index k = 0; k < rows; ++k) {
    result.push_back(ValueAt(values, static_cast<double>(k) / other_hz * rate_hz));
  }
  return result;
}

/// Sums over the episodes of a part.
struct Sums {
  double error = 0.0, motion = 0.0, shifted = 0.0, count = 0.0;
  std::array<double, 3> by_speed{};
  std::vector<double> measured_delay_ms, simulated_delay_ms;
  double most_travel_deg = 0.0;
};

/// Adds one episode. Preconditions: curve signals of equal length.
void AddEpisode(const ValidatedCurve& curve, Sums& sums) {
  const auto first = static_cast<std::size_t>(kNotCompared_s * curve.rate_hz);
  const std::size_t rows = curve.command_deg.size();
  if (rows < first + 2) return;
  const double measured_ms = FitDelay_ms(curve.command_deg, curve.measured_deg, curve.rate_hz);
  const double simulated_ms = FitDelay_ms(curve.command_deg, curve.simulated_deg, curve.rate_hz);
  if (!std::isfinite(measured_ms) || !std::isfinite(simulated_ms)) return;
  sums.measured_delay_ms.push_back(measured_ms);
  sums.simulated_delay_ms.push_back(simulated_ms);
  std::vector<double> speed_deg_s(rows, 0.0);
  for (std::size_t k = 1; k < rows; ++k) {
    speed_deg_s[k] = std::abs(curve.command_deg[k] - curve.command_deg[k - 1]) * curve.rate_hz;
  }
  const double fast_deg_s = std::max(0.5 * Quantile(speed_deg_s, 0.95), kRests_deg_s);
  double mean_deg = 0.0;
  for (std::size_t k = first; k < rows; ++k) {
    mean_deg += curve.measured_deg[k] / static_cast<double>(rows - first);
  }
  for (std::size_t k = first; k < rows; ++k) {
    const double error = std::pow(curve.measured_deg[k] - curve.simulated_deg[k], 2);
    const double command_deg =
        ValueAt(curve.command_deg, static_cast<double>(k) - 1e-3 * measured_ms * curve.rate_hz);
    sums.error += error;
    sums.motion += std::pow(curve.measured_deg[k] - mean_deg, 2);
    sums.shifted += std::pow(curve.measured_deg[k] - command_deg, 2);
    ++sums.count;
    sums.by_speed[speed_deg_s[k] < kRests_deg_s ? 0 : speed_deg_s[k] < fast_deg_s ? 1 : 2] += error;
  }
}

void Finish(const Sums& sums, ValidatedPart& part) {
  if (sums.count == 0.0) {
    part.problem = "it hardly moves in the held-out episodes";
    return;
  }
  std::vector<double> difference_ms = sums.simulated_delay_ms;
  for (std::size_t e = 0; e < difference_ms.size(); ++e) {
    difference_ms[e] -= sums.measured_delay_ms[e];
  }
  part.delay_difference_ms = MeanOfEpisodes(difference_ms);
  part.episodes = sums.measured_delay_ms.size();
  part.measured_delay_ms = MeanOfEpisodes(sums.measured_delay_ms).value;
  part.simulated_delay_ms = MeanOfEpisodes(sums.simulated_delay_ms).value;
  part.rms_deg = std::sqrt(sums.error / sums.count);
  part.motion_rms_deg = std::sqrt(sums.motion / sums.count);
  part.shifted_rms_deg = std::sqrt(sums.shifted / sums.count);
  for (std::size_t i = 0; i < part.speed_share.size(); ++i) {
    part.speed_share[i] = sums.error > 0.0 ? sums.by_speed[i] / sums.error : 0.0;
  }
}

/// Why the part cannot be simulated; empty if it can.
std::string ProblemOfPart(const ChainResult& identified, std::size_t part) {
  const ChainFit& fit = identified.fits[part];
  if (!fit.problem.empty()) return fit.problem;
  if (!fit.split_problem.empty()) return fit.split_problem;
  double most_deg = 0.0;
  for (const ChainLog& log : identified.episodes) {
    const auto command = log.command_deg.col(static_cast<Eigen::Index>(part));
    most_deg = std::max(most_deg, fit.model.gain * (command.maxCoeff() - command.minCoeff()));
  }
  if (most_deg <= kMostTravel_deg) return "";
  return fmt::format("its motion spans more than {:g} deg; is the unit right?", kMostTravel_deg);
}

/// The servo that answers as the fitted episodes in which the parts move most.
std::optional<HandConfig> ServoFor(const Group& group, const ChainResult& identified,
                                   const HandConfig& usual, bool centred) {
  constexpr std::size_t kSearched = 3;
  std::vector<std::pair<double, ChainLog>> logs;                     // less motion
  for (std::size_t e = 0; e < identified.episodes.size(); e += 2) {  // the fitted ones
    SeenLog seen = SeenBy(group, identified.episodes[e], identified.fits, centred);
    const auto& command = seen.log.command_deg;
    const double motion =
        (command.bottomRows(command.rows() - 1) - command.topRows(command.rows() - 1))
            .cwiseAbs()
            .sum();
    logs.emplace_back(-motion, std::move(seen.log));
  }
  std::ranges::stable_sort(logs, {}, &std::pair<double, ChainLog>::first);
  std::vector<ChainLog> most;
  for (auto& [motion, log] : logs) {
    if (most.size() < kSearched) most.push_back(std::move(log));
  }
  const std::vector<ChainFit> fits = FitChains(most.front(), {}, ChainDetail::kBasic);
  const std::optional<AnsweringServo> first = UntriedServo(most.front(), fits, HandModel(usual));
  if (!first) return std::nullopt;
  const std::optional<ServoTrial> trial = TryServos(most.front(), fits, *first, usual);
  const AnsweringServo start = trial ? trial->servo : *first;
  const std::optional<AnsweringServo> servo = SearchServo(most, start, usual);
  if (!servo) return std::nullopt;
  return servo->PutInto(usual);
}

void ValidateGroup(const Group& group, const HandConfig& usual, bool centred,
                   Validation& validation) {
  const ChainResult& identified = validation.identified;
  const auto fail = [&](const std::string& problem) {
    for (const std::size_t p : group.parts) validation.parts[p].problem = problem;
  };
  std::optional<HandConfig> hand;
  try {
    hand = ServoFor(group, identified, usual, centred);
  } catch (const UserError& error) {
    return fail(error.problem());
  }
  if (!hand) return fail("no servo of the simulated hand answers so");
  std::vector<Sums> sums(group.parts.size());
  std::size_t simulated = 0;
  for (std::size_t e = 1; e < identified.episodes.size() && simulated < kMostEpisodes; e += 2) {
    const SeenLog seen = SeenBy(group, identified.episodes[e], identified.fits, centred);
    const ChainLog answer = SimulatedAnswer(seen.log, *hand);
    if (answer.angle_deg.rows() == 0) return fail("the simulated hand is unstable");
    ++simulated;
    for (std::size_t i = 0; i < group.parts.size(); ++i) {
      const auto at = std::ranges::find(answer.parts, group.joints[i]) - answer.parts.begin();
      ValidatedCurve curve;
      curve.rate_hz = answer.rate_hz;
      const Eigen::Index rows = answer.angle_deg.rows();
      curve.command_deg =
          AtRate(ColumnOf(seen.log.command_deg, i), seen.log.rate_hz, answer.rate_hz, rows);
      curve.measured_deg =
          AtRate(ColumnOf(seen.log.angle_deg, i), seen.log.rate_hz, answer.rate_hz, rows);
      const std::span<const double> of_hand =
          ColumnOf(answer.angle_deg, static_cast<std::size_t>(at));
      curve.simulated_deg.assign(of_hand.begin(), of_hand.end());
      for (auto* values : {&curve.command_deg, &curve.measured_deg, &curve.simulated_deg}) {
        for (double& value : *values) value += seen.middle_deg[i];
      }
      AddEpisode(curve, sums[i]);
      const auto [least, most] = std::ranges::minmax(curve.command_deg);
      if (most - least <= sums[i].most_travel_deg) continue;
      sums[i].most_travel_deg = most - least;
      validation.parts[group.parts[i]].shown = std::move(curve);
    }
  }
  for (std::size_t i = 0; i < group.parts.size(); ++i) {
    Finish(sums[i], validation.parts[group.parts[i]]);
  }
}

/// The parts that can be simulated, as joints of the hand, or each by itself. The others get their
/// problem.
std::vector<Group> GroupsOf(const std::filesystem::path& hand, const HandConfig& config,
                            std::vector<ValidatedPart>& parts) {
  std::vector<Group> groups;
  if (hand.empty()) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].problem.empty()) groups.push_back({.parts = {p}, .joints = {kOnlyJoint}});
    }
    return groups;
  }
  std::optional<HandModel> model;
  try {
    model.emplace(config);
  } catch (const UserError& error) {
    throw UserError({.place = "--hand " + hand.string(), .problem = error.problem()});
  }
  Group group;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool has_motor = std::ranges::any_of(model->drives(), [&](const Drive& drive) {
      return drive.name == parts[p].part && drive.servo_key == "hand.servo";
    });
    if (!has_motor) parts[p].problem = "the hand has no such joint";
    if (!parts[p].problem.empty()) continue;
    group.parts.push_back(p);
    group.joints.push_back(parts[p].part);
  }
  if (group.parts.empty()) {
    throw UserError({.place = "--hand " + hand.string(),
                     .problem = fmt::format("has no joint with a finger servo and the name of a "
                                            "part of the log ({})",
                                            parts.front().part)});
  }
  groups.push_back(std::move(group));
  return groups;
}

}  // namespace

Validation Validate(ChainEpisodes episodes, const std::filesystem::path& hand,
                    const ChainProgress& progress) {
  if (!episodes.logs.front().unit_known) {
    throw UserError({.place = episodes.logs.front().name,
                     .problem = "the unit of the angles is unknown, and a simulated hand needs it; "
                                "say --unit deg or --unit rad"});
  }
  Validation validation;
  validation.identified = IdentifyChain(Cut(std::move(episodes)), progress);
  if (validation.identified.judged == 0) {
    throw UserError(
        {.place = validation.identified.log().name,
         .problem = "has fewer than four episodes of 5 s or more, so none is held out"});
  }
  validation.hand = hand.string();
  HandConfig config;
  const bool centred = hand.empty();
  config.model_path = (centred ? DataFolder("models") / "one_joint.xml" : hand).string();
  for (std::size_t p = 0; p < validation.identified.fits.size(); ++p) {
    ValidatedPart& part = validation.parts.emplace_back();
    part.part = validation.identified.log().parts[p];
    part.repeat_rms_deg = validation.identified.held_out[p].repeat_rms_deg;
    part.problem = ProblemOfPart(validation.identified, p);
  }
  const std::vector<Group> groups = GroupsOf(hand, config, validation.parts);
  std::mutex mutex;
  int done = 0;
  const auto validate_group = [&](std::size_t g) {
    ValidateGroup(groups[g], config, centred, validation);
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, static_cast<int>(groups.size()));
  };
  ForEachOnThreads(std::max(1U, std::thread::hardware_concurrency()), groups.size(),
                   validate_group);
  return validation;
}

}  // namespace gauntlet::sim
