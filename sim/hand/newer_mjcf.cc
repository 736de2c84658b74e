#include "sim/hand/newer_mjcf.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

constexpr NewerMjcf kRefuse = NewerMjcf::kRefuse;
constexpr NewerMjcf kDrop = NewerMjcf::kDrop;
constexpr NewerMjcf kReplace = NewerMjcf::kReplace;

// Reasons to drop.
constexpr std::string_view kLook = "it changes the picture only";
constexpr std::string_view kSolver = "a setting of the solver";
constexpr std::string_view kServo = "the servos of hand.servo take the place of the actuator";
constexpr std::string_view kTorque =
    "the torque of a motor is hand.motor.stall_torque_nm or the actuator's own range";
constexpr std::string_view kSensor = "sensors of the model are not used";
constexpr std::string_view kForce = "it changes forces, not kinematics or inertia";
constexpr std::string_view kFile = "the file's name decides its format";

// Reasons to refuse.
constexpr std::string_view kMoves = "it moves bodies: write out what it stands for";
constexpr std::string_view kCouples = "it couples bodies in a way that 2.2.2 does not have";
constexpr std::string_view kInertia = "it changes the inertia";
constexpr std::string_view kMotor = "it is a motor that 2.2.2 does not have: use <motor>";

// Stands for every value of several numbers.
constexpr std::string_view kNumbers = "0 1";

constexpr std::string_view kSlack =
    "it is a spring with a slack range: give the tendon a limited range in its place";

constexpr NewerMjcfRow kRows[] = {
    {"", "frame", "", "", kRefuse, kMoves},
    {"", "replicate", "", "", kRefuse, kMoves},
    {"", "attach", "", "", kRefuse, kMoves},
    {"asset", "model", "", "", kRefuse, kMoves},
    {"", "flexcomp", "", "", kRefuse, kCouples},
    {"", "deformable", "", "", kRefuse, kCouples},
    {"", "plugin", "", "", kRefuse, kCouples},
    {"", "extension", "", "", kRefuse, kCouples},
    {"equality", "connect", "site1", "", kRefuse, kCouples},
    {"equality", "connect", "site2", "", kRefuse, kCouples},
    {"equality", "weld", "site1", "", kRefuse, kCouples},
    {"equality", "weld", "site2", "", kRefuse, kCouples},
    {"equality", "flex", "", "", kRefuse, kCouples},
    {"equality", "flexvert", "", "", kRefuse, kCouples},
    {"equality", "flexstrain", "", "", kRefuse, kCouples},
    {"", "dcmotor", "", "", kRefuse, kMotor},
    {"", "spatial", "armature", "", kRefuse, kInertia},
    {"", "fixed", "armature", "", kRefuse, kInertia},
    {"default", "tendon", "armature", "", kRefuse, kInertia},
    {"", "spatial", "springlength", kNumbers, kRefuse, kSlack},
    {"", "fixed", "springlength", kNumbers, kRefuse, kSlack},
    {"default", "tendon", "springlength", kNumbers, kRefuse, kSlack},
    {"", "mesh", "inertia", "legacy", kDrop, "2.2.2 computes nearly the same"},
    {"", "mesh", "inertia", "exact", kRefuse, "set exactmeshinertia of <compiler>"},
    {"", "mesh", "inertia", "", kRefuse, kInertia},

    {"", "compiler", "alignfree", "", kDrop, "it changes the frame of a free body only"},
    {"", "compiler", "saveinertial", "", kDrop, "a setting of saved files"},
    {"", "option", "ls_iterations", "", kDrop, kSolver},
    {"", "option", "ls_tolerance", "", kDrop, kSolver},
    {"", "option", "sdf_iterations", "", kDrop, kSolver},
    {"", "option", "sdf_initpoints", "", kDrop, kSolver},
    {"", "option", "ccd_iterations", "", kDrop, kSolver},
    {"", "option", "ccd_tolerance", "", kDrop, kSolver},
    {"", "option", "sleep_tolerance", "", kDrop, kSolver},
    {"", "option", "o_friction", "", kDrop, kSolver},
    {"", "option", "actuatorgroupdisable", "", kDrop, kServo},
    {"", "option", "integrator", "implicitfast", kReplace, "implicit"},
    {"option", "flag", "eulerdamp", "", kDrop, kSolver},
    {"option", "flag", "midphase", "", kDrop, kSolver},
    {"option", "flag", "nativeccd", "", kDrop, kSolver},
    {"option", "flag", "island", "", kDrop, kSolver},
    {"option", "flag", "autoreset", "", kDrop, kSolver},
    {"option", "flag", "invdiscrete", "", kDrop, kSolver},
    {"option", "flag", "sleep", "", kDrop, kSolver},
    {"option", "flag", "spring", "", kRefuse, "it changes forces of springs"},
    {"option", "flag", "damper", "", kRefuse, "it changes forces of dampers"},
    {"", "size", "memory", "", kDrop, kSolver},

    {"visual", "global", "orthographic", "", kDrop, kLook},
    {"visual", "global", "realtime", "", kDrop, kLook},
    {"visual", "global", "ellipsoidinertia", "", kDrop, kLook},
    {"visual", "global", "bvactive", "", kDrop, kLook},
    {"visual", "global", "cameraid", "", kDrop, kLook},
    {"visual", "global", "treedepth", "", kDrop, kLook},
    {"visual", "scale", "frustum", "", kDrop, kLook},
    {"visual", "rgba", "frustum", "", kDrop, kLook},
    {"visual", "rgba", "bv", "", kDrop, kLook},
    {"visual", "rgba", "bvactive", "", kDrop, kLook},
    {"", "mesh", "content_type", "", kDrop, kFile},
    {"", "mesh", "maxhullvert", "", kDrop, kForce},
    {"", "mesh", "octree_maxdepth", "", kDrop, kForce},
    {"", "mesh", "material", "", kDrop, kLook},
    {"", "texture", "content_type", "", kDrop, kFile},
    {"", "texture", "colorspace", "", kDrop, kLook},
    {"", "texture", "nchannel", "", kDrop, kLook},
    {"", "hfield", "content_type", "", kDrop, kFile},
    {"", "material", "metallic", "", kDrop, kLook},
    {"", "material", "roughness", "", kDrop, kLook},
    {"material", "layer", "", "", kDrop, kLook},
    {"", "light", "bulbradius", "", kDrop, kLook},
    {"", "light", "intensity", "", kDrop, kLook},
    {"", "light", "range", "", kDrop, kLook},
    {"", "light", "texture", "", kDrop, kLook},
    {"", "light", "type", "", kDrop, kLook},
    {"", "camera", "orthographic", "", kDrop, kLook},
    {"", "camera", "projection", "", kDrop, kLook},
    {"", "camera", "resolution", "", kDrop, kLook},
    {"", "camera", "output", "", kDrop, kLook},
    {"", "camera", "focal", "", kDrop, kLook},
    {"", "camera", "focalpixel", "", kDrop, kLook},
    {"", "camera", "principal", "", kDrop, kLook},
    {"", "camera", "principalpixel", "", kDrop, kLook},
    {"", "camera", "sensorsize", "", kDrop, kLook},

    {"", "body", "gravcomp", "", kDrop, kForce},
    {"", "body", "sleep", "", kDrop, kSolver},
    {"", "joint", "actuatorfrcrange", "", kDrop, kTorque},
    {"", "joint", "actuatorfrclimited", "", kDrop, kTorque},
    {"", "joint", "actuatorgravcomp", "", kDrop, kForce},
    {"", "freejoint", "align", "", kDrop, "it changes the frame of a free body only"},
    {"contact", "pair", "solreffriction", "", kDrop, kForce},
    {"default", "pair", "solreffriction", "", kDrop, kForce},
    {"", "spatial", "actuatorfrcrange", "", kDrop, kTorque},
    {"", "spatial", "actuatorfrclimited", "", kDrop, kTorque},
    {"", "fixed", "actuatorfrcrange", "", kDrop, kTorque},
    {"", "fixed", "actuatorfrclimited", "", kDrop, kTorque},
    {"default", "tendon", "actuatorfrcrange", "", kDrop, kTorque},
    {"default", "tendon", "actuatorfrclimited", "", kDrop, kTorque},

    {"", "position", "kv", "", kDrop, kServo},
    {"", "position", "dampratio", "", kDrop, kServo},
    {"", "position", "timeconst", "", kDrop, kServo},
    {"", "position", "inheritrange", "", kDrop, kServo},
    {"", "intvelocity", "kv", "", kDrop, kServo},
    {"", "intvelocity", "dampratio", "", kDrop, kServo},
    {"", "intvelocity", "inheritrange", "", kDrop, kServo},
    {"", "general", "actdim", "", kDrop, kServo},
    {"", "general", "actearly", "", kDrop, kServo},
    {"", "general", "dyntype", "filterexact", kDrop, kServo},
    {"", "general", "nsample", "", kDrop, kServo},
    {"", "general", "interp", "", kDrop, kServo},
    {"", "general", "delay", "", kDrop, kServo},
    {"", "position", "nsample", "", kDrop, kServo},
    {"", "position", "interp", "", kDrop, kServo},
    {"", "position", "delay", "", kDrop, kServo},
    {"", "motor", "nsample", "", kDrop, kServo},
    {"", "motor", "interp", "", kDrop, kServo},
    {"", "motor", "delay", "", kDrop, kServo},

    {"sensor", "camprojection", "", "", kDrop, kSensor},
    {"sensor", "jointactuatorfrc", "", "", kDrop, kSensor},
    {"sensor", "tendonactuatorfrc", "", "", kDrop, kSensor},
    {"sensor", "insidesite", "", "", kDrop, kSensor},
    {"sensor", "distance", "", "", kDrop, kSensor},
    {"sensor", "normal", "", "", kDrop, kSensor},
    {"sensor", "fromto", "", "", kDrop, kSensor},
    {"sensor", "contact", "", "", kDrop, kSensor},
    {"sensor", "tactile", "", "", kDrop, kSensor},
    {"sensor", "e_potential", "", "", kDrop, kSensor},
    {"sensor", "e_kinetic", "", "", kDrop, kSensor},
};

bool HasSeveralWords(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::size_t end = text.find_first_of(kBlanks);
  return text.find_first_not_of(kBlanks, end) != std::string_view::npos;
}

class Dropper {
 public:
  explicit Dropper(std::vector<std::string>& notes) : notes_(notes) {}

  void DropBelow(MjcfElement& element) {
    std::erase_if(element.children, [&](const MjcfElement& child) {
      const NewerMjcfRow* const row = RowOf(element, child, "", "");
      return row != nullptr && Drops(*row, child);
    });
    for (MjcfElement& child : element.children) {
      std::erase_if(child.attributes, [&](auto& attribute) {
        const NewerMjcfRow* const row = RowOf(element, child, attribute.first, attribute.second);
        if (row == nullptr || !Drops(*row, child)) return false;
        if (row->action == kDrop) return true;
        attribute.second = row->reason;
        return false;
      });
      DropBelow(child);
    }
  }

 private:
  static const NewerMjcfRow* RowOf(const MjcfElement& parent, const MjcfElement& element,
                                   std::string_view attribute, std::string_view value) {
    const auto found = std::ranges::find_if(kRows, [&](const NewerMjcfRow& row) {
      return (row.parent.empty() || row.parent == parent.name) && row.element == element.name &&
             row.attribute == attribute &&
             (row.value.empty() || row.value == value ||
              (row.value == kNumbers && HasSeveralWords(value)));
    });
    return found == std::end(kRows) ? nullptr : found;
  }

  /// True; a note the first time. Errors: UserError for what is refused.
  bool Drops(const NewerMjcfRow& row, const MjcfElement& element) {
    const std::string name =
        row.attribute.empty()
            ? fmt::format("element '{}'", row.element)
            : fmt::format(
                  "attribute '{}'{} of element '{}'", row.attribute,
                  row.value.empty() ? "" : fmt::format(" = '{}'", *element.Find(row.attribute)),
                  row.element);
    if (row.action == NewerMjcf::kRefuse) {
      throw UserError({.place = element.Place(),
                       .problem = fmt::format("{} is not in MuJoCo 2.2.2: {}", name, row.reason)});
    }
    if (dropped_.insert(&row).second) {
      notes_.push_back(row.action == kReplace
                           ? fmt::format("{}: {} is not in MuJoCo 2.2.2 and is replaced by '{}'",
                                         element.Place(), name, row.reason)
                           : fmt::format("{}: {} is not in MuJoCo 2.2.2 and is left out: {}",
                                         element.Place(), name, row.reason));
    }
    return true;
  }

  std::set<const NewerMjcfRow*> dropped_;
  std::vector<std::string>& notes_;
};

/// The folder of all assets became a setting of its own.
void WriteOutAssetFolder(MjcfElement& compiler) {
  const std::string* const found = compiler.Find("assetdir");
  if (found == nullptr) return;
  const std::string folder = *found;
  compiler.Remove("assetdir");
  for (const char* const kind : {"meshdir", "texturedir"}) {
    if (compiler.Find(kind) == nullptr) compiler.Set(kind, folder);
  }
}

}  // namespace

std::span<const NewerMjcfRow> NewerMjcfRows() { return kRows; }

void DropNewerMjcf(MjcfElement& root, std::vector<std::string>& notes) {
  Dropper(notes).DropBelow(root);
  bool says_limits = false;
  for (MjcfElement& child : root.children) {
    if (child.name != "compiler") continue;
    WriteOutAssetFolder(child);
    says_limits = says_limits || child.Find("autolimits") != nullptr;
  }
  // True since 3.0. Without it 2.2.2 refuses a range that does not say `limited`.
  if (says_limits) return;
  MjcfElement compiler;
  compiler.name = "compiler";
  compiler.file = root.file;
  compiler.line = root.line;
  compiler.Set("autolimits", "true");
  root.children.insert(root.children.begin(), std::move(compiler));
}

}  // namespace gauntlet::sim
