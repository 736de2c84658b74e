// A study.db of a stranger, or damaged: one clear error, or the trials bit by bit as they were
// kept.
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include "sim/base/error.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/study/study_database.h"
#include "tests/fuzz/edited_copy.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

bool Same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

class Fuzzed {
 public:
  Fuzzed() {
    kept_.scores.summary.assign(Metrics().size(), 1.0 / 3.0);
    kept_.scores.summary[2] = std::numeric_limits<double>::quiet_NaN();
    kept_.scores.channels.assign(study_.rows.names.size(), kept_.scores.summary);
    kept_.untrusted_samples.assign(study_.channel_names().size(), 5);
    fs::remove(file_);
    StudyDatabase(file_, study_, identity_, kOptions).Keep(1, 0, kept_);
    std::ostringstream bytes;
    bytes << std::ifstream(file_, std::ios::binary).rdbuf();
    whole_ = bytes.str();
  }
  ~Fuzzed() { fs::remove(file_); }

  void Read(const std::uint8_t* data, std::size_t size) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << EditedCopy(whole_, data, size);
    try {
      StudyDatabase database(file_, study_, identity_, kOptions);
      if (database.TrialCount() < 0) std::abort();
      const auto found = database.Take(1, 0);
      if (found && !IsKept(*found)) std::abort();
      if (database.Take(1, 1)) std::abort();  // never was there
    } catch (const UserError&) {
    } catch (const RunError&) {
    }
  }

 private:
  bool IsKept(const TrialOutcome& found) const {
    return found.health.ok == kept_.health.ok &&
           found.untrusted_samples == kept_.untrusted_samples &&
           Same(found.scores.summary, kept_.scores.summary) &&
           std::ranges::equal(found.scores.channels, kept_.scores.channels, Same);
  }

  inline static const StudyDatabaseOptions kOptions = {.seeds = 2,
                                                       .patience = std::chrono::milliseconds(0)};
  const fs::path file_ = "/dev/shm/gauntlet_fuzz_" + std::to_string(getpid()) + ".db";
  const Study study_ =
      PrepareStudy(LoadScenario(GAUNTLET_SOURCE_DIR "/tests/support/three_joint_hand.yaml", {}));
  const StudyIdentity identity_ = IdentityOf(study_);
  TrialOutcome kept_;
  std::string whole_;
};

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const gauntlet::sim::Fuzzed fuzzed;
  fuzzed.Read(data, size);
  return 0;
}
