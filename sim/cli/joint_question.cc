#include "sim/cli/joint_question.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/inspect/inspection_tables.h"
#include "sim/recordings/inspect/joint_answer.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/recordings/profile.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kWidth = 80;

/// The question with all that an answer needs: columns with their values, profiles, joints.
std::string QuestionText(const Inspection& inspection, const std::vector<Profile>& profiles) {
  ResultTable table = ColumnsTable(inspection, false);
  const std::vector<ResultRow> rows = std::exchange(table.rows, {});
  for (const std::size_t c : ColumnsToName(inspection)) table.rows.push_back(rows[c]);
  std::string text = fmt::format("{}: {}\n\n{}\n", OneLine(inspection.file),
                                 OneLine(inspection.question), TextOf(table, {}));
  std::size_t width = 0;
  for (const Profile& profile : profiles) width = std::max(width, profile.name.size());
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    text += fmt::format("{:>3}  {:<{}}  {}\n", i + 1, OneLine(profiles[i].name), width,
                        OneLine(profiles[i].device, kWidth));
  }
  if (!profiles.empty()) text += "\n";
  text += Wrapped(fmt::format("Joints: {}.", fmt::join(KnownChannelNames(), ", ")), kWidth) + "\n";
  return text +
         Wrapped(fmt::format("Answer with {}the joints of the columns in order, - for a column "
                             "that has none. Enter leaves the question open.",
                             profiles.empty() ? "" : "the number of a profile, or with "),
                 kWidth) +
         "\n";
}

/// Words between blanks and commas.
std::vector<std::string> WordsIn(std::string_view line) {
  constexpr std::string_view kBetween = " \t\r,;";
  std::vector<std::string> words;
  for (std::size_t begin = line.find_first_not_of(kBetween); begin != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBetween, end);
  }
  return words;
}

/// Errors: UserError for an answer that is no profile of the list, or no joints.
std::string MapOfAnswer(const std::vector<std::string>& words, const Inspection& inspection,
                        const std::vector<Profile>& profiles, InspectionOptions options) {
  const auto is_digit = [](char letter) { return letter >= '0' && letter <= '9'; };
  const bool is_number = words.size() == 1 && std::ranges::all_of(words.front(), is_digit);
  if (!is_number) return StarterMap(WithJoints(inspection, words));
  const auto number =
      controller::ParseWholeNumber(words.front(), 1, static_cast<std::int64_t>(profiles.size()));
  if (!number) {
    throw UserError(profiles.empty()
                        ? "no profile has this number of sensors"
                        : fmt::format("{} is no profile of the list, must be from 1 to {}",
                                      OneLine(words.front(), 20), profiles.size()));
  }
  options.joints.preset = profiles[static_cast<std::size_t>(*number - 1)].name;
  const Inspection by_profile = Inspect(inspection.file, options);
  if (!by_profile.question.empty()) throw UserError(by_profile.question);
  return StarterMap(by_profile);
}

}  // namespace

bool CanAsk() { return isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0; }

std::string AskForMap(const Inspection& inspection, const InspectionOptions& options) {
  EndAtSignals();  // while it waits, nothing is to be tidied
  const std::vector<Profile> profiles = ProfilesForColumns(inspection);
  SayText(QuestionText(inspection, profiles));
  for (;;) {
    SayText("> ");
    std::string line;
    if (!std::getline(std::cin, line)) {
      SayText("\n");
      return "";
    }
    const std::vector<std::string> words = WordsIn(line);
    if (words.empty()) return "";
    try {
      return MapOfAnswer(words, inspection, profiles, options);
    } catch (const UserError& error) {
      Say("{}\n", error.what());
    }
  }
}

}  // namespace gauntlet::sim
