#include "sim/study/cause_trials.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "sim/base/error.h"
#include "sim/trial/filter_trial.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

// Trials for causes that are neither noise, glove, arm nor the parts of a link.
constexpr int kSwitchedHands = 4;
constexpr int kChainHands = 5;  // that of the glove, too

/// Commands at once, at every tick if may be.
void RemoveLink(bool keeps_events, Scenario& scenario) {
  scenario.event.delay_ms = 0.0;
  if (!keeps_events) scenario.event.period_ms = 1.0;
  for (ServoConfig* servo : {&scenario.hand.servo, &scenario.hand.arm_servo}) {
    servo->numbers().frame_ms = 0.0;
  }
}

void RemoveFriction(HandConfig& hand) {
  hand.motor_friction_scale = {0.0};
  hand.cable.backlash_deg = 0.0;
  for (ServoConfig* servo : {&hand.servo, &hand.arm_servo}) servo->numbers().play_deg = 0.0;
}

void RemoveServo(HandConfig& hand) {
  for (ServoConfig* servo : {&hand.servo, &hand.arm_servo}) {
    servo->settings = IdealServo{};
  }
}

/// A glove whose sensors are as the controller takes them to be.
GloveConfig WithExactSensors(GloveConfig config) {
  const SensorConfig exact = {.gain_deviation_percent = 0.0,
                              .offset_deviation_percent = 0.0,
                              .curvature_deviation_percent = 0.0,
                              .cross_talk_percent = 0.0,
                              .hysteresis_deg = 0.0};
  config.sensor = exact;
  return config;
}

bool HasArm(const HandModel& hand) {
  return std::ranges::count(hand.joint_groups(), JointGroup::kArm) > 0;
}

/// A map by which the joints of the arm hold the wearer's first posture.
controller::JointMapConfig WithArmAtRest(const Study& study, const GloveSignal& glove) {
  const HandModel& hand = *study.hand;
  const Signal first_rad = ReferenceAngles(study.joint_map(), glove.true_angle_rad.topRows(1));
  controller::JointMapConfig map = study.scenario.joint_map;
  for (std::size_t joint = 0; joint < hand.joint_groups().size(); ++joint) {
    if (hand.joint_groups()[joint] != JointGroup::kArm) continue;
    const auto place = static_cast<Eigen::Index>(joint);
    controller::JointSource at_rest = {.joint = hand.joint_names()[joint],
                                       .channels = {},
                                       .offset_deg = kDegPerRad * first_rad(0, place)};
    const auto old = std::ranges::find(map.joints, at_rest.joint, &controller::JointSource::joint);
    (old == map.joints.end() ? map.joints.emplace_back() : *old) = std::move(at_rest);
  }
  return map;
}

bool UsesGloveAsItIs(const controller::ControllerConfig& config) {
  return config.linearisation.kind == controller::LinearisationKind::kGlove;
}

/// Calls with the settings of each way that exists.
template <class Function>
void ForEachWay(LinksConfig& links, const Function& function) {
  if (links.glove) function(links.glove->transport);
  if (links.hand) function(links.hand->transport);
}

LinksConfig WithoutLoss(LinksConfig links) {
  ForEachWay(links, [](TransportConfig& way) { way.loss = {}; });
  return links;
}

LinksConfig WithoutJitter(LinksConfig links) {
  ForEachWay(links, [](TransportConfig& way) { way = way.WithoutJitter(); });
  return links;
}

bool HaveLoss(LinksConfig links) {
  bool any = false;
  ForEachWay(links, [&](const TransportConfig& way) {
    any = any || !std::holds_alternative<NoLoss>(way.loss.settings);
  });
  return any;
}

bool HaveJitter(LinksConfig links) {
  bool any = false;
  ForEachWay(links, [&](const TransportConfig& way) { any = any || way.has_jitter(); });
  return any;
}

/// The hand's angles in a trial; empty where it is stopped.
Signal HandOf(const TrialSetup& setup, const GloveSignal& glove,
              const CauseTrials::Subject& subject) {
  const Eigen::Index blocks =
      subject.glove.true_angle_rad.rows() / TraceRecorder::kBlockTicks + 1;  // of a whole trial
  Trace trace =
      RunTrial(setup, glove,
               {.keep_going = [&] { return subject.progress(1.0 / static_cast<double>(blocks)); },
                .signals = {"hand_angle_rad"}});
  return trace.health.ok ? std::move(trace.hand_angle_rad) : Signal();
}

}  // namespace

int SwitchedTrialsOf(const Study& study, int seed) {
  const bool knows_glove = TwinOf(study, seed) != TwinSource::kNone;
  return kSwitchedHands + int{knows_glove} + int{HasArm(*study.hand)};
}

int ChainTrialsOf(const Study& study) {
  int most_links = 0;
  for (const NamedController& named : study.scenario.controllers) {
    const LinksConfig links = LinksOf(study.scenario, named);
    most_links = std::max(most_links, int{HaveLoss(links)} + int{HaveJitter(links)});
  }
  return kChainHands + most_links;
}

std::shared_ptr<const HandModel> CauseTrials::HandWithout(const Causes& causes, bool keeps_events) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<const HandModel>& hand = hands_[{causes, keeps_events}];
  if (hand) return hand;
  Scenario scenario = study_.scenario;
  if (causes.contains(ErrorCause::kLink)) RemoveLink(keeps_events, scenario);
  if (causes.contains(ErrorCause::kSaturation)) scenario.hand.motor_limits = false;
  if (causes.contains(ErrorCause::kFriction)) RemoveFriction(scenario.hand);
  if (causes.contains(ErrorCause::kServo)) RemoveServo(scenario.hand);
  hand = std::make_shared<const HandModel>(scenario.hand, TimingOf(scenario));
  return hand;
}

CauseAngles CauseTrials::Run(const CausePlan& plan, const Subject& subject) {
  CauseAngles angles;
  if (plan.switched) {
    angles.switched_off_ticks = plan.ticks.value_or(subject.glove.true_angle_rad.rows());
    RunSwitched(subject, angles);
  }
  if (plan.chain) RunChain(subject, angles);
  return angles;
}

void CauseTrials::RunSwitched(const Subject& subject, CauseAngles& angles) {
  const Eigen::Index ticks = angles.switched_off_ticks;
  GloveSignal glove = subject.glove;
  CutGlove(ticks, glove);
  const TrialSetup all_on = SetupOf(study_, subject.named, subject.seed);
  const auto run = [&](const TrialSetup& setup, const GloveSignal& used) {
    return HandOf(setup, used, subject);
  };
  const auto of = [&](ErrorCause cause) -> Signal& {
    return angles.switched_off[std::ranges::find(kSwitchedCauses, cause) - kSwitchedCauses.begin()];
  };
  if (HasArm(*study_.hand)) {
    TrialSetup at_rest = all_on;
    at_rest.joint_map = WithArmAtRest(study_, glove);
    angles.arm_at_rest = run(at_rest, glove);
  }
  if (subject.noise_free.cols() > 0 && UsesGloveAsItIs(all_on.controller)) {
    GloveSignal exact = SynthesiseGlove(WithExactSensors(GloveOf(study_.scenario, subject.seed)),
                                        static_cast<std::uint64_t>(subject.seed));
    CutGlove(ticks, exact);
    of(ErrorCause::kGlove) = run(all_on, exact);
  }
  const bool keeps_events = all_on.controller.filter_at == controller::FilterAt::kEvent;
  for (const ErrorCause cause :
       {ErrorCause::kLink, ErrorCause::kSaturation, ErrorCause::kFriction, ErrorCause::kServo}) {
    TrialSetup setup = all_on;
    setup.hand = HandWithout({cause}, keeps_events);
    if (cause == ErrorCause::kLink) setup.links.config = {};
    of(cause) = run(setup, glove);
  }
}

void CauseTrials::RunChain(const Subject& subject, CauseAngles& angles) {
  const bool is_known = subject.noise_free.cols() > 0;
  const GloveConfig& config = GloveOf(study_.scenario, subject.seed);
  GloveSignal other;
  const GloveSignal* used = &subject.glove;
  const auto use = [&](const GloveConfig& with) {
    other = SynthesiseGlove(WithoutNoise(with), static_cast<std::uint64_t>(subject.seed));
    used = &other;
  };
  TrialSetup setup = SetupOf(study_, subject.named, subject.seed);
  const auto run = [&] { return HandOf(setup, *used, subject); };
  const auto of = [&](ErrorCause cause) -> Signal& {
    return angles.without[static_cast<std::size_t>(cause)];
  };
  if (is_known) {
    of(ErrorCause::kNoise) = subject.noise_free;
    if (UsesGloveAsItIs(setup.controller)) {
      use(WithExactSensors(config));
      of(ErrorCause::kGlove) = run();
    } else {
      use(config);
    }
  }
  LinksConfig& links = setup.links.config;
  if (HaveLoss(links)) {
    links = WithoutLoss(std::move(links));
    of(ErrorCause::kLinkLoss) = run();
  }
  if (HaveJitter(links)) {
    links = WithoutJitter(std::move(links));
    of(ErrorCause::kLinkJitter) = run();
  }
  const bool keeps_events = setup.controller.filter_at == controller::FilterAt::kEvent;
  links = {};
  Causes off;
  for (const ErrorCause cause :
       {ErrorCause::kLink, ErrorCause::kSaturation, ErrorCause::kFriction, ErrorCause::kServo}) {
    off.insert(cause);
    setup.hand = HandWithout(off, keeps_events);
    of(cause) = run();
  }
  Trace rest = RunFilterTrial(setup, *used);
  if (rest.health.ok) of(ErrorCause::kRest) = std::move(rest.hand_angle_rad);
}

}  // namespace gauntlet::sim
