#include "sim/hand/mjcf_reader.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/hand/mjcf_element.h"
#include "sim/hand/mujoco_versions.h"
#include "sim/hand/newer_mjcf.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// The attributes of geoms by class: those of the class, else of the one around it.
class GeomClasses {
 public:
  explicit GeomClasses(const MjcfElement& root) {
    for (const MjcfElement& section : root.children) {
      if (section.name == "default") Add(section, "");
    }
  }

  /// Value of an attribute of a geom in a body of class `body_class`; empty if nothing sets it.
  std::string ValueOf(const MjcfElement& geom, std::string_view attribute,
                      const std::string& body_class) const {
    if (const std::string* const own = geom.Find(attribute)) return *own;
    const std::string* const own_class = geom.Find("class");
    std::string name = own_class != nullptr ? *own_class : body_class.empty() ? kMain : body_class;
    for (auto found = classes_.find(name); found != classes_.end();
         found = classes_.find(found->second.parent)) {
      const auto value = found->second.values.find(std::string(attribute));
      if (value != found->second.values.end()) return value->second;
    }
    return {};
  }

 private:
  static constexpr const char* kMain = "main";
  struct Class {
    std::string parent;
    std::map<std::string, std::string> values;
  };

  void Add(const MjcfElement& section, const std::string& parent) {
    const std::string* const given = section.Find("class");
    const std::string name = parent.empty() ? kMain : given == nullptr ? "" : *given;
    Class& one = classes_[name];
    one.parent = parent;
    for (const MjcfElement& child : section.children) {
      if (child.name == "geom") {
        for (const auto& [attribute, value] : child.attributes) one.values[attribute] = value;
      }
    }
    for (const MjcfElement& child : section.children) {
      if (child.name == "default") Add(child, name);
    }
    if (parent.empty() && given != nullptr && *given != kMain) {
      classes_[*given] = {.parent = kMain, .values = {}};
    }
  }

  std::map<std::string, Class> classes_;
};

bool IsZero(const std::string& number) {
  return !number.empty() && controller::ParseNumber(number) == 0.0;
}

class MissingMeshes {
 public:
  MissingMeshes(MjcfElement& root, std::vector<std::string>& notes)
      : root_(root), notes_(notes), classes_(root) {}

  bool LeaveOut() {
    FindFiles();
    if (files_.empty()) return false;
    if (!meshes_.empty()) {
      for (MjcfElement& section : root_.children) {
        if (section.name == "worldbody") VisitBody(section, "", true);
      }
    }
    if (!textures_.empty()) ForgetTextures(root_);
    constexpr std::size_t kMostNames = 3;
    const std::vector<std::string> first(
        files_.begin(), std::next(files_.begin(), std::min(kMostNames, files_.size())));
    notes_.push_back(
        fmt::format("{}: {} file{} missing ({}{}): {} geom{} left out{}", root_.file.string(),
                    files_.size(), files_.size() == 1 ? " is" : "s are", fmt::join(first, ", "),
                    files_.size() > kMostNames ? ", .." : "", geoms_, geoms_ == 1 ? "" : "s",
                    touching_ == 0 ? "" : fmt::format(", {} of which could touch", touching_)));
    return touching_ > 0;
  }

 private:
  bool IsMissing(const std::string& file, const std::string& folder) const {
    const fs::path name =
        CompilerSetting(root_, "strippath") == "true" ? fs::path(file).filename() : fs::path(file);
    std::error_code unused;
    return !fs::exists(root_.file.parent_path() / folder / name, unused);
  }

  /// Takes the assets without a file out of the model.
  void FindFiles() {
    const std::string mesh_folder = CompilerSetting(root_, "meshdir");
    const std::string picture_folder = CompilerSetting(root_, "texturedir");
    for (MjcfElement& section : root_.children) {
      if (section.name != "asset") continue;
      std::erase_if(section.children, [&](const MjcfElement& asset) {
        const std::string* const file = asset.Find("file");
        const bool mesh = asset.name == "mesh" || asset.name == "skin";
        if (file == nullptr || (!mesh && asset.name != "texture")) return false;
        if (!IsMissing(*file, mesh ? mesh_folder : picture_folder)) return false;
        const std::string* const name = asset.Find("name");
        (mesh ? meshes_ : textures_).insert(name ? *name : fs::path(*file).stem().string());
        files_.insert(*file);
        return true;
      });
    }
  }

  /// `fixed`: what carries the body cannot move.
  void VisitBody(MjcfElement& body, const std::string& outer_class, bool fixed) {
    const std::string* const child_class = body.Find("childclass");
    const std::string body_class = child_class == nullptr ? outer_class : *child_class;
    const bool stays = fixed && std::ranges::none_of(body.children, [](const MjcfElement& child) {
                         return child.name == "joint" || child.name == "freejoint";
                       });
    const bool has_inertia =
        stays || (CompilerSetting(root_, "inertiafromgeom") != "true" &&
                  std::ranges::count(body.children, "inertial", &MjcfElement::name) > 0);
    std::erase_if(body.children, [&](const MjcfElement& geom) {
      if (geom.name != "geom") return false;
      const auto value = [&](std::string_view attribute) {
        return classes_.ValueOf(geom, attribute, body_class);
      };
      const std::string mesh = value("mesh");
      if (!meshes_.contains(mesh)) return false;
      const std::string type = value("type");
      const std::string mass = value("mass");
      const bool massless = mass.empty() ? IsZero(value("density")) : IsZero(mass);
      if (!has_inertia && !massless) {
        const std::string* const name = body.Find("name");
        throw UserError({.place = geom.Place(),
                         .problem = fmt::format(
                             "the file of mesh '{}' is missing, and the mass of body '{}' comes "
                             "from it: give the file, or the body an <inertial>",
                             Shown(mesh), name == nullptr ? "" : Shown(*name))});
      }
      if (type != "mesh") {
        throw UserError(
            {.place = geom.Place(),
             .problem = fmt::format("the file of mesh '{}' is missing, and the size of "
                                    "this {} comes from it",
                                    Shown(mesh), type.empty() ? "sphere" : Shown(type))});
      }
      ++geoms_;
      if (!IsZero(value("contype")) || !IsZero(value("conaffinity"))) ++touching_;
      return true;
    });
    for (MjcfElement& child : body.children) {
      if (child.name == "body") VisitBody(child, body_class, stays);
    }
  }

  void ForgetTextures(MjcfElement& element) {
    const std::string* const texture = element.Find("texture");
    if (element.name == "material" && texture != nullptr && textures_.contains(*texture)) {
      element.Remove("texture");
    }
    for (MjcfElement& child : element.children) ForgetTextures(child);
  }

  MjcfElement& root_;
  std::vector<std::string>& notes_;
  GeomClasses classes_;
  std::set<std::string> files_, meshes_, textures_;
  int geoms_ = 0;
  int touching_ = 0;
};

/// Leaves out meshes and pictures whose files are missing, with the geoms and the materials that
/// show them. Possible where no mass comes from such a geom: its body has an <inertial> or
/// cannot move, or its own mass or density is 0. Adds sentences to `notes`. `root`: a
/// whole model, without includes.
/// Returns whether a geom that can touch was left out.
/// Errors: UserError with the place of a geom that gives its body mass.
bool LeaveOutMissingMeshes(MjcfElement& root, std::vector<std::string>& notes) {
  return MissingMeshes(root, notes).LeaveOut();
}

void AddUpMeshesWithSigns(MjcfElement& root) {
  if (kIsReference) {
    MjcfElement& compiler = root.children.emplace_back();  // the last of them counts
    compiler.name = "compiler";
    compiler.Set("exactmeshinertia", "true");
    return;
  }
  for (MjcfElement& section : root.children) {
    for (MjcfElement& asset : section.children) {
      if (section.name == "asset" && asset.name == "mesh") asset.Set("inertia", "exact");
    }
  }
}

namespace fs = std::filesystem;

/// Puts the children of included files in the place of the <include>.
void InsertIncludes(MjcfElement& element, const fs::path& folder, std::set<fs::path>& included) {
  std::vector<MjcfElement> children;
  for (MjcfElement& child : element.children) {
    if (child.name != "include") {
      InsertIncludes(child, folder, included);
      children.push_back(std::move(child));
      continue;
    }
    const std::string* const name = child.Find("file");
    if (name == nullptr) {
      throw UserError({.place = child.Place(), .problem = "element 'include' has no file"});
    }
    const fs::path file = folder / *name;
    if (!included.insert(file.lexically_normal()).second) {
      throw UserError({.place = child.Place(),
                       .problem = fmt::format("'{}' is included a second time", Shown(*name))});
    }
    MjcfElement root = ReadMjcf(file);
    InsertIncludes(root, folder, included);
    std::move(root.children.begin(), root.children.end(), std::back_inserter(children));
  }
  element.children = std::move(children);
}

}  // namespace

std::string CompilerSetting(const MjcfElement& root, std::string_view attribute) {
  std::string value;
  for (const MjcfElement& section : root.children) {
    if (section.name != "compiler") continue;
    if (const std::string* const found = section.Find(attribute)) value = *found;
  }
  return value;
}

ReadableMjcf ReadModelText(const fs::path& model, bool exact_meshes) {
  ReadableMjcf readable;
  readable.root = ReadMjcf(model);
  MjcfElement& root = readable.root;
  if (root.name == "mujoco") {
    std::set<fs::path> included = {model.lexically_normal()};
    InsertIncludes(root, model.parent_path(), included);
    if (kIsReference) DropNewerMjcf(root, readable.notes);
    if (exact_meshes) AddUpMeshesWithSigns(root);
    readable.lacks_contact_shapes = LeaveOutMissingMeshes(root, readable.notes);
  }
  // Names of other people's files become lines of a terminal and comments of a scenario.
  constexpr std::size_t kLongest = 500;
  for (std::string& note : readable.notes) note = OneLine(note, kLongest);
  return readable;
}

}  // namespace gauntlet::sim
