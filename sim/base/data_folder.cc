#include "sim/base/data_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "GAUNTLET_DATA_DIR";
constexpr const char* kData = "share/gauntlet";

fs::path folder_of_library;  // see SetDataFolder()

/// The folder of GAUNTLET_DATA_DIR; empty if the variable is not set.
fs::path FolderOfVariable() {
  const char* folder = std::getenv(kVariable);
  return folder == nullptr ? "" : folder;
}

/// The two places where `folder` may be, relative to the program. /proc/self/exe names the program
/// itself, also if a link started it.
/// Errors: RunError without /proc.
std::array<fs::path, 2> FoldersOfProgram(const char* folder) {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (unknown) {
    throw RunError(
        fmt::format("/proc/self/exe cannot be read, so Gauntlet does not find its own "
                    "files; {} may name their folder",
                    kVariable));
  }
  const fs::path above = program.parent_path().parent_path();
  return {above / folder, above.parent_path() / folder};
}

/// The path without links. So a file has one name, no matter how the program was started.
std::optional<fs::path> Find(const fs::path& name) {
  std::error_code missing;
  if (const fs::path folder = FolderOfVariable(); !folder.empty()) {
    const fs::path found = fs::canonical(folder / name, missing);
    return missing ? std::nullopt : std::optional(found);
  }
  if (!folder_of_library.empty()) {
    const fs::path found = fs::canonical(folder_of_library / name, missing);
    return missing ? std::nullopt : std::optional(found);
  }
  for (const fs::path& folder : FoldersOfProgram(kData)) {
    const fs::path found = fs::canonical(folder / name, missing);
    if (!missing) return found;
  }
  return std::nullopt;
}

}  // namespace

void SetDataFolder(const fs::path& folder) { folder_of_library = folder; }

fs::path DataFolder(const std::string& name) {
  if (const auto found = Find(name)) return *found;
  if (const fs::path folder = FolderOfVariable(); !folder.empty()) {
    throw UserError({.place = kVariable, .problem = "no folder " + (folder / name).string()});
  }
  const auto [beside, above] = FoldersOfProgram(kData);
  throw RunError(
      fmt::format("Gauntlet's own files are missing: no {} in {} nor in {}; {} may name "
                  "the folder that holds models and scenarios",
                  name, beside.string(), above.string(), kVariable));
}

fs::path OwnOrDataFile(const fs::path& file) {
  if (file.empty()) return file;
  std::error_code unreadable;
  if (file.is_absolute() || fs::exists(file, unreadable)) return file;
  return Find(file).value_or(file);
}

std::string ReadyFile(const std::string& given, const std::string& folder,
                      const std::string& noun) {
  std::error_code unreadable;
  const fs::path file = OwnOrDataFile(given);
  const bool is_name = file == fs::path(given).stem() && !given.empty();
  if (fs::exists(file, unreadable)) return file.string();
  if (!is_name) {
    std::vector<std::string> others;  // x.yaml for x.yml
    for (const auto* ending : {".yaml", ".yml"}) {
      const fs::path other = fs::path(given).replace_extension(ending);
      if (fs::exists(other, unreadable)) others.push_back(other.string());
    }
    throw UserError({.place = given, .problem = "no such file" + Suggestion(given, others)});
  }
  const fs::path ready = OwnOrDataFile(fs::path(folder) / (given + ".yaml"));
  if (fs::exists(ready, unreadable)) return ready.string();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(DataFolder(folder))) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  throw UserError(
      {.place = given, .problem = "no such file or " + noun + Suggestion(given, names)});
}

std::optional<fs::path> DataFile(const fs::path& name) {
  const fs::path normal = name.lexically_normal();
  if (normal.empty() || normal.is_absolute() || *normal.begin() == "..") return std::nullopt;
  return Find(normal);
}

std::string DataName(const fs::path& file) {
  for (const char* name : {"models", "scenarios", "studies"}) {
    const std::optional<fs::path> folder = Find(name);
    if (!folder) continue;
    const fs::path rest = file.lexically_relative(*folder);
    if (!rest.empty() && *rest.begin() != "..") return (name / rest).string();
  }
  return "";
}

std::string PathFrom(const fs::path& folder, const fs::path& file) {
  if (folder.empty() || !file.is_absolute()) return file.string();
  if (std::string name = DataName(file); !name.empty()) return name;
  const fs::path base = fs::absolute(folder / "").lexically_normal().parent_path();
  return file.lexically_relative(base).string();
}

fs::path OwnLibrary(const std::string& name) {
  const auto [beside, above] = FoldersOfProgram("lib/gauntlet");
  for (const fs::path& folder : {beside, above}) {
    if (std::error_code missing; fs::exists(folder / name, missing)) return folder / name;
  }
  throw RunError(fmt::format("a part of Gauntlet is missing: no {} in {} nor in {}", name,
                             beside.string(), above.string()));
}

}  // namespace gauntlet::sim
