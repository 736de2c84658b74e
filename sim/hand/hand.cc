#include "sim/hand/hand.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/assert.h"
#include "controller/tendon_map.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/hand/cable.h"
#include "sim/hand/cable_geometry.h"
#include "sim/hand/mujoco_messages.h"
#include "sim/hand/servo_input.h"

namespace gauntlet::sim {
namespace {

/// Digits that pass through each other take longer.
constexpr double kDigitLookMs = 10.0;

/// How much longer a cable's way is than the cable, with the spool at 0.
struct CableWay {
  double excess_m = 0.0;
  double rate_m_s = 0.0;
};

struct DrumMotion {
  double angle_rad = 0.0;
  double speed_rad_s = 0.0;
  bool free = false;  // within its play, where it does not touch the shaft
};

}  // namespace

struct Hand::State {
  explicit State(std::shared_ptr<const HandModel> hand_model);

  void ReadInputs() noexcept;
  void Advance();
  void LookAtDigits() noexcept;
  void LoadMotors() noexcept;
  void TurnSpools() noexcept;
  CableWay Way(const Cable& cable, std::vector<double>& arm_m) const noexcept;
  double Turned(const Crossing& crossing) const noexcept;
  double Bend(const Cable& cable) const noexcept;
  DrumMotion TurnDrum(const Drive& drive, const SpoolState& spool,
                      std::span<const CableState> states, std::span<const CableWay> ways,
                      double& angle_rad) const noexcept;
  double TurnShaft(const Drive& drive, const SpoolState& spool) noexcept;
  double PullCables(const Drive& drive, const SpoolState& spool, std::span<CableState> states,
                    double& drum_angle_rad) noexcept;
  void Pull(const Cable& cable, double stretch_m, double wound_rate_m_s,
            std::span<const double> arm_m, CableState& state) noexcept;
  void ReadWarnings(double time_s);

  static constexpr std::size_t kMostCables = 2;  // of one motor: a flexor and an extensor

  std::shared_ptr<const HandModel> hand;
  const mjModel& physics;
  std::unique_ptr<mjData, void (*)(mjData*)> data;
  std::vector<int> joint_qpos;            // per joint
  std::vector<ServoInput> inputs;         // per motor
  std::vector<double> target_rad;         // per motor, what the servos hold
  std::vector<double> sensor_error_rad;   // per motor, now
  std::vector<std::int32_t> counts;       // per motor, what was last commanded
  std::vector<std::uint8_t> saturated;    // per motor
  std::vector<SpoolState> spools;         // per motor
  std::vector<double> drum_rad;           // per motor; the spool's angle but for play
  std::vector<double> torque_nm;          // per motor, of the servo
  std::vector<double> load_nm;            // per motor, what turns its spool back
  std::vector<CableState> cables;         // in the order of HandModel::cable_names()
  std::vector<CablePlace> places;         // of one cable: its drum and what it passes
  std::vector<double> arms[kMostCables];  // per cable of one motor: moment arms of what it passes
  int ticks_per_digit_look = 10;
  int ticks_to_digit_look = 0;
  double digit_overlap_m = 0.0;  // when last looked
  bool commanded = false;        // since the Reset()
  bool powered = true;
  HandHealth health;
};

Hand::State::State(std::shared_ptr<const HandModel> hand_model)
    : hand(std::move(hand_model)),
      physics(hand->physics().model()),
      data(mj_makeData(&physics), &mj_deleteData) {
  if (data == nullptr) throw RunError("not enough memory for a hand");
  const std::size_t motors = hand->drives().size();
  for (const HandJoint& joint : hand->joints()) {
    joint_qpos.push_back(hand->physics().QposOf(joint.qpos));
  }
  for (std::size_t motor = 0; motor < motors; ++motor) {
    inputs.emplace_back(hand->drives()[motor].numbers, hand->timing().controller,
                        static_cast<int>(motor));
  }
  ticks_per_digit_look =
      std::max(1, static_cast<int>(hand->timing().controller.TicksOf(kDigitLookMs)));
  target_rad.resize(motors);
  sensor_error_rad.resize(motors);
  counts.resize(motors);
  saturated.resize(motors);
  spools.resize(motors);
  drum_rad.resize(motors);
  torque_nm.resize(motors);
  load_nm.resize(motors);
  cables.resize(hand->cable_names().size());
}

/// Inputs of every servo during this tick.
void Hand::State::ReadInputs() noexcept {
  const controller::TendonTransmission& map = hand->transmission();
  for (std::size_t motor = 0; motor < inputs.size(); ++motor) {
    target_rad[motor] = inputs[motor].Step(map.ToSpoolAngle(motor, counts[motor]), commanded);
    sensor_error_rad[motor] = inputs[motor].SensorError(spools[motor].angle_rad);
  }
}

void Hand::State::LookAtDigits() noexcept {
  if (--ticks_to_digit_look > 0) return;
  ticks_to_digit_look = ticks_per_digit_look;
  digit_overlap_m = hand->digits().Overlap(*data);
}

/// Measures the cable, and its moment arm at each joint that it passes.
CableWay Hand::State::Way(const Cable& cable, std::vector<double>& arm_m) const noexcept {
  arm_m.resize(cable.crossings.size());
  CableWay way;
  if (hand->engine_measures_cables()) {
    way = {data->ten_length[cable.tendon], data->ten_velocity[cable.tendon]};
    for (std::size_t i = 0; i < arm_m.size(); ++i) {
      arm_m[i] = MomentArm(physics, *data, cable.tendon, cable.crossings[i].dof);
    }
  } else {
    way.excess_m = MeasureCable(cable, data->qpos, data->qvel, arm_m, way.rate_m_s);
  }
  way.excess_m -= cable.natural_length_m;
  for (std::size_t i = 0; i < arm_m.size(); ++i) {
    const Crossing& crossing = cable.crossings[i];
    arm_m[i] += crossing.arm_error_m;
    way.excess_m += crossing.arm_error_m * (data->qpos[crossing.qpos] - crossing.reference_rad);
    way.rate_m_s += crossing.arm_error_m * data->qvel[crossing.dof];
  }
  return way;
}

/// How much more the cable bends at a joint than at the reference [rad].
double Hand::State::Turned(const Crossing& crossing) const noexcept {
  return crossing.bend_per_rad * (data->qpos[crossing.qpos] - crossing.reference_rad);
}

/// How far the cable bends from its drum to its end, that of the branch that bends most [rad].
double Hand::State::Bend(const Cable& cable) const noexcept {
  double most = 0.0;
  for (int branch = 0; branch < std::ssize(cable.branches); ++branch) {
    double bend = cable.branches[branch].bend_rad;
    for (const Crossing& crossing : cable.crossings) {
      if (cable.Contains(branch, crossing.branch)) bend += Turned(crossing);
    }
    most = std::max(most, bend);
  }
  return most;
}

/// The cable's pull on the joints that it passes, while its drum winds it up at `wound_rate_m_s`.
void Hand::State::Pull(const Cable& cable, double stretch_m, double wound_rate_m_s,
                       std::span<const double> arm_m, CableState& state) noexcept {
  GAUNTLET_ASSERT(arm_m.size() == cable.crossings.size());
  const double bend = Bend(cable);
  places.resize(cable.crossings.size() + 1);
  places[0] = {.speed_m_s = wound_rate_m_s};
  for (std::size_t i = 0; i < arm_m.size(); ++i) {
    const Crossing& crossing = cable.crossings[i];
    double turned = 0.0;
    for (std::size_t before = 0; before <= i; ++before) {
      const Crossing& passed = cable.crossings[before];
      if (cable.Contains(crossing.branch, passed.branch)) turned += Turned(passed);
    }
    const double share = bend > 0.0 ? (crossing.bend_rad + turned) / bend : 0.0;
    places[i + 1] = {.bend_share = std::clamp(share, 0.0, 1.0),
                     .speed_m_s = arm_m[i] * data->qvel[crossing.dof]};
  }
  PullCable(cable.cord, bend, stretch_m, physics.opt.timestep, places, state);
  for (std::size_t i = 0; i < arm_m.size(); ++i) {
    data->qfrc_applied[cable.crossings[i].dof] -= places[i + 1].pull_n * arm_m[i];
  }
}

/// Angle and speed of the drum. Without play it is the shaft; with play it has no mass and turns,
/// as far as it can, to where all its cables together do not turn it.
DrumMotion Hand::State::TurnDrum(const Drive& drive, const SpoolState& spool,
                                 std::span<const CableState> states, std::span<const CableWay> ways,
                                 double& angle_rad) const noexcept {
  GAUNTLET_ASSERT(states.size() == ways.size() && ways.size() <= drive.cables.size());
  const double before = std::exchange(angle_rad, spool.angle_rad);
  if (drive.play_rad == 0.0) return {spool.angle_rad, spool.speed_rad_s};
  double pull = 0.0;
  double stiffness = 0.0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Cable& cable = drive.cables[i];
    const double stretch = ways[i].excess_m + cable.sense * drive.drum_radius_m * before;
    stiffness += cable.cord.EndFactor() * cable.cord.stiffness_n_m;
    if (!(stretch > 0.0)) continue;
    pull += cable.sense * (cable.cord.stiffness_n_m * stretch + 0.5 * states[i].difference_n);
  }
  const double balance = before - pull / (drive.drum_radius_m * stiffness);
  angle_rad = DrumAngle(spool.angle_rad, balance, drive.play_rad);
  return {angle_rad, (angle_rad - before) / physics.opt.timestep, angle_rad == balance};
}

void Hand::State::LoadMotors() noexcept {
  mju_zero(data->qfrc_applied, physics.nv);
  std::span<CableState> left = cables;
  for (std::size_t motor = 0; motor < spools.size(); ++motor) {
    const Drive& drive = hand->drives()[motor];
    if (drive.has_shaft()) {
      load_nm[motor] = TurnShaft(drive, spools[motor]);
      continue;
    }
    load_nm[motor] =
        PullCables(drive, spools[motor], left.first(drive.cables.size()), drum_rad[motor]);
    left = left.subspan(drive.cables.size());
  }
}

/// A motor without cables: turns its joints; gives the torque with which they turn it back.
double Hand::State::TurnShaft(const Drive& drive, const SpoolState& spool) noexcept {
  const Shaft& shaft = drive.shaft;
  double angle_rad = -shaft.zero_error_rad;
  double speed_rad_s = 0.0;
  for (const ShaftJoint& joint : shaft.joints) {
    angle_rad += joint.ratio * (data->qpos[joint.qpos] - joint.reference_rad);
    speed_rad_s += joint.ratio * data->qvel[joint.dof];
  }
  const double twist_rad = spool.angle_rad - angle_rad;
  const double sense = std::copysign(1.0, twist_rad);
  const double shaft_nm = sense * CableTension(shaft.stiffness_nm_rad, shaft.damping_nm_s_rad,
                                               std::abs(twist_rad) - 0.5 * drive.play_rad,
                                               sense * (spool.speed_rad_s - speed_rad_s));
  for (const ShaftJoint& joint : shaft.joints) {
    data->qfrc_applied[joint.dof] += joint.ratio * shaft_nm;
  }
  return shaft_nm;
}

/// All cables of one motor: what they do to the joints that they pass; gives the torque with which
/// they turn the spool back.
double Hand::State::PullCables(const Drive& drive, const SpoolState& spool,
                               std::span<CableState> states, double& drum_angle_rad) noexcept {
  GAUNTLET_ASSERT(states.size() == drive.cables.size() && states.size() <= kMostCables);
  CableWay way_of_cable[kMostCables];
  const std::span<CableWay> ways(way_of_cable, states.size());
  for (std::size_t i = 0; i < ways.size(); ++i) ways[i] = Way(drive.cables[i], arms[i]);
  const DrumMotion drum = TurnDrum(drive, spool, states, ways, drum_angle_rad);
  const double wound = drive.drum_radius_m * drum.angle_rad;
  const double wound_rate = drive.drum_radius_m * drum.speed_rad_s;
  double at_drum = 0.0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Cable& cable = drive.cables[i];
    Pull(cable, ways[i].excess_m + cable.sense * wound, cable.sense * wound_rate, arms[i],
         states[i]);
    at_drum += cable.sense * states[i].tension_n;
  }
  return drum.free ? 0.0 : drive.drum_radius_m * at_drum;
}

void Hand::State::TurnSpools() noexcept {
  for (std::size_t motor = 0; motor < spools.size(); ++motor) {
    const Drive& drive = hand->drives()[motor];
    SpoolState& spool = spools[motor];
    const ServoTorque torque =
        powered ? ComputeServoTorque(drive.servo, target_rad[motor],
                                     spool.angle_rad + sensor_error_rad[motor], spool.speed_rad_s)
                : ServoTorque{};
    saturated[motor] = torque.saturated;
    torque_nm[motor] = torque.torque_nm;
    TurnSpool(drive.spool, torque.torque_nm, load_nm[motor], physics.opt.timestep, spool);
  }
}

/// `time_s` is when the step began: where the engine gives up, it sets its own clock to 0.
void Hand::State::ReadWarnings(double time_s) {
  for (int kind = 0; kind < mjNWARNING; ++kind) {
    const mjWarningStat& warning = data->warning[kind];
    if (warning.number == 0) continue;
    health.ok = false;
    health.problem =
        fmt::format("at {:.3f} s: {}", time_s, mju_warningText(kind, warning.lastinfo));
    return;
  }
  const std::string other = TakeMujocoWarning();
  if (other.empty()) return;
  health.ok = false;
  health.problem = fmt::format("at {:.3f} s: {}", time_s, other);
}

void Hand::State::Advance() {
  for (int step = 0; step < hand->timing().steps_per_tick && health.ok; ++step) {
    const double time_s = data->time;
    mj_step1(&physics, data.get());
    LoadMotors();
    TurnSpools();
    mj_step2(&physics, data.get());
    ReadWarnings(time_s);
  }
}

Hand::Hand(std::shared_ptr<const HandModel> model)
    : state_(std::make_unique<State>(std::move(model))) {
  Reset(hand_model().transmission().reference_angle_rad);
}
Hand::~Hand() = default;

void Hand::Reset(std::span<const double> joint_angle_rad) {
  GAUNTLET_ASSERT(joint_angle_rad.size() == state_->joint_qpos.size());
  State& state = *state_;
  const HandModel& hand = *state.hand;
  const controller::TendonTransmission& map = hand.as_built();
  std::vector<double> angle, from_center;
  for (std::size_t joint = 0; joint < joint_angle_rad.size(); ++joint) {
    angle.push_back(
        std::clamp(joint_angle_rad[joint], map.joint_min_rad[joint], map.joint_max_rad[joint]));
    from_center.push_back(angle[joint] - hand.center_error_rad()[joint]);
  }
  std::vector<double> spool(map.motor_names.size());
  controller::TendonMap(map, true).ToSpoolAngles(from_center, spool);
  mj_resetData(&state.physics, state.data.get());
  hand.physics().CopyPositions(
      PostureOf(hand.model(), hand.joints(), angle, hand.followers()).data(), state.data->qpos);
  mj_kinematics(&state.physics, state.data.get());
  if (hand.grasp().exists()) PlaceObject(hand.grasp_in_physics(), *state.data);
  mj_fwdPosition(&state.physics, state.data.get());
  mj_fwdVelocity(&state.physics, state.data.get());

  std::fill(state.cables.begin(), state.cables.end(), CableState{});
  std::fill(state.saturated.begin(), state.saturated.end(), 0);
  std::fill(state.torque_nm.begin(), state.torque_nm.end(), 0.0);
  for (std::size_t motor = 0; motor < spool.size(); ++motor) {
    state.counts[motor] =
        std::clamp(static_cast<std::int32_t>(std::round(map.ToCounts(motor, spool[motor]))),
                   map.min_counts[motor], map.max_counts[motor]);
    state.inputs[motor].Reset(map.ToSpoolAngle(motor, state.counts[motor]));
    state.spools[motor] = {.angle_rad = spool[motor]};
    state.drum_rad[motor] = spool[motor];
  }
  state.commanded = false;
  state.powered = true;
  state.health = {};
  TakeMujocoWarning();
  state.LoadMotors();
  state.ticks_to_digit_look = 0;
  state.LookAtDigits();
}

void Hand::SetCommand(std::span<const std::int32_t> motor_counts) noexcept {
  GAUNTLET_ASSERT(motor_counts.size() == state_->counts.size());
  const controller::TendonTransmission& map = hand_model().transmission();
  for (std::size_t motor = 0; motor < state_->counts.size(); ++motor) {
    state_->counts[motor] =
        std::clamp(motor_counts[motor], map.min_counts[motor], map.max_counts[motor]);
  }
  state_->commanded = true;
}

void Hand::SetPower(bool on) noexcept { state_->powered = on; }

std::span<const std::int32_t> Hand::command() const noexcept { return state_->counts; }

void Hand::Step() noexcept {
  if (!state_->health.ok) return;
  state_->ReadInputs();
  try {
    state_->Advance();
    state_->LookAtDigits();
  } catch (const std::exception& error) {
    state_->health = {.ok = false,
                      .problem = fmt::format("at {:.3f} s: {}", state_->data->time, error.what())};
  }
}

void Hand::ReadJointAngles(std::span<double> joint_angle_rad) const noexcept {
  GAUNTLET_ASSERT(joint_angle_rad.size() == state_->joint_qpos.size());
  const std::vector<int>& qpos = state_->joint_qpos;
  for (std::size_t i = 0; i < qpos.size(); ++i) joint_angle_rad[i] = data().qpos[qpos[i]];
}

void Hand::ReadSpoolAngles(std::span<double> spool_angle_rad) const noexcept {
  GAUNTLET_ASSERT(spool_angle_rad.size() == state_->spools.size());
  std::ranges::transform(state_->spools, spool_angle_rad.begin(), &SpoolState::angle_rad);
}

void Hand::ReadSpoolSpeeds(std::span<double> spool_speed_rad_s) const noexcept {
  GAUNTLET_ASSERT(spool_speed_rad_s.size() == state_->spools.size());
  std::ranges::transform(state_->spools, spool_speed_rad_s.begin(), &SpoolState::speed_rad_s);
}

void Hand::ReadServoTorques(std::span<double> torque_nm) const noexcept {
  GAUNTLET_ASSERT(torque_nm.size() == state_->torque_nm.size());
  std::copy(state_->torque_nm.begin(), state_->torque_nm.end(), torque_nm.begin());
}

void Hand::ReadCableTensions(std::span<double> tension_n) const noexcept {
  GAUNTLET_ASSERT(tension_n.size() == state_->cables.size());
  std::ranges::transform(state_->cables, tension_n.begin(), &CableState::tension_n);
}

double Hand::DigitOverlap() const noexcept { return state_->digit_overlap_m; }

double Hand::CableEnergy() const noexcept {
  double energy_j = 0.0;
  const CableState* state = state_->cables.data();
  for (const Drive& drive : hand_model().drives()) {
    for (const Cable& cable : drive.cables) energy_j += sim::CableEnergy(cable.cord, *state++);
  }
  return energy_j;
}

ObjectForces Hand::Forces() const noexcept {
  const GraspParts& grasp = hand_model().grasp_in_physics();
  return grasp.exists() ? ForcesOnObject(state_->physics, grasp, data()) : ObjectForces{};
}

void Hand::ReadObjectPose(std::span<double> pose) const noexcept {
  const GraspParts& grasp = hand_model().grasp_in_physics();
  GAUNTLET_ASSERT(!grasp.exists() || pose.size() == 7);
  if (grasp.exists()) std::copy_n(data().qpos + grasp.qpos, 7, pose.begin());
}

void Hand::ReadObjectInPalm(std::span<double> pose) const noexcept {
  const GraspParts& grasp = hand_model().grasp_in_physics();
  GAUNTLET_ASSERT(!grasp.exists() || pose.size() == 7);
  if (!grasp.exists()) return;
  const mjtNum* palm = data().xquat + 4 * grasp.palm_body;
  mjtNum to_palm[4], apart[3], place[3], attitude[4];
  mju_negQuat(to_palm, palm);
  mju_sub3(apart, data().xpos + 3 * grasp.object_body, data().xpos + 3 * grasp.palm_body);
  mju_rotVecQuat(place, apart, to_palm);
  mju_mulQuat(attitude, to_palm, data().xquat + 4 * grasp.object_body);
  std::copy_n(place, 3, pose.begin());
  std::copy_n(attitude, 4, pose.begin() + 3);
}

void Hand::ReadPalmVelocity(std::span<double> velocity_m_s) const noexcept {
  const int palm = hand_model().moving_palm();
  GAUNTLET_ASSERT(palm < 0 || velocity_m_s.size() == 3);
  if (palm < 0) return;
  mjtNum turning_and_moving[6];
  mj_objectVelocity(&state_->physics, &data(), mjOBJ_XBODY, palm, turning_and_moving, 0);
  std::copy_n(turning_and_moving + 3, 3, velocity_m_s.begin());
}

void Hand::ReadSaturation(std::span<std::uint8_t> saturated) const noexcept {
  GAUNTLET_ASSERT(saturated.size() == state_->saturated.size());
  std::copy(state_->saturated.begin(), state_->saturated.end(), saturated.begin());
}

const HandHealth& Hand::health() const noexcept { return state_->health; }
const HandModel& Hand::hand_model() const noexcept { return *state_->hand; }
const mjData& Hand::data() const noexcept { return *state_->data; }

}  // namespace gauntlet::sim
