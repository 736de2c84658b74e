#include "sim/results/runs.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <utility>

#include "sim/base/text.h"
#include "sim/results/answer_files.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
constexpr int kDeepest = 3;
constexpr std::size_t kMostLines = 40;

/// The first sentences, as many as fit into two lines or so.
std::string FirstSentences(const std::string& text) {
  constexpr std::size_t kMost = 300;
  if (text.size() <= kMost) return text;
  const std::size_t end = text.rfind(". ", kMost);
  return end == std::string::npos ? OneLine(text, kMost) : text.substr(0, end + 1);
}

/// The next lines up to an empty one, in one line.
std::string Paragraph(std::istream& text) {
  std::string paragraph;
  std::string line;
  for (std::size_t lines = 0; lines < kMostLines && std::getline(text, line); ++lines) {
    if (line.empty() && !paragraph.empty()) break;
    if (!line.empty()) paragraph += (paragraph.empty() ? "" : " ") + line;
  }
  return OneLine(FirstSentences(paragraph));
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

std::string SizeText(std::uintmax_t bytes) {
  const double size = static_cast<double>(bytes);
  if (size < 1e6) return fmt::format("{:.1f} kB", size / 1e3);
  return size < 1e9 ? fmt::format("{:.1f} MB", size / 1e6) : fmt::format("{:.1f} GB", size / 1e9);
}

}  // namespace gauntlet::sim
