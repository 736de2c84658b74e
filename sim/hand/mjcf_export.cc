#include "sim/hand/mjcf_export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/hand/mjcf_reader.h"
#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

std::string Numbers(std::span<const double> values) {
  return fmt::format("{}", fmt::join(values, " "));
}

std::string NameOf(const MjcfElement& element) {
  const std::string* const name = element.Find("name");
  return name == nullptr ? std::string() : *name;
}

MjcfElement& AddChild(MjcfElement& parent, const char* name) {
  MjcfElement& child = parent.children.emplace_back();
  child.name = name;
  return child;
}

/// The last child of this name, which counts before others; a new one if there is none.
MjcfElement& LastChild(MjcfElement& parent, const char* name) {
  const auto found = std::find_if(parent.children.rbegin(), parent.children.rend(),
                                  [&](const MjcfElement& child) { return child.name == name; });
  return found == parent.children.rend() ? AddChild(parent, name) : *found;
}

class MjcfExporter {
 public:
  MjcfExporter(const HandModel& hand, fs::path asset_folder)
      : hand_(hand),
        model_(hand.model()),
        asset_folder_(std::move(asset_folder)),
        root_(ReadModelText(hand.file()).root) {}

  ExportedMjcf Export(const std::string& name) {
    // Their targets are spools, or they count the parts that go.
    std::erase_if(root_.children, [](const MjcfElement& section) {
      return section.name == "actuator" || section.name == "sensor" || section.name == "keyframe";
    });
    for (MjcfElement& section : root_.children) {
      if (section.name == "worldbody") VisitBody(section);
      if (section.name == "tendon") VisitTendons(section);
      if (section.name == "asset") VisitAssets(section);
    }
    HoldConstraints();
    for (MjcfElement& section : root_.children) {
      if (section.name != "compiler") continue;
      for (const char* const folder : {"meshdir", "texturedir", "assetdir", "strippath"}) {
        section.Remove(folder);
      }
    }
    MjcfElement& option = LastChild(root_, "option");
    option.Set("timestep", fmt::format("{}", model_.opt.timestep));
    LastChild(option, "flag")
        .Set("contact", (model_.opt.disableflags & mjDSBL_CONTACT) != 0 ? "disable" : "enable");
    AddActuators();
    AddKeyframe();
    Note();
    return {Head(name) + IndentedMjcfText(root_), std::move(assets_), std::move(notes_)};
  }

 private:
  /// -1 for a joint that the model does not have by this name.
  int DofOf(const std::string& joint) const {
    const int index = joint.empty() ? -1 : mj_name2id(&model_, mjOBJ_JOINT, joint.c_str());
    return index < 0 ? -1 : model_.jnt_dofadr[index];
  }

  bool IsSpool(int dof) const {
    return dof >= 0 &&
           std::ranges::find(hand_.drives(), dof, &Drive::spool_dof) != hand_.drives().end();
  }

  void VisitBody(MjcfElement& body) {
    std::erase_if(body.children, [this](const MjcfElement& child) {
      return child.name == "joint" && IsSpool(DofOf(NameOf(child)));
    });
    const bool is_object =
        hand_.grasp().exists() && body.name == "body" && NameOf(body) == "object";
    for (MjcfElement& child : body.children) {
      if (child.name == "joint") VisitJoint(child);
      if (child.name == "geom" && is_object) VisitObject(child);
      if (child.name == "body" || child.name == "frame") VisitBody(child);
    }
  }

  void VisitJoint(MjcfElement& joint) const {
    const int dof = DofOf(NameOf(joint));
    if (dof < 0) return;
    double armature = model_.dof_armature[dof];
    for (const Drive& drive : hand_.drives()) {
      for (const ShaftJoint& turned : drive.shaft.joints) {
        if (turned.name != NameOf(joint)) continue;
        armature = drive.spool.inertia_kg_m2 * turned.ratio * turned.ratio;
        if (drive.shaft.joints.size() == 1) {
          joint.Set("frictionloss", fmt::format("{}", drive.spool.dry_friction_nm));
        }
      }
    }
    joint.Set("armature", fmt::format("{}", armature));
    if (model_.dof_frictionloss[dof] > 0.0) {
      SetSolver(joint, "friction", model_.dof_solref, model_.dof_solimp, dof);
    }
  }

  /// As MakeObject() does it: the shape of the name `object` has all of the mass.
  void VisitObject(MjcfElement& geom) const {
    const std::string name = NameOf(geom);
    const int index = name.empty() ? -1 : mj_name2id(&model_, mjOBJ_GEOM, name.c_str());
    geom.Set(
        "mass",
        fmt::format("{}", name == "object" ? model_.body_mass[hand_.grasp().object_body] : 0.0));
    if (index < 0 || (name != "object" && index != hand_.grasp().skin_geom)) return;
    geom.Set("size", Numbers({model_.geom_size + 3 * index, 2}));
    geom.Set("friction", Numbers({model_.geom_friction + 3 * index, 3}));
    geom.Set("priority", fmt::format("{}", model_.geom_priority[index]));
  }

  /// The actuators are what is elastic: a spring of the engine would push when slack.
  void VisitTendons(MjcfElement& section) const {
    for (MjcfElement& tendon : section.children) {
      const std::string name = NameOf(tendon);
      const int index = name.empty() ? -1 : mj_name2id(&model_, mjOBJ_TENDON, name.c_str());
      if (index < 0) continue;
      if (model_.tendon_frictionloss[index] > 0.0) {
        SetSolver(tendon, "friction", model_.tendon_solref_fri, model_.tendon_solimp_fri, index);
      }
      for (const Drive& drive : hand_.drives()) {
        if (drive.pulled_tendon >= 0) continue;
        if (std::ranges::find(drive.cables, index, &Cable::tendon) == drive.cables.end()) continue;
        tendon.Set("stiffness", "0");
        tendon.Set("damping", "0");
      }
    }
  }

  void VisitAssets(MjcfElement& section) {
    const bool strips = CompilerSetting(root_, "strippath") == "true";
    for (MjcfElement& asset : section.children) {
      const char* const key = asset.name == "texture" ? "texturedir" : "meshdir";
      std::string folder = CompilerSetting(root_, key);
      if (folder.empty()) folder = CompilerSetting(root_, "assetdir");
      for (auto& [attribute, value] : asset.attributes) {
        if (!attribute.starts_with("file")) continue;
        const fs::path given = strips ? fs::path(value).filename() : fs::path(value);
        const fs::path target = TargetOf(hand_.file().parent_path() / folder / given);
        const bool is_named = asset.Find("name") != nullptr;
        value = target.string();
        if (is_named || asset.name == "texture") continue;
        asset.Set("name", given.stem().string());  // that which it had
        break;                                     // the list of attributes has changed
      }
    }
  }

  /// A new name for each file: two folders can have files of the same name.
  fs::path TargetOf(const fs::path& source) {
    const auto known = std::ranges::find(assets_, source, &ModelAsset::source);
    if (known != assets_.end()) return known->target;
    fs::path target = asset_folder_ / source.filename();
    for (int number = 2; std::ranges::count(assets_, target, &ModelAsset::target) > 0; ++number) {
      target = asset_folder_ / fmt::format("{}_{}", number, source.filename().string());
    }
    assets_.push_back({source, target});
    return target;
  }

  /// See FirmConstraints().
  void HoldConstraints() {
    int index = 0;
    for (MjcfElement& section : root_.children) {
      if (section.name != "equality") continue;
      for (MjcfElement& one : section.children) {
        if (index < model_.neq && (one.name == "connect" || one.name == "weld")) {
          SetSolver(one, "", model_.eq_solref, model_.eq_solimp, index);
        }
        ++index;
      }
    }
  }

  static void SetSolver(MjcfElement& element, const std::string& ending, const mjtNum* solref,
                        const mjtNum* solimp, int index) {
    element.Set("solref" + ending, Numbers({solref + std::ptrdiff_t{mjNREF} * index, mjNREF}));
    element.Set("solimp" + ending, Numbers({solimp + std::ptrdiff_t{mjNIMP} * index, mjNIMP}));
  }

  /// force = gain ctrl + bias[0] + bias[1] length + bias[2] d(length)/dt
  struct Actuator {
    std::string name;
    const char* target_kind;
    std::string target;
    double gain;
    std::array<double, 3> bias;
    double least;  // force or torque
    double most;
  };

  static void Add(MjcfElement& section, const Actuator& actuator, double half_travel_rad) {
    MjcfElement& general = AddChild(section, "general");
    general.Set("name", actuator.name);
    general.Set(actuator.target_kind, actuator.target);
    general.Set("gear", "1");
    general.Set("dyntype", "none");
    general.Set("gaintype", "fixed");
    general.Set("gainprm", fmt::format("{}", actuator.gain));
    general.Set("biastype", "affine");
    general.Set("biasprm", Numbers(actuator.bias));
    general.Set("ctrllimited", "true");
    general.Set("ctrlrange", Numbers(std::array{-half_travel_rad, half_travel_rad}));
    general.Set("forcelimited", "true");
    general.Set("forcerange", Numbers(std::array{actuator.least, actuator.most}));
  }

  void AddActuators() {
    MjcfElement& section = AddChild(root_, "actuator");
    for (const Drive& drive : hand_.drives()) {
      const double half_travel_rad = 0.5 * drive.numbers.travel_deg * kRadPerDeg;
      constexpr double kFarRad = 1e6;
      const double stall_nm = ComputeServoTorque(drive.servo, kFarRad, 0.0, 0.0).torque_nm;
      for (const Cable& cable : drive.cables) {
        const double stiffness = cable.cord.stiffness_n_m;
        Add(section,
            {.name = cable.name,
             .target_kind = "tendon",
             .target = cable.name,
             .gain = -stiffness * cable.sense * drive.drum_radius_m,
             .bias = {stiffness * cable.natural_length_m, -stiffness, -cable.cord.damping_n_s_m},
             .least = -stall_nm / drive.drum_radius_m,
             .most = 0.0},
            half_travel_rad);
      }
      if (!drive.has_shaft()) continue;
      double zero_rad = drive.shaft.zero_error_rad;
      for (const ShaftJoint& joint : drive.shaft.joints)
        zero_rad += joint.ratio * joint.reference_rad;
      const double gain = drive.servo.gain_nm_rad;
      const int actuator = mj_name2id(&model_, mjOBJ_ACTUATOR, drive.name.c_str());
      const bool has_tendon = model_.actuator_trntype[actuator] == mjTRN_TENDON;
      const int target = model_.actuator_trnid[std::ptrdiff_t{2} * actuator];
      Add(section,
          {.name = drive.name,
           .target_kind = has_tendon ? "tendon" : "joint",
           .target = mj_id2name(&model_, has_tendon ? mjOBJ_TENDON : mjOBJ_JOINT, target),
           .gain = gain,
           .bias = {gain * zero_rad, -gain, -drive.servo.damping_nm_s_rad},
           .least = -stall_nm,
           .most = stall_nm},
          half_travel_rad);
    }
  }

  void AddKeyframe() {
    std::vector<double> reference_rad;
    for (const HandJoint& joint : hand_.joints()) reference_rad.push_back(joint.reference_rad());
    const std::vector<double> whole =
        PostureOf(model_, hand_.joints(), reference_rad, hand_.followers());
    std::vector<double> kept;
    for (int joint = 0; joint < model_.njnt; ++joint) {
      if (IsSpool(model_.jnt_dofadr[joint])) continue;
      const int end = joint + 1 < model_.njnt ? model_.jnt_qposadr[joint + 1] : model_.nq;
      for (int i = model_.jnt_qposadr[joint]; i < end; ++i) kept.push_back(whole[i]);
    }
    MjcfElement& key = AddChild(AddChild(root_, "keyframe"), "key");
    key.Set("name", "middle");
    key.Set("qpos", Numbers(kept));
  }

  /// Angle of a site about the axis of a cylinder, from another site [rad], within -pi .. pi.
  static double AngleAbout(const mjData& data, int cylinder, int site, int from_site) {
    const auto angle = [&](int at) {
      mjtNum offset[3], in_frame[3];
      mju_sub3(offset, data.site_xpos + std::ptrdiff_t{3} * at,
               data.geom_xpos + std::ptrdiff_t{3} * cylinder);
      MulMatTVec3(in_frame, data.geom_xmat + std::ptrdiff_t{9} * cylinder, offset);
      return std::atan2(in_frame[1], in_frame[0]);
    };
    return std::remainder(angle(site) - angle(from_site), 2.0 * std::numbers::pi);
  }

  /// Since MuJoCo 4.0 a cable goes around a pulley as the line from guide through side site to
  /// guide does. Where a guide passes the place opposite of the side site, this line changes to the
  /// other side, and the cable with it.
  void NoteSideSites() {
    const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model_), &mj_deleteData);
    if (data == nullptr) throw RunError("not enough memory for the hand's model");
    struct Guide {
      int tendon;
      int cylinder;
      int site;
      int side_site;
      double angle_rad = 0.0;
    };
    std::vector<Guide> guides;
    for (const Drive& drive : hand_.drives()) {
      for (const Cable& cable : drive.cables) {
        const int first = model_.tendon_adr[cable.tendon];
        for (int at = first + 1; at + 1 < first + model_.tendon_num[cable.tendon]; ++at) {
          const int side = static_cast<int>(std::lround(model_.wrap_prm[at]));
          if (model_.wrap_type[at] != mjWRAP_CYLINDER || side < 0) continue;
          for (const int end : {at - 1, at + 1}) {
            guides.push_back({cable.tendon, model_.wrap_objid[at], model_.wrap_objid[end], side});
          }
        }
      }
    }
    constexpr int kPostures = 65;
    std::set<std::pair<int, int>> noted;
    for (int posture = 0; posture < kPostures; ++posture) {
      std::vector<double> angle_rad;
      for (const HandJoint& joint : hand_.joints()) {
        angle_rad.push_back(joint.min_rad +
                            posture * (joint.max_rad - joint.min_rad) / (kPostures - 1));
      }
      std::ranges::copy(PostureOf(model_, hand_.joints(), angle_rad, hand_.followers()),
                        data->qpos);
      mj_kinematics(&model_, data.get());
      for (Guide& guide : guides) {
        const double now_rad = AngleAbout(*data, guide.cylinder, guide.site, guide.side_site);
        const double turned_rad = std::abs(now_rad - std::exchange(guide.angle_rad, now_rad));
        if (posture == 0 || turned_rad < std::numbers::pi) continue;
        if (!noted.emplace(guide.tendon, guide.cylinder).second) continue;
        const char* const pulley = mj_id2name(&model_, mjOBJ_GEOM, guide.cylinder);
        notes_.push_back(fmt::format(
            "In MuJoCo 4.0 {} snaps off its pulley {}, whose side site lies opposite of a guide in "
            "some posture: put it in the middle of the arc.",
            mj_id2name(&model_, mjOBJ_TENDON, guide.tendon), pulley));
      }
    }
  }

  void Note() {
    NoteSideSites();
    const bool has_cables =
        std::ranges::any_of(hand_.drives(), [](const Drive& drive) { return !drive.has_shaft(); });
    notes_.push_back(fmt::format(
        "Not in the file: friction of {}, play, and the servos' delays, steps and speed limits.",
        has_cables ? "cables and their motors" : "the gears with their load"));
    if (has_cables) {
      notes_.emplace_back(
          "Spools stand at their controls at once, until a cable pulls with the stall torque.");
    }
    if (has_cables && hand_.config().assembly_error.moment_arm_percent > 0.0) {
      notes_.emplace_back("Not in the file: hand.assembly_error.moment_arm_percent.");
    }
    if (hand_.config().contact == Contact::kNone) {
      notes_.emplace_back("Contacts are off, as in the scenario (hand.contact: none).");
    }
  }

  /// Comments; "--" must not be in one.
  std::string Head(const std::string& name) const {
    std::string text = fmt::format(
        "The hand of {}, model {}, by gauntlet export.\n"
        "One actuator a cable, of the cable's name, or a motor without cables. Its control is the "
        "angle of the motor [rad]:\n0 with all joints in the middle of their ranges (keyframe "
        "'middle'), positive winds the flexor and pays out the extensor.\nGive both cables of a "
        "motor the same control. An actuator of a cable has a force [N] of 0 or less: it pulls.\n",
        name, hand_.Hash());
    for (const std::string& note : notes_) text += note + '\n';
    for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at)) {
      text.replace(at, 2, "- -");
    }
    return fmt::format("<!--\n{}-->\n", text);
  }

  const HandModel& hand_;
  const mjModel& model_;
  fs::path asset_folder_;
  MjcfElement root_;
  std::vector<ModelAsset> assets_;
  std::vector<std::string> notes_;
};

}  // namespace

ExportedMjcf ExportMjcf(const HandModel& hand, const std::string& name,
                        const fs::path& asset_folder) {
  return MjcfExporter(hand, asset_folder).Export(name);
}

}  // namespace gauntlet::sim
