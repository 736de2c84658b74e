#include "sim/hand/mjcf_reader.h"

#include <fmt/core.h>

#include <iterator>
#include <set>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/hand/missing_meshes.h"
#include "sim/hand/mjcf_element.h"
#include "sim/hand/newer_mjcf.h"

namespace gauntlet::sim {
namespace {

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

ReadableMjcf ReadModelText(const fs::path& model, bool exact_meshes) {
  MjcfElement root = ReadMjcf(model);
  ReadableMjcf readable;
  if (root.name == "mujoco") {
    std::set<fs::path> included = {model.lexically_normal()};
    InsertIncludes(root, model.parent_path(), included);
    DropNewerMjcf(root, readable.notes);
    if (exact_meshes) {
      MjcfElement& compiler = root.children.emplace_back();  // the last of them counts
      compiler.name = "compiler";
      compiler.Set("exactmeshinertia", "true");
    }
    readable.lacks_contact_shapes = LeaveOutMissingMeshes(root, readable.notes);
  }
  // Names of other people's files become lines of a terminal and comments of a scenario.
  constexpr std::size_t kLongest = 500;
  for (std::string& note : readable.notes) note = OneLine(note, kLongest);
  readable.text = MjcfText(root);
  return readable;
}

}  // namespace gauntlet::sim
