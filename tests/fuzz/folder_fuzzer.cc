// A received output folder as `diff` reads it, and `render` without its trace: the first byte
// chooses whether the manifest or the scores are changed (see edited_copy.h). In a folder without a
// manifest the scores are read as they are. The fuzzers `scenario` and `trace` read the rest.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include "sim/answers/compare/study_difference.h"
#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "tests/fuzz/edited_copy.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

std::string ReadAll(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Scores of two seeds and two controllers.
std::string GoodScores() {
  StudyResult result;
  result.controller_names = {"raw", "mean"};
  result.row_names = {"index_mcp"};
  for (const int seed : {4, 5}) {
    SeedOutcome outcome{.seed = seed, .controllers = {}};
    for (const double score : {1.25, 0.5}) {
      TrialOutcome trial;
      trial.scores.summary.assign(Metrics().size(), seed * score);
      trial.scores.channels = {trial.scores.summary};
      outcome.controllers.push_back(std::move(trial));
    }
    result.seeds.push_back(std::move(outcome));
  }
  return ScoresCsv(result);
}

class Folder {
 public:
  Folder() {
    fs::create_directories(path_);
    OutputFiles files({.folder = path_});
    files.Write([this](const fs::path& folder) {
      std::ofstream(folder / "scores.csv") << scores_;
      std::ofstream(folder / "scenario.resolved.yaml")
          << "question: q\ncontrollers: {raw: {}, mean: {}}\n";
    });
    files.Commit();
    manifest_ = ReadAll(path_ / "manifest.json");
    good_ = ReadStudyFolder(path_);
  }
  ~Folder() { fs::remove_all(path_); }

  void Read(bool is_manifest, const std::uint8_t* data, std::size_t size) const {
    const fs::path manifest = path_ / "manifest.json";
    if (is_manifest) {
      std::ofstream(manifest, std::ios::binary) << EditedCopy(manifest_, data, size);
      std::ofstream(path_ / "scores.csv", std::ios::binary) << scores_;
    } else {
      fs::remove(manifest);
      std::ofstream(path_ / "scores.csv", std::ios::binary) << EditedCopy(scores_, data, size);
    }
    try {
      const StudyFolder folder = ReadStudyFolder(path_);
      for (const auto& metrics : folder.scores.summary) {
        if (metrics.size() != Metrics().size()) std::abort();
        for (const auto& seeds : metrics) {
          if (seeds.size() != folder.scores.seeds.size()) std::abort();
        }
      }
      const StudyDifference difference = CompareStudies(good_, folder);
      StudyDifferenceJson(good_, folder, difference).dump();
      if (is_manifest && !difference.Same()) std::abort();
    } catch (const UserError& error) {
      if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
  }

 private:
  const fs::path path_ = "/dev/shm/gauntlet_fuzz_folder_" + std::to_string(getpid());
  const std::string scores_ = GoodScores();
  std::string manifest_;
  StudyFolder good_;
};

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const gauntlet::sim::Folder folder;
  if (size > 0) folder.Read(data[0] % 2 == 0, data + 1, size - 1);
  return 0;
}
