// A study.db of a stranger, or damaged: one clear error, or the trials bit by bit as they were
// kept.
#include <sqlite3.h>
#include <unistd.h>

#include <bit>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/trial_table/study_database.h"
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

extern "C" void* __libc_malloc(std::size_t bytes);
extern "C" void* __libc_realloc(void* memory, std::size_t bytes);
extern "C" void __libc_free(void* memory);

namespace {

// SQLite is compiled without sanitizers, and asks for memory so often that theirs took a third of
// the time. The size of each piece stands before it.
constexpr int kHead = alignof(std::max_align_t);

void* Keep(void* memory, int bytes) {
  if (memory == nullptr) return nullptr;
  std::memcpy(memory, &bytes, sizeof(bytes));
  return static_cast<char*>(memory) + kHead;
}
void* HeadOf(void* piece) { return static_cast<char*>(piece) - kHead; }

void* Allocate(int bytes) {
  return Keep(__libc_malloc(static_cast<std::size_t>(bytes) + kHead), bytes);
}
void* Resize(void* piece, int bytes) {
  return Keep(__libc_realloc(HeadOf(piece), static_cast<std::size_t>(bytes) + kHead), bytes);
}
void Free(void* piece) { __libc_free(HeadOf(piece)); }
int SizeOf(void* piece) {
  int bytes = 0;
  std::memcpy(&bytes, HeadOf(piece), sizeof(bytes));
  return bytes;
}
int RoundUp(int bytes) { return (bytes + 7) & ~7; }
int Initialise(void* /*unused*/) { return SQLITE_OK; }
void ShutDown(void* /*unused*/) {}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  static const sqlite3_mem_methods kMemory = {Allocate, Free,       Resize,   SizeOf,
                                              RoundUp,  Initialise, ShutDown, nullptr};
  return sqlite3_config(SQLITE_CONFIG_MALLOC, &kMemory) == SQLITE_OK &&
                 sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0) == SQLITE_OK
             ? 0
             : 1;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const gauntlet::sim::Fuzzed fuzzed;
  fuzzed.Read(data, size);
  return 0;
}
