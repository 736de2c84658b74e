#include "sim/study/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "controller/linearisation/linearisation.h"
#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/fast_hash.h"
#include "sim/base/nearest_name.h"
#include "sim/glove/motions/postures.h"
#include "sim/hand/camera_view.h"
#include "sim/recordings/recording.h"
#include "sim/score/delay.h"
#include "sim/study/counted_parts.h"
#include "sim/study/prediction_fit.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/tables/name_words.h"
#include "sim/trial/external/answer_filter.h"
#include "sim/trial/external/external_filters.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

template <class Names>
std::vector<std::string> Selected(const Names& names, const std::vector<int>& indices) {
  std::vector<std::string> selected;
  for (const int index : indices) selected.push_back(names[static_cast<std::size_t>(index)]);
  return selected;
}

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

ScoredGroup ScoredGroupOf(JointGroup group) {
  switch (group) {
    case JointGroup::kWrist:
      return ScoredGroup::kWrist;
    case JointGroup::kArm:
      return ScoredGroup::kArm;
    case JointGroup::kFinger:
      break;
  }
  return ScoredGroup::kFinger;
}

/// Fills in which parts of the hand count.
void FindMeasuredParts(Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  const controller::JointMap joint_map = study.joint_map();
  const int joints = joint_map.joint_count();
  for (int joint = 0; joint < joints; ++joint) {
    if (joint_map.measured(joint)) study.measured_joints.push_back(joint);
  }
  study.joint_count = joints;
  study.measured_joint_names = Selected(hand.joint_names, study.measured_joints);
  int cable = 0;
  for (int motor = 0; motor < std::ssize(study.hand->drives()); ++motor) {
    const bool counts = std::ranges::any_of(study.measured_joints, [&](int joint) {
      return hand.coupling[motor * joints + joint] != 0.0;
    });
    if (counts) study.measured_motors.push_back(motor);
    for (std::size_t i = 0; i < study.hand->drives()[motor].cables.size(); ++i, ++cable) {
      if (counts) study.measured_cables.push_back(cable);
    }
  }
  study.rows =
      ScoreRows(study.measured_joint_names, Selected(hand.motor_names, study.measured_motors),
                Selected(study.hand->cable_names(), study.measured_cables));
  for (const int joint : study.measured_joints) {
    study.rows.joint_groups.push_back(ScoredGroupOf(study.hand->joint_groups()[joint]));
  }
}

/// Joints that no channel moves and the scenario does not hold stand as those of an open hand: in
/// the middle of their ranges, and with a relaxed thumb, digits would be in each other.
void HoldUnmeasuredJoints(const std::vector<std::string>& channels,
                          const controller::TendonTransmission& hand,
                          controller::JointMapConfig& joint_map) {
  const std::vector<std::string> known = KnownChannelNames();
  const std::vector<double> open_rad = PostureAngles(PostureIndex("open"));
  for (std::size_t joint = 0; joint < hand.joint_names.size(); ++joint) {
    const std::string& name = hand.joint_names[joint];
    const auto place = std::ranges::find(known, name) - known.begin();
    if (Has(channels, name) || place == std::ssize(known)) continue;
    if (std::ranges::find(joint_map.joints, name, &controller::JointSource::joint) !=
        joint_map.joints.end()) {
      continue;
    }
    const double held_rad = std::clamp(open_rad[static_cast<std::size_t>(place)],
                                       hand.joint_min_rad[joint], hand.joint_max_rad[joint]);
    const double held_deg = 1e-9 * std::round(1e9 * held_rad * kDegPerRad);
    joint_map.joints.push_back({.joint = name, .channels = {}, .offset_deg = held_deg});
  }
}

/// Refuses a map by which a joint would be at its limit all the time, whatever the wearer does.
/// Errors: SettingError `NAME` of the joint.
void CheckReach(const Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  const controller::JointMap joint_map = study.joint_map();
  for (const int joint : study.measured_joints) {
    if (joint_map.terms(joint).empty()) continue;
    double low_deg = joint_map.offset_rad(joint) * kDegPerRad;
    double high_deg = low_deg;
    for (const auto& term : joint_map.terms(joint)) {
      const std::string& name = study.channel_names()[static_cast<std::size_t>(term.channel)];
      const Channel& channel = KnownChannels()[static_cast<std::size_t>(ChannelIndex(name))];
      const auto [low, high] =
          std::minmax({term.weight * channel.min_deg, term.weight * channel.max_deg});
      low_deg += low;
      high_deg += high;
    }
    const auto place = static_cast<std::size_t>(joint);
    const double min_deg = hand.joint_min_rad[place] * kDegPerRad;
    const double max_deg = hand.joint_max_rad[place] * kDegPerRad;
    if (low_deg < max_deg && high_deg > min_deg) continue;
    throw controller::SettingError(
        hand.joint_names[place],
        fmt::format("asks for {:.6g} to {:.6g} deg, must reach into the joint's range of {:.6g} to "
                    "{:.6g}",
                    low_deg, high_deg, min_deg, max_deg));
  }
}

void Add(const Signal& signal, FastHash& hash) {
  for (Eigen::Index c = 0; c < signal.cols(); ++c) {
    hash.Add(std::span(signal.col(c).data(), static_cast<std::size_t>(signal.rows())));
    TrimSignals();
  }
}

/// The joint whose curves video and report begin with. A scenario for a full glove also serves a
/// smaller one: for a joint of the hand that it does not measure another stands in, with a remark.
/// Errors: SettingError for what is no joint of the hand.
void ChooseVideoChannel(Study& study, std::string& channel) {
  const std::vector<std::string>& measured = study.measured_joint_names;
  if (Has(measured, channel)) return;
  const std::string asked = channel;
  if (!asked.empty() && !Has(study.hand->joint_names(), asked)) {
    throw controller::SettingError(
        "video.channel", asked + " is not a joint of the hand" + Suggestion(asked, measured));
  }
  channel = Has(measured, "index_mcp") ? "index_mcp" : measured.front();
  if (asked.empty()) return;
  study.remarks.push_back("video.channel: " + asked + " is not measured by the glove; " + channel +
                          " is shown in its place");
}

/// How much of the time the wearer of the first glove asks a joint for what is beyond its range:
/// there the hand is at its limit with every controller. Empty if it never matters.
std::string BeyondRangeRemark(const Study& study) {
  constexpr double kMatters_deg = 0.5;
  constexpr double kLeastShare = 0.005;
  const controller::TendonTransmission& hand = study.hand->transmission();
  const Signal reference_rad =
      ReferenceAngles(study.joint_map(), study.gloves.front()->true_angle_rad);
  std::vector<std::pair<double, std::string>> joints;
  for (const int joint : study.measured_joints) {
    const auto place = static_cast<std::size_t>(joint);
    const auto asked_deg = kDegPerRad * reference_rad.col(joint).array();
    const double min_deg = kDegPerRad * hand.joint_min_rad[place];
    const double max_deg = kDegPerRad * hand.joint_max_rad[place];
    const auto beyond =
        (asked_deg < min_deg - kMatters_deg || asked_deg > max_deg + kMatters_deg).count();
    const double share = static_cast<double>(beyond) / static_cast<double>(asked_deg.size());
    if (share < kLeastShare) continue;
    joints.push_back(
        {-share, fmt::format("{} {:.0f} % (targets {:.0f} to {:.0f} deg, range "
                             "{:.0f} to {:.0f})",
                             hand.joint_names[place], std::max(1.0, 100.0 * share),
                             asked_deg.minCoeff(), asked_deg.maxCoeff(), min_deg, max_deg)});
  }
  if (joints.empty()) return "";
  std::ranges::sort(joints);
  constexpr std::size_t kMostShown = 3;
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(joints.size(), kMostShown); ++i) {
    shown.push_back(joints[i].second);
  }
  const std::size_t more = joints.size() - shown.size();
  return fmt::format("joint_map: targets beyond the joint's range: {} of the time{}",
                     fmt::join(shown, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

/// One line per controller whose calibration contradicts the column map, by which the recorded
/// counts became the reference, by more than a degree.
std::vector<std::string> CalibrationRemarks(const Study& study) {
  constexpr double kMatters_deg = 1.0;
  const controller::GloveCalibration& glove = study.calibration;
  const Recording* recording = study.gloves.front()->recording.get();
  if (recording == nullptr || study.scenario.glove.calibration.empty()) return {};
  std::vector<std::string> remarks;
  for (const NamedController& named : study.scenario.controllers) {
    const auto curves =
        controller::MakeLinearisation(named.config.linearisation, glove, glove.channel_names);
    double worst_deg = 0.0;
    std::string worst;
    for (const OwnCounts& own : recording->own_counts) {
      const std::string name(KnownChannels()[own.channel].name);
      const auto c = std::ranges::find(glove.channel_names, name) - glove.channel_names.begin();
      if (c == std::ssize(glove.channel_names)) continue;
      for (const double counts : {own.low_counts, own.high_counts}) {
        std::vector<double> sample(glove.channel_names.size(), counts);
        curves->ToAngles(sample, sample);
        const double map_rad = own.scale.factor * counts + own.scale.offset_rad;
        const double off_deg = std::abs(sample[c] - map_rad) * kDegPerRad;
        if (off_deg > worst_deg) worst = name;
        worst_deg = std::max(worst_deg, off_deg);
      }
    }
    if (worst_deg <= kMatters_deg) continue;
    remarks.push_back(fmt::format(
        "controllers.{}: its calibration and the column map differ by up to {:.1f} deg ({}). The "
        "reference follows the map: give it the calibrated points",
        named.name, worst_deg, worst));
  }
  return remarks;
}

/// One line for the user if the wearer's motion of the first seed repeats; else empty.
std::string RepeatRemark(const Study& study) {
  const GloveSignal& glove = *study.gloves.front();
  const Signal reference_rad = ReferenceAngles(study.joint_map(), glove.true_angle_rad);
  const auto ticks = static_cast<int>(reference_rad.rows());
  const std::optional<CountedParts> counted = CountedPartsOf(study, glove.masked, ticks);
  Fourier fourier;
  std::vector<double> periods_ms;
  for (std::size_t i = 0; i < study.measured_joints.size(); ++i) {
    const std::span<const double> joint(reference_rad.col(study.measured_joints[i]).data(),
                                        static_cast<std::size_t>(ticks));
    const std::optional<double> period_s =
        RepeatPeriod_s(joint, glove.tick_rate_hz,
                       counted ? counted->joints[i] : CountedTicks{{0, ticks}}, fourier);
    if (period_s) periods_ms.push_back(1e3 * *period_s);
  }
  if (periods_ms.empty()) return "";
  const auto [least, most] = std::ranges::minmax(periods_ms);
  return fmt::format(
      "the motion of {} of {} joints repeats after {:.0f}{} ms: the delay is known there up to a "
      "multiple of this",
      periods_ms.size(), study.measured_joints.size(), least,
      least == most ? "" : fmt::format(" to {:.0f}", most));
}

}  // namespace

GloveFacts FactsOf(const GloveSignal& glove) {
  FastHash motion;
  Add(glove.true_angle_rad, motion);
  FastHash signal = motion;
  Add(glove.counts, signal);
  for (const MaskedStretch& stretch : glove.masked) {
    const double values[] = {static_cast<double>(stretch.reason),
                             static_cast<double>(stretch.channel),
                             static_cast<double>(stretch.begin), static_cast<double>(stretch.end)};
    signal.Add(std::span<const double>(values));
  }
  return {.signal_hash = signal.Text(),
          .motion_hash = motion.Text(),
          .ticks = glove.true_angle_rad.rows(),
          .is_recorded = glove.is_recorded,
          .is_of_recording = glove.recording != nullptr,
          .masked = glove.masked};
}

std::string FittedToOneGlove(const Study& study) {
  const bool is_recorded = std::ranges::all_of(study.repetitions, &GloveFacts::is_recorded);
  if (is_recorded || !study.scenario.glove.sensor.is_drawn()) return "";
  const auto fitted =
      std::ranges::find_if(study.scenario.controllers, [](const NamedController& named) {
        return named.config.linearisation.kind != controller::LinearisationKind::kGlove;
      });
  return fitted == study.scenario.controllers.end() ? "" : fitted->name;
}

void RefuseOtherGloves(const Study& study, int seeds) {
  const std::string name = FittedToOneGlove(study);
  if (name.empty()) return;
  throw controller::SettingError(
      "controllers." + name,
      fmt::format("has the curves of one glove, but each of {} seeds draws another glove: use "
                  "recordings of that glove, or set the deviations of glove.sensor to 0; gauntlet "
                  "run compares controllers on one seed",
                  seeds));
}

controller::RobotConfig RobotOf(const Scenario& scenario, const HandModel& hand,
                                const controller::ControllerConfig& config) {
  return {.controller = config,
          .glove = NominalCalibration(scenario.glove),
          .hand = hand.transmission(),
          .joint_map = scenario.joint_map,
          .timing = hand.timing().controller};
}

std::shared_ptr<const GloveSignal> GloveOfSeed(const Study& study, int seed) {
  const auto place = static_cast<std::size_t>(seed - study.scenario.seed);
  if (place < study.gloves.size()) return study.gloves[place];
  return std::make_shared<const GloveSignal>(
      SynthesiseGlove(GloveOf(study.scenario, seed), static_cast<std::uint64_t>(seed)));
}

TwinSource TwinOf(const Study& study, int seed) {
  if (!study.scenario.score.noise_free_twin) return TwinSource::kNone;
  const int repetition = (seed - study.scenario.seed) % static_cast<int>(study.repetitions.size());
  if (study.repetitions[repetition].is_recorded) return TwinSource::kNone;
  const bool itself = IsWithoutNoise(GloveOf(study.scenario, seed));
  return itself ? TwinSource::kItself : TwinSource::kTrial;
}

void KeepGloves(int seeds, Study& study) {
  constexpr Eigen::Index kMostBytes = 64 << 20;
  Eigen::Index bytes = 0;
  while (std::ssize(study.gloves) < seeds) {
    const GloveSignal& last = *study.gloves.back();
    bytes += static_cast<Eigen::Index>(sizeof(double)) *
             (last.true_angle_rad.size() + last.counts.size() + last.tremor_rad.size());
    if (bytes > kMostBytes) return;
    study.gloves.push_back(
        GloveOfSeed(study, study.scenario.seed + static_cast<int>(study.gloves.size())));
  }
}

TrialSetup SetupOf(const Study& study, const NamedController& named, int seed) {
  return {.controller_name = named.name,
          .controller = ControllerOfSeed(study, named.config, seed),
          .calibration = study.calibration,
          .joint_map = study.scenario.joint_map,
          .hand = study.hand,
          .links = {.config = LinksOf(study.scenario, named),
                    .seed = static_cast<std::uint64_t>(seed)}};
}

void CheckController(const Study& study, const NamedController& named) {
  controller::WithinSetting("controllers." + named.name, [&] {
    CheckPrograms(named.config);
    return controller::Controller(
        RobotOf(study.scenario, *study.hand,
                WithoutPrograms(ControllerOfSeed(study, named.config, study.scenario.seed))));
  });
  LinksOf(study.scenario, named).Check();
}

void ChooseVideoCamera(const HandModel& hand, std::string& camera) {
  const std::vector<std::string> views = CameraViewNames(hand.CameraNames());
  if (camera.empty() || Has(views, camera)) return;
  if (camera != VideoConfig{}.camera) {
    throw controller::SettingError(
        "video.camera", camera + " is not a camera of the hand" + Suggestion(camera, views));
  }
  camera.clear();  // the default: a model need not have it
}

/// Reads what other programs made of the recording, for the controllers that have it as filter.
/// Errors: SettingError, UserError.
void ReadAnswers(Study& study) {
  for (NamedController& named : study.scenario.controllers) {
    for (std::size_t i = 0; i < named.config.filters.size(); ++i) {
      auto* filter = std::get_if<controller::ExternalConfig>(&named.config.filters[i].settings);
      if (filter == nullptr || filter->answers.empty()) continue;
      const std::string path = fmt::format("controllers.{}.filter[{}]", named.name, i);
      controller::WithinSetting("controllers." + named.name, [&] { CheckPrograms(named.config); });
      controller::WithinSetting(path, [&] {
        if (study.repetitions.size() > 1) {
          throw controller::SettingError(
              "answers",
              fmt::format("are of one recording, the glove plays {}", study.repetitions.size()));
        }
        const GloveSignal& glove = *study.gloves.front();
        study.answers.push_back(MakerOfAnswers(
            AnswersInCounts(study.scenario.glove, glove, filter->answers, filter->answers_map),
            glove.channel_names));
        filter->make = study.answers.back().get();
      });
    }
  }
}

Study PrepareStudy(Scenario scenario) {
  Study study;
  // A recording that cannot be read is found here, before anything is written.
  controller::WithinSetting("glove", [&] {
    const int count = std::max(1, static_cast<int>(scenario.repetitions.gloves.size()));
    for (int i = 0; i < count; ++i) {
      const int seed = scenario.seed + i;
      GloveSignal glove =
          SynthesiseGlove(GloveOf(scenario, seed), static_cast<std::uint64_t>(seed));
      study.repetitions.push_back(FactsOf(glove));
      for (const std::string& remark : glove.remarks) {  // the same of many is said once
        if (!Has(study.remarks, remark)) study.remarks.push_back(remark);
      }
      if (i == 0) study.gloves = {std::make_shared<const GloveSignal>(std::move(glove))};
    }
  });
  study.hand = std::make_shared<const HandModel>(scenario.hand, TimingOf(scenario));
  study.fingertips = Fingertips::Of(*study.hand, FingerOfJointName);
  study.remarks.insert(study.remarks.end(), study.hand->notes().begin(), study.hand->notes().end());
  study.calibration = NominalCalibration(scenario.glove);
  const Eigen::Index fewest_ticks =
      std::ranges::min(study.repetitions, {}, &GloveFacts::ticks).ticks;
  controller::WithinSetting(
      "score", [&] { scenario.score.Check(study.hand->timing().tick_rate_hz(), fewest_ticks); });
  controller::WithinSetting("joint_map", [&] {
    HoldUnmeasuredJoints(study.channel_names(), study.hand->transmission(), scenario.joint_map);
    study.scenario.joint_map = scenario.joint_map;
    FindMeasuredParts(study);
    CheckReach(study);
  });
  if (study.measured_joints.empty()) {
    throw controller::SettingError("joint_map",
                                   "moves no joint of the hand: none of its joints is called like "
                                   "a channel of the glove");
  }
  study.scenario = std::move(scenario);
  study.fits = std::make_shared<PredictionFits>();
  ReadAnswers(study);
  for (const NamedController& named : study.scenario.controllers) CheckController(study, named);
  ChooseVideoChannel(study, study.scenario.video.channel);
  ChooseVideoCamera(*study.hand, study.scenario.video.camera);
  for (std::string& remark : CalibrationRemarks(study)) study.remarks.push_back(std::move(remark));
  const std::string counted = CountedRemark(study);
  if (!counted.empty()) study.remarks.push_back(counted);
  for (const std::string& remark : {BeyondRangeRemark(study), RepeatRemark(study)}) {
    if (!remark.empty()) study.remarks.push_back(remark);
  }
  return study;
}

Study PrepareStudy(const ScenarioSource& source, Scenario scenario) {
  try {
    return PrepareStudy(std::move(scenario));
  } catch (const controller::SettingError& error) {
    throw AtPlace(PlaceOfSetting(source, error.key()), error);
  } catch (const UserError& error) {
    if (!error.place().empty()) throw;
    throw UserError({.place = PlaceOfSetting(source, error.key()),
                     .key = error.key(),
                     .problem = error.problem()});
  }
}

void CheckProgramsOf(const ScenarioSource& source, const std::vector<std::string>& controllers) {
  Scenario scenario = ParseScenario(source);
  KeepControllers(controllers, scenario);
  try {
    for (const NamedController& named : scenario.controllers) {
      controller::WithinSetting("controllers." + named.name, [&] { CheckPrograms(named.config); });
    }
  } catch (const controller::SettingError& error) {
    throw AtPlace(PlaceOfSetting(source, error.key()), error);
  }
}

}  // namespace gauntlet::sim
