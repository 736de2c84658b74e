#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gnu/libc-version.h>
#include <link.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "sim/base/child_process.h"
#include "sim/base/mathematics.h"
#include "sim/base/output_file.h"
#include "sim/base/output_folder.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/hand/hand_model.h"
#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

struct DoctorOptions {
  static constexpr auto kName = "doctor";
  static constexpr auto kPurpose = "Check this machine (for bug reports)";
  static constexpr auto kGroup = Group::kOther;

  // NOLINTNEXTLINE(readability-convert-member-functions-to-static): as all commands have it
  Options Rows() { return std::initializer_list<Options>{}; }

  static constexpr auto kNotes = R"(
"fix" marks what compare --video needs, "note" what other commands use.
Exit codes: 0 compare --video can run, 1 it cannot.

Example:
  gauntlet doctor
)";
};

enum class State { kOk, kNote, kFix };

/// A line of the screen.
struct Finding {
  State state = State::kOk;
  std::string text;
};

Finding Ok(std::string text) { return {State::kOk, std::move(text)}; }
Finding Note(std::string text) { return {State::kNote, std::move(text)}; }

/// The value of a line `KEY=VALUE` or `KEY : VALUE`, without quotes; empty if there is none.
std::string ValueIn(const fs::path& file, std::string_view key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t sign = line.find_first_of("=:");
    if (sign == std::string::npos || !line.starts_with(key)) continue;
    if (line.find_last_not_of(" \t", sign - 1) + 1 != key.size()) continue;
    const std::size_t first = line.find_first_not_of(" \t\"", sign + 1);
    if (first == std::string::npos) return "";
    return line.substr(first, line.find_last_not_of(" \t\"") - first + 1);
  }
  return "";
}

Finding CheckSystem() {
  const fs::path release = "/etc/os-release";
  const std::string name = ValueIn(release, "PRETTY_NAME");
  utsname kernel{};
  uname(&kernel);
  const std::string text =
      fmt::format("{}, Linux {} {}, glibc {}", name.empty() ? "unknown system" : name,
                  kernel.release, kernel.machine, gnu_get_libc_version());
  const std::string version = ValueIn(release, "VERSION_ID");
  const bool is_tested = ValueIn(release, "ID") == "debian" && (version == "12" || version == "13");
  return is_tested ? Ok(text) : Note(text + "; tested are Debian 12 and 13");
}

Finding CheckProcessor() {
  const std::string model = ValueIn("/proc/cpuinfo", "model name");
  const std::string text = fmt::format("{}{}{} processors", model, model.empty() ? "" : ", ",
                                       std::thread::hardware_concurrency());
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return Ok(text + ", FMA and AVX2");
  }
  return Note(text + "; no FMA or no AVX2: angles differ by up to 1e-9 rad from other machines");
#else
  return Note(text + "; not x86-64: angles may differ in the last bits from other machines");
#endif
}

Finding CheckProgram() {
  return Ok(fmt::format("gauntlet {}, compiler {}, mathematics {}", GAUNTLET_VERSION, __VERSION__,
                        HashOfMathematics()));
}

Finding CheckModel() {
  const HandModel hand{HandConfig{}};
  return Ok(fmt::format("{}, the hand has {} joints and {} motors", HandModel::EngineVersion(),
                        hand.joint_names().size(), hand.motor_names().size()));
}

/// OSMesa draws, libav encodes.
Finding CheckVideo() {
  LoadDrawingLibrary().open_context();
  const OutputFile file(fs::temp_directory_path() / "gauntlet-doctor.mp4");
  LoadDrawingLibrary().open_encoder(file, VideoFormat{});
  return Ok("OSMesa draws, libav has an encoder for H.264");
}

/// "avcodec 59.37.100" of a path to libavcodec.so.59.37.100, or libavcodec-1a2b3c4d.so.59.37.100 as
/// wheels name it; empty for libraries that cannot change results or formats.
std::string LibraryVersion(const fs::path& loaded) {
  static constexpr std::array<std::string_view, 12> kNames = {
      "OSMesa", "avcodec",   "avformat", "cairo",   "fmt",      "hdf5_serial",
      "matio",  "nlopt_cxx", "sqlite3",  "swscale", "yaml-cpp", "z"};
  std::error_code ignored;
  const std::string file = fs::canonical(loaded, ignored).filename().string();
  const auto ending = file.find(".so.");
  if (ending == std::string::npos) return "";
  constexpr std::size_t kHash = std::string_view("-1a2b3c4d").size();
  for (const std::string_view name : kNames) {
    const std::string before = fmt::format("lib{}", name);
    const std::size_t rest = ending - std::min(ending, before.size());
    if (!file.starts_with(before) || (rest != 0 && (rest != kHash || file[before.size()] != '-'))) {
      continue;
    }
    return fmt::format("{} {}", name, file.substr(ending + std::string_view(".so.").size()));
  }
  return "";
}

/// Versions in the names of the shared libraries that are loaded.
Finding CheckLibraries() {
  std::vector<std::string> versions;
  dl_iterate_phdr(
      [](dl_phdr_info* library, std::size_t, void* list) {
        const std::string version = LibraryVersion(library->dlpi_name);
        if (!version.empty()) static_cast<std::vector<std::string>*>(list)->push_back(version);
        return 0;
      },
      &versions);
  std::ranges::sort(versions);
  return Ok(fmt::format("{}", fmt::join(versions, ", ")));
}

Finding CheckOutputFolder() {
  const OutputFolder folder("out/doctor");
  const OutputFile file(folder.path() / "doctor.txt");
  return Ok(fmt::format("{} can be written", Shown(fs::absolute("out").string())));
}

/// Tries it in another process, so that this one keeps its priority.
Finding CheckRealTime() {
  ChildProcess child([] {
    const sched_param lowest{.sched_priority = 1};
    _exit(sched_setscheduler(0, SCHED_FIFO, &lowest) == 0 ? 0 : 1);
  });
  const std::optional<ChildEnd> end = child.Wait();
  if (end && end->signal == 0 && end->exit_code == 0) return Ok("SCHED_FIFO is allowed");
  return Note(
      "SCHED_FIFO is not allowed; a control loop needs rtprio in /etc/security/limits.conf");
}

Finding CheckProgramInPath(const std::string& name, const std::string& package,
                           const std::string& purpose) {
  if (const auto program = FindProgram(name)) return Ok(Shown(program->string()));
  return Note(fmt::format("not found; {} needs it: apt-get install {}", purpose, package));
}

struct Check {
  std::string name;
  std::function<Finding()> run;
  std::string remedy;  // if it fails
};

const std::vector<Check>& Checks() {
  static const std::vector<Check> kChecks = {
      {"system", CheckSystem, ""},
      {"processor", CheckProcessor, ""},
      {"program", CheckProgram, ""},
      {"MuJoCo", CheckModel, "install Gauntlet again, unset GAUNTLET_DATA_DIR"},
      {"output", CheckOutputFolder, "change to a folder that you may write"},
      {"video", CheckVideo, "install what is missing, or Gauntlet again"},
      {"libraries", CheckLibraries, ""},
      {"real time", CheckRealTime, ""},
      {"Chromium", [] { return CheckProgramInPath("chromium", "chromium", "a test of pages"); },
       ""},
      {"Slurm", [] { return CheckProgramInPath("sbatch", "slurm-client", "sweep --slurm"); }, ""},
  };
  return kChecks;
}

Finding Try(const Check& check) {
  try {
    return check.run();
  } catch (const std::exception& error) {
    return {State::kFix, fmt::format("{}: {}", OneLine(error.what()), check.remedy)};
  }
}

void Doctor(const DoctorOptions&) {
  bool can_run = true;
  for (const Check& check : Checks()) {
    const Finding finding = Try(check);
    const char* const state = finding.state == State::kOk     ? "ok"
                              : finding.state == State::kNote ? "note"
                                                              : "fix";
    Print("{:<5} {:<10} {}\n", state, check.name, finding.text);
    can_run = can_run && finding.state != State::kFix;
  }
  Print("{}\n", can_run ? "compare --video can run." : "compare --video cannot run.");
  if (!can_run) throw ExitCode{1};
}

}  // namespace

Command MakeDoctorCommand() { return MakeCommand(Doctor); }

}  // namespace gauntlet::sim
