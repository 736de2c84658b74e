#include "sim/results/runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/results/answer_files.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
constexpr int kDeepest = 3;
constexpr std::size_t kMostLines = 40;
constexpr std::size_t kMostText = 2000;  // of a paragraph or the choices

/// As many whole sentences as fit into a few lines, the first in any case.
std::string FirstSentences(const std::string& text) {
  constexpr std::size_t kMost = 300;
  if (text.size() <= kMost) return text;
  std::size_t end = text.rfind(". ", kMost);
  if (end == std::string::npos) end = text.find(". ", kMost);
  return end == std::string::npos ? text : text.substr(0, end + 1);
}

/// The next lines up to an empty one, in one line.
std::string Paragraph(std::istream& text) {
  std::string paragraph;
  std::string line;
  for (std::size_t lines = 0; lines < kMostLines && std::getline(text, line); ++lines) {
    if (line.empty() && !paragraph.empty()) break;
    if (!line.empty()) paragraph += (paragraph.empty() ? "" : " ") + line;
  }
  return OneLine(FirstSentences(paragraph), kMostText);
}

/// Empty where the manifest cannot be read.
std::string ChoicesOf(const fs::path& folder) {
  try {
    return OneLine(Manifest(folder).choices(), kMostText);
  } catch (const UserError&) {
    return "";
  }
}

std::uintmax_t BytesIn(const fs::path& folder) {
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error)) bytes += entry.file_size(error);
  }
  return bytes;
}

std::string TimeText(std::time_t time) {
  std::tm local{};
  localtime_r(&time, &local);
  char text[32] = {};
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &local);
  return text;
}

void Find(const fs::path& folder, int depth, std::vector<std::pair<std::time_t, Run>>& found) {
  std::error_code error;
  struct stat status {};
  const fs::path answer = folder / kAnswerFile;
  if (fs::is_regular_file(folder / "manifest.json", error) && stat(answer.c_str(), &status) == 0 &&
      S_ISREG(status.st_mode)) {
    std::ifstream text(answer);
    Run run;
    run.folder = folder;
    run.question = Paragraph(text);
    const std::size_t mark = run.question.find('?');
    if (mark != std::string::npos) run.question.resize(mark + 1);
    run.choices = ChoicesOf(folder);
    run.answer = Paragraph(text);
    run.written = TimeText(status.st_mtime);
    run.bytes = BytesIn(folder);
    found.emplace_back(status.st_mtime, std::move(run));
  }
  if (depth == kDeepest) return;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error) && !entry.is_symlink(error)) Find(entry.path(), depth + 1, found);
  }
}

}  // namespace

std::vector<Run> FindRuns(const fs::path& root) {
  std::vector<std::pair<std::time_t, Run>> found;
  Find(root, 0, found);
  std::ranges::sort(found, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second.folder < b.second.folder;
  });
  std::vector<Run> runs;
  for (auto& [time, run] : found) runs.push_back(std::move(run));
  return runs;
}

std::vector<std::string> LinesOf(const Run& run) {
  std::vector<std::string> lines = {run.question, run.answer,
                                    fmt::format("{}, {}", run.written, SizeText(run.bytes))};
  if (!run.choices.empty()) lines.insert(lines.begin() + 1, run.choices);
  return lines;
}

std::string ChoicesText(const Choices& choices) {
  std::vector<std::string> words;
  const auto add = [&words](const char* option, const std::string& value) {
    words.push_back(fmt::format("{} {}", option, ShellWord(value)));
  };
  for (const std::string& filter : choices.added) add("--add", filter);
  for (const std::string& set : choices.set) add("--set", set);
  if (!choices.controllers.empty()) {
    add("--controllers", fmt::format("{}", fmt::join(choices.controllers, ",")));
  }
  if (!choices.priority.empty()) add("--priority", choices.priority);
  return fmt::format("{}", fmt::join(words, " "));
}

std::string SizeText(std::uintmax_t bytes) {
  const double size = static_cast<double>(bytes);
  if (size < 1e6) return fmt::format("{:.1f} kB", size / 1e3);
  return size < 1e9 ? fmt::format("{:.1f} MB", size / 1e6) : fmt::format("{:.1f} GB", size / 1e9);
}

}  // namespace gauntlet::sim
