#include "sim/base/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>

#include "sim/base/error.h"
#include "sim/base/fast_hash.h"
#include "sim/base/hash.h"
#include "sim/base/input_file.h"
#include "sim/base/json.h"
#include "sim/base/limited_text.h"
#include "sim/base/stop.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
constexpr const char* kName = "manifest.json";
constexpr const char* kScenario = "scenario.resolved.yaml";
/// Increased whenever the format of the file changes.
constexpr int kFormat = 1;

/// A checksum algorithm of manifests.
struct Checksum {
  std::string_view name;
  std::string (*of_file)(const fs::path&);
};
/// The algorithm of new manifests, then the one of versions up to 0.2.0.
constexpr Checksum kChecksums[] = {{"XXH64", FastHashOfFile}, {"FNV-1a, 64 bits", HashOfFile}};

struct Content {
  bool finished = false;
  std::string command = {};  // empty up to version 0.2.0
  std::string choices = {};
  Checksum checksum = kChecksums[0];
  std::map<std::string, FileMark> files = {};
};

FileMark MarkOf(const fs::path& file) {
  return {.bytes = fs::file_size(file), .checksum = kChecksums[0].of_file(file)};
}

/// Name of a run: the same for the same files.
std::string RunOf(const std::map<std::string, FileMark>& files) {
  Hash hash;
  for (const auto& [name, mark] : files) {
    hash.Add(fmt::format("{} {} {}\n", name, mark.bytes, mark.checksum));
  }
  return hash.Text();
}

void WriteManifest(const fs::path& file, const Content& content) {
  Json json;
  json["format"] = kFormat;
  json["gauntlet_version"] = GAUNTLET_VERSION;
  json["command"] = content.command;
  if (!content.choices.empty()) json["choices"] = content.choices;
  json["finished"] = content.finished;
  if (content.finished) json["run"] = RunOf(content.files);
  json["checksum"] = content.checksum.name;
  json["files"] = Json::object();
  for (const auto& [name, mark] : content.files) {
    json["files"][name] = {{"bytes", mark.bytes}, {"checksum", mark.checksum}};
  }
  OutputFile output(file, OutputFile::Replaces::kResult);
  output.Write(json.dump(2) + "\n");
  output.Commit();
}

/// None if the file does not exist. Errors: JsonError; UserError.
std::optional<Content> Read(const fs::path& file) {
  std::error_code ignored;
  if (const auto status = fs::status(file, ignored);
      fs::exists(status) && !fs::is_regular_file(status)) {
    throw UserError({.place = file.string(), .problem = "is not a regular file"});
  }
  if (!fs::exists(file, ignored)) return std::nullopt;
  const Json json = Json::parse(LimitedText(file, kMostManifestBytes));
  const auto of_another = [&file] {
    return UserError({.place = file.string(),
                      .problem = "is of another version of Gauntlet; run the same command again"});
  };
  if (json.at("format").get<int>() != kFormat) throw of_another();
  Content content;
  content.finished = json.at("finished").get<bool>();
  content.command = json.value("command", "").get<std::string>();
  content.choices = json.value("choices", "").get<std::string>();
  if (!json.contains("files")) return content;  // an unfinished manifest up to version 0.2.0
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

/// Manifest of a folder that is about to be written. A damaged manifest counts as unfinished.
/// Errors: UserError if the file is not a manifest of Gauntlet.
std::optional<Content> Earlier(const fs::path& file) {
  try {
    return Read(file);
  } catch (const std::exception&) {
    const Json json =
        Json::parse_or_discard(LimitedTextIfAny(file, kMostManifestBytes).value_or(""));
    if (!json.is_object() || json.empty() || json.contains("format")) return Content{};
    throw UserError({.place = file.string(),
                     .problem = "is no manifest of gauntlet; name another folder by --out"});
  }
}

bool IsSameScenario(const Content& earlier, const Content& now) {
  const auto of_earlier = earlier.files.find(kScenario);
  const auto of_now = now.files.find(kScenario);
  return earlier.finished && of_earlier != earlier.files.end() && of_now != now.files.end() &&
         of_earlier->second == of_now->second;
}

/// True for files that render, run --csv and export make from a finished folder.
bool IsMadeOfResults(const std::string& name) {
  const bool table = name.starts_with("trace.") && name.ends_with(".csv");
  const bool robot =
      name.ends_with(".robot.yaml") || name.ends_with(".robot.h") || name.ends_with(".robot.txt");
  return table || robot || name == "comparison.mp4" || name == "poster.png";
}

/// Removes files of an earlier run that would be mistaken for files of this run.
void RemoveLeftovers(const fs::path& folder, const Content& earlier, const Content& now) {
  std::vector<fs::path> leftovers;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (now.files.contains(name) || IsInput(entry.path())) continue;
    const auto file = earlier.files.find(name);
    const bool unchanged = file != earlier.files.end() && entry.is_regular_file(ignored) &&
                           MarkOf(entry.path()) == file->second;
    const bool derived = now.files.contains(kScenario) && IsMadeOfResults(name);
    if (unchanged || derived) leftovers.push_back(entry.path());
  }
  for (const fs::path& file : leftovers) fs::remove(file, ignored);
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
    content = Read(folder_ / kName);
  } catch (const JsonError&) {
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
  choices_ = std::move(content->choices);
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
  InputFile(file);
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

std::vector<fs::path> OwnFiles(const fs::path& folder) {
  std::optional<Content> content;
  try {
    content = Read(folder / kName);
  } catch (const JsonError&) {
    content.reset();
  }
  if (!content) {
    throw UserError({.place = folder.string(),
                     .problem = "has no manifest.json of gauntlet, must be an output folder"});
  }
  std::vector<fs::path> own;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_symlink() || !entry.is_regular_file()) continue;
    const auto file = content->files.find(name);
    const bool unchanged = file != content->files.end() &&
                           file->second.bytes == entry.file_size() &&
                           file->second.checksum == content->checksum.of_file(entry.path());
    const bool kept =
        name == kName || name == "study.db" || name == "study.db-wal" || name == "study.db-shm";
    const bool derived = IsMadeOfResults(name) && name.find(".robot.") == std::string::npos;
    if (unchanged || kept || derived) own.push_back(entry.path());
  }
  return own;
}

OutputFiles::OutputFiles(OutputPlan plan) : plan_(std::move(plan)) {
  const std::optional<Content> earlier = Earlier(plan_.folder / plan_.manifest);
  if (earlier && !earlier->command.empty() && earlier->command != plan_.command) {
    throw UserError({.place = plan_.folder.string(),
                     .problem = fmt::format("holds results of gauntlet {}, which stay; name "
                                            "another folder by --out",
                                            earlier->command)});
  }
  Check(plan_.results);
}

void OutputFiles::Check(const std::vector<std::string>& names) const {
  const std::optional<Content> earlier = Earlier(plan_.folder / plan_.manifest);
  for (const std::string& name : names) {
    const fs::path target = plan_.folder / name;
    const bool own = earlier && (!earlier->finished || earlier->files.contains(name));
    if (!own) RefuseInput(target);
    const bool is_editable = std::ranges::count(plan_.editable, name) > 0;
    if (is_editable && !plan_.force) RefuseEdited(target);
  }
}

void OutputFiles::Write(const std::function<void(const fs::path&)>& write) {
  const StagingFolder& staging = staging_.emplace(plan_.folder);
  try {
    write(staging.path());
  } catch (const RunError& error) {
    std::string line = error.what();
    const std::string temporary = staging.path().string();
    const std::size_t place = line.find(temporary);
    if (place != std::string::npos) line.replace(place, temporary.size(), plan_.folder.string());
    throw RunError(line);
  }
}

void OutputFiles::Commit() {
  Content content{.finished = true, .command = plan_.command, .choices = plan_.choices};
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(staging_->path())) {
    names.push_back(entry.path().filename().string());
    content.files[names.back()] = MarkOf(entry.path());
  }
  Check(names);
  const fs::path manifest = plan_.folder / plan_.manifest;
  const Unbroken unbroken;
  const std::optional<Content> earlier = Earlier(manifest);
  Content unfinished = content;
  unfinished.finished = false;
  if (earlier) unfinished.files.insert(earlier->files.begin(), earlier->files.end());
  WriteManifest(manifest, unfinished);
  if (earlier && !IsSameScenario(*earlier, content)) {
    RemoveLeftovers(plan_.folder, *earlier, content);
  }
  staging_->MoveUp();
  WriteManifest(manifest, content);
  staging_.reset();
}

}  // namespace gauntlet::sim
