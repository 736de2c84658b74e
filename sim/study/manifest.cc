#include "sim/study/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/study/fast_hash.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kName = "manifest.json";
/// Raised whenever the file changes.
constexpr int kFormat = 1;

/// How the checksums of a manifest are made.
struct Checksum {
  std::string_view name;
  std::string (*of_file)(const fs::path&);
};
/// That of new manifests, then what those up to version 0.2.0 have.
constexpr Checksum kChecksums[] = {{"XXH64", FastHashOfFile}, {"FNV-1a, 64 bits", HashOfFile}};

struct Content {
  bool finished = false;
  Checksum checksum = kChecksums[0];
  std::map<std::string, FileMark> files;
};

FileMark MarkOf(const fs::path& file) {
  return {.bytes = fs::file_size(file), .checksum = kChecksums[0].of_file(file)};
}

/// The same files, the same name of the run.
std::string RunOf(const std::map<std::string, FileMark>& files) {
  Hash hash;
  for (const auto& [name, mark] : files) {
    hash.Add(fmt::format("{} {} {}\n", name, mark.bytes, mark.checksum));
  }
  return hash.Text();
}

void WriteManifest(const fs::path& folder, const Content& content) {
  Json json;
  json["format"] = kFormat;
  json["gauntlet_version"] = GAUNTLET_VERSION;
  json["finished"] = content.finished;
  if (content.finished) {
    json["run"] = RunOf(content.files);
    json["checksum"] = content.checksum.name;
    for (const auto& [name, mark] : content.files) {
      json["files"][name] = {{"bytes", mark.bytes}, {"checksum", mark.checksum}};
    }
  }
  WriteFileAtomically(folder / kName, json.dump(2) + "\n");
}

/// Nothing if there is no such file. Errors: what nlohmann::json throws; UserError.
std::optional<Content> Read(const fs::path& folder) {
  const fs::path file = folder / kName;
  std::error_code ignored;
  if (const auto status = fs::status(file, ignored);
      fs::exists(status) && !fs::is_regular_file(status)) {
    throw UserError({.place = file.string(), .problem = "is not a regular file"});
  }
  std::ifstream text(file);
  if (!text) return std::nullopt;
  const Json json = Json::parse(text);
  const auto of_another = [&file] {
    return UserError({.place = file.string(),
                      .problem = "is of another version of Gauntlet; run the same command again"});
  };
  if (json.at("format").get<int>() != kFormat) throw of_another();
  Content content;
  content.finished = json.at("finished").get<bool>();
  if (!content.finished) return content;
  const auto checksum =
      std::ranges::find(kChecksums, json.at("checksum").get<std::string>(), &Checksum::name);
  if (checksum == std::end(kChecksums)) throw of_another();
  content.checksum = *checksum;
  for (const auto& [name, mark] : json.at("files").items()) {
    content.files[name] = {.bytes = mark.at("bytes").get<std::uintmax_t>(),
                           .checksum = mark.at("checksum").get<std::string>()};
  }
  return content;
}

/// Of which scenario a folder's files are; nothing if that is not sure.
std::optional<FileMark> ScenarioOf(const fs::path& folder) {
  try {
    const std::optional<Content> content = Read(folder);
    if (!content || !content->finished) return std::nullopt;
    return content->files.at("scenario.resolved.yaml");
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Of another scenario, they would be taken for those of this one.
void RemoveLeftovers(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool table = name.starts_with("trace.") && name.ends_with(".csv");
    const bool robot =
        name.ends_with(".robot.yaml") || name.ends_with(".robot.h") || name.ends_with(".robot.txt");
    if (table || robot || name == "comparison.mp4") fs::remove(entry.path(), ignored);
  }
}

}  // namespace

Manifest::Manifest(fs::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  if (!fs::is_directory(folder_, ignored)) {
    throw UserError(
        {.place = folder_.empty() ? "''" : folder_.string(), .problem = "is not a folder"});
  }
  std::optional<Content> content;
  try {
    content = Read(folder_);
  } catch (const Json::exception&) {
    throw UserError({.place = (folder_ / kName).string(),
                     .problem = "is damaged; run the same command again, or remove it"});
  }
  if (!content) return;
  if (!content->finished) {
    throw UserError({.place = folder_.string(),
                     .problem =
                         "holds parts of two runs: one was stopped while it wrote its files; "
                         "run the same command again"});
  }
  exists_ = true;
  files_ = std::move(content->files);
  checksum_of_ = content->checksum.of_file;
}

fs::path Manifest::Checked(const std::string& name) const {
  fs::path file = folder_ / name;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    throw UserError(
        {.place = folder_.string(),
         .problem = fmt::format(
             "no {} there, must be the output folder of a finished gauntlet run or compare",
             name)});
  }
  if (!exists_) return file;
  const auto mark = files_.find(name);
  if (mark == files_.end() || mark->second.bytes != fs::file_size(file) ||
      mark->second.checksum != checksum_of_(file)) {
    throw UserError({.place = file.string(),
                     .problem = fmt::format("is not as its run wrote it (changed, damaged, or of "
                                            "another run); run the same command again, or remove "
                                            "{} if it is meant so",
                                            (folder_ / kName).string())});
  }
  return file;
}

OutputFiles::OutputFiles(const fs::path& folder) : folder_(folder), staging_(folder / "results") {}

void OutputFiles::Write(const std::function<void(const fs::path&)>& write) {
  try {
    write(path());
  } catch (const RunError& error) {
    std::string line = error.what();
    const std::string temporary = path().string();
    const std::size_t place = line.find(temporary);
    if (place != std::string::npos) line.replace(place, temporary.size(), folder_.string());
    throw RunError(line);
  }
}

void OutputFiles::Commit() {
  Content content{.finished = true, .files = {}};
  for (const auto& entry : fs::directory_iterator(staging_.path())) {
    content.files[entry.path().filename().string()] = MarkOf(entry.path());
  }
  const Unbroken unbroken;
  const std::optional<FileMark> earlier = ScenarioOf(folder_);
  WriteManifest(folder_, {.finished = false, .files = {}});
  if (!earlier || *earlier != content.files["scenario.resolved.yaml"]) RemoveLeftovers(folder_);
  staging_.MoveTo(folder_);
  WriteManifest(folder_, content);
}

}  // namespace gauntlet::sim
