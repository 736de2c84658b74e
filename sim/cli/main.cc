#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/signal_storage.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/completion.h"
#include "sim/cli/inspect_hand.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/standard_streams.h"
#include "sim/trial/external/program.h"

namespace {

namespace sim = gauntlet::sim;

constexpr int kRunFailed = 1;
constexpr int kUserMistake = 2;
constexpr int kReaderGone = 141;  // 128 + SIGPIPE, as shells have it

constexpr std::size_t kLongestMessage = 400;  // with the names of all kinds of filters

int Complain(const std::string& message, int exit_code) {
  sim::Say("{}\n", sim::OneLine("gauntlet: " + message, kLongestMessage));
  return exit_code;
}

constexpr auto kPurpose = R"(Gauntlet: a testbed for glove-driven, tendon-driven prosthetic hands.
Many controllers drive the same simulated hand with the same noisy glove signal.
The scores show which one to use.)";

constexpr auto kNotes = R"(
Example:
  gauntlet compare scenarios/door_opening.yaml --video
  gauntlet my_glove.csv

Exit codes: 0 done, 1 failed or a difference found, 2 wrong input.)";

/// Files of other people, which may name further ones.
bool ReadsFiles(const sim::Command& command) {
  using enum sim::Offer;
  return std::ranges::any_of(command.options, [](const sim::Option& option) {
    const sim::Offer offer = option.rules.offer;
    return option.is_argument() &&
           (offer == kFiles || offer == kFolders || offer == kScenarios || offer == kStudies);
  });
}

std::vector<sim::Command> Commands() {
  std::vector<sim::Command> commands = {
      sim::MakeInspectCommand(), sim::MakeCompareCommand(), sim::MakeTuneCommand(),
      sim::MakeRenderCommand(),  sim::MakeExportCommand(),  sim::MakeSweepCommand(),
      sim::MakeRobustCommand(),  sim::MakeRunCommand(),     sim::MakeShowCommand(),
      sim::MakeCleanCommand(),   sim::MakeReportCommand(),  sim::MakeDiffCommand(),
      sim::MakeFilterCommand(),  sim::MakeListCommand(),    sim::MakeDoctorCommand()};
  for (sim::Command& command : sim::OtherCommands()) commands.push_back(std::move(command));
  std::ranges::stable_sort(commands, {}, &sim::Command::group);
  for (sim::Command& command : commands) {
    if (!ReadsFiles(command)) continue;
    command.options.push_back(sim::Option(
        "--inside", sim::ReadOnlyInside, {.value = "DIR", .offer = sim::Offer::kFolders},
        "read no file outside this folder, except Gauntlet's own (for files of other people)"));
  }
  return commands;
}

/// The words of the command line; a recording in place of a command is to be inspected.
std::vector<char*> Words(const std::vector<sim::Command>& commands, int argc, char** argv) {
  static char inspect[] = "inspect";
  std::vector<char*> words(argv, argv + argc);
  const bool is_file = argc > 1 && argv[1][0] != '-' &&
                       std::ranges::find(commands, std::string_view(argv[1]),
                                         &sim::Command::name) == commands.end() &&
                       (sim::IsHandFile(argv[1]) || sim::IsRecordingFile(argv[1])) &&
                       std::filesystem::exists(argv[1]);
  if (is_file) words.insert(words.begin() + 1, inspect);
  return words;
}

/// At the end of a command, whatever its end is: a warning of each program that left processes.
struct TellsWhoWasLeft {
  TellsWhoWasLeft() = default;
  TellsWhoWasLeft(const TellsWhoWasLeft&) = delete;
  TellsWhoWasLeft& operator=(const TellsWhoWasLeft&) = delete;
  ~TellsWhoWasLeft() {
    for (const std::string& line : sim::TakeLeftProcesses())
      sim::Say("gauntlet: warning: {}\n", line);
  }
};

int Run(int argc, char** argv) {
  const std::vector<sim::Command> commands = Commands();
  if (argc > 1 && std::string_view(argv[1]) == "--complete") {  // what shells ask
    sim::PrintText(sim::Completions(commands, {argv + 2, argv + argc}));
    return 0;
  }
  std::vector<char*> words = Words(commands, argc, argv);
  const sim::Command* command =
      sim::ReadCommandLine({"gauntlet", kPurpose, {}, {}, kNotes}, commands,
                           static_cast<int>(words.size()), words.data());
  int exit_code = 0;
  try {
    const TellsWhoWasLeft tells;
    if (command != nullptr) command->run();
  } catch (const sim::ExitCode& answer) {
    exit_code = answer.value;
  }
  sim::CheckOutput();
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  sim::OpenStandardStreams();
  sim::CatchSignals();
  // Trial by trial the same megabytes are asked for and freed. To get them from the system each
  // time, zeroed page by page, took a fifth of trials of 1 s, and a third of those of 94 s without
  // a hand. So what a thread frees is kept up to what signals may have on the heap, of which one of
  // 94 s needs nearly all; what is longer than a signal there goes back at once.
  constexpr std::size_t kHeapBytes = 256 << 20;
  sim::SignalStorageLimits limits = sim::GetSignalStorageLimits();
  limits.all_on_heap_bytes = kHeapBytes;
  limits.resident_bytes = std::size_t{96} << 20;  // with a long recording, below 200 MB in all
  sim::SetSignalStorageLimits(limits);
  mallopt(M_MMAP_THRESHOLD, static_cast<int>(limits.longest_on_heap_bytes));
  mallopt(M_TRIM_THRESHOLD, kHeapBytes);
  try {
    return Run(argc, argv);
  } catch (const sim::Cancelled& cancelled) {
    const std::string kept = cancelled.kept.empty() ? "" : "; " + cancelled.kept;
    return Complain(std::string(sim::kInterrupted) + kept, sim::ExitCodeOfStop());
  } catch (const sim::ReaderGone&) {
    return kReaderGone;
  } catch (const sim::UserError& error) {
    return Complain(error.what(), kUserMistake);
  } catch (const gauntlet::controller::SettingError& error) {
    return Complain(error.what(), kUserMistake);
  } catch (const std::bad_alloc&) {
    return Complain(
        "not enough memory; a shorter glove.motion.duration_s, a lower glove.rate_hz or fewer "
        "--jobs need less",
        kRunFailed);
  } catch (const std::exception& error) {
    return Complain(error.what(), kRunFailed);
  }
}
