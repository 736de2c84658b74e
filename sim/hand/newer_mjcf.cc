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

/// With every element and every attribute that a row is for, blanks between them.
constexpr NewerMjcfRow kGroups[] = {
    {"", "frame replicate attach", "", "", kRefuse, kMoves},
    {"asset", "model", "", "", kRefuse, kMoves},
    {"", "flexcomp deformable plugin extension", "", "", kRefuse, kCouples},
    {"equality", "connect weld", "site1 site2", "", kRefuse, kCouples},
    {"equality", "flex flexvert flexstrain", "", "", kRefuse, kCouples},
    {"", "dcmotor", "", "", kRefuse, kMotor},
    {"", "spatial fixed", "armature", "", kRefuse, kInertia},
    {"default", "tendon", "armature", "", kRefuse, kInertia},
    {"", "spatial fixed", "springlength", kNumbers, kRefuse, kSlack},
    {"default", "tendon", "springlength", kNumbers, kRefuse, kSlack},
    {"", "mesh", "inertia", "legacy", kDrop, "2.2.2 computes nearly the same"},
    {"", "mesh", "inertia", "exact", kRefuse, "set exactmeshinertia of <compiler>"},
    {"", "mesh", "inertia", "", kRefuse, kInertia},

    {"", "compiler", "alignfree", "", kDrop, "it changes the frame of a free body only"},
    {"", "compiler", "saveinertial", "", kDrop, "a setting of saved files"},
    {"", "option",
     "ls_iterations ls_tolerance sdf_iterations sdf_initpoints ccd_iterations ccd_tolerance "
     "sleep_tolerance o_friction",
     "", kDrop, kSolver},
    {"", "option", "actuatorgroupdisable", "", kDrop, kServo},
    {"", "option", "integrator", "implicitfast", kReplace, "implicit"},
    {"option", "flag", "eulerdamp midphase nativeccd island autoreset invdiscrete sleep", "", kDrop,
     kSolver},
    {"option", "flag", "spring", "", kRefuse, "it changes forces of springs"},
    {"option", "flag", "damper", "", kRefuse, "it changes forces of dampers"},
    {"", "size", "memory", "", kDrop, kSolver},

    {"visual", "global", "orthographic realtime ellipsoidinertia bvactive cameraid treedepth", "",
     kDrop, kLook},
    {"visual", "scale rgba", "frustum", "", kDrop, kLook},
    {"visual", "rgba", "bv bvactive", "", kDrop, kLook},
    {"", "mesh", "content_type", "", kDrop, kFile},
    {"", "mesh", "maxhullvert octree_maxdepth", "", kDrop, kForce},
    {"", "mesh", "material", "", kDrop, kLook},
    {"", "texture", "content_type", "", kDrop, kFile},
    {"", "texture", "colorspace nchannel", "", kDrop, kLook},
    {"", "hfield", "content_type", "", kDrop, kFile},
    {"", "material", "metallic roughness", "", kDrop, kLook},
    {"material", "layer", "", "", kDrop, kLook},
    {"", "light", "bulbradius intensity range texture type", "", kDrop, kLook},
    {"", "camera",
     "orthographic projection resolution output focal focalpixel principal principalpixel "
     "sensorsize",
     "", kDrop, kLook},

    {"", "body", "gravcomp", "", kDrop, kForce},
    {"", "body", "sleep", "", kDrop, kSolver},
    {"", "joint", "actuatorfrcrange actuatorfrclimited", "", kDrop, kTorque},
    {"", "joint", "actuatorgravcomp", "", kDrop, kForce},
    {"", "freejoint", "align", "", kDrop, "it changes the frame of a free body only"},
    {"contact", "pair", "solreffriction", "", kDrop, kForce},
    {"default", "pair", "solreffriction", "", kDrop, kForce},
    {"", "spatial fixed", "actuatorfrcrange actuatorfrclimited", "", kDrop, kTorque},
    {"default", "tendon", "actuatorfrcrange actuatorfrclimited", "", kDrop, kTorque},

    {"", "position", "kv dampratio timeconst inheritrange", "", kDrop, kServo},
    {"", "intvelocity", "kv dampratio inheritrange", "", kDrop, kServo},
    {"", "general", "actdim actearly", "", kDrop, kServo},
    {"", "general", "dyntype", "filterexact", kDrop, kServo},
    {"", "general position motor", "nsample interp delay", "", kDrop, kServo},

    {"sensor",
     "camprojection jointactuatorfrc tendonactuatorfrc insidesite distance normal fromto contact "
     "tactile e_potential e_kinetic",
     "", "", kDrop, kSensor},
};

std::vector<std::string_view> Names(std::string_view text) {
  std::vector<std::string_view> names;
  for (std::size_t end; (end = text.find(' ')) != std::string_view::npos;) {
    names.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  names.push_back(text);
  return names;
}

std::vector<NewerMjcfRow> EachRow() {
  std::vector<NewerMjcfRow> rows;
  for (NewerMjcfRow row : kGroups) {
    const std::vector<std::string_view> attributes = Names(row.attribute);
    for (const std::string_view element : Names(row.element)) {
      row.element = element;
      for (const std::string_view attribute : attributes) {
        row.attribute = attribute;
        rows.push_back(row);
      }
    }
  }
  return rows;
}

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
    const auto found = std::ranges::find_if(NewerMjcfRows(), [&](const NewerMjcfRow& row) {
      return (row.parent.empty() || row.parent == parent.name) && row.element == element.name &&
             row.attribute == attribute &&
             (row.value.empty() || row.value == value ||
              (row.value == kNumbers && HasSeveralWords(value)));
    });
    return found == NewerMjcfRows().end() ? nullptr : &*found;
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

std::span<const NewerMjcfRow> NewerMjcfRows() {
  static const std::vector<NewerMjcfRow> kRows = EachRow();
  return kRows;
}

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
