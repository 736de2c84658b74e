#pragma once

#include <filesystem>
#include <string>

#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// Files of an output folder with the answer as a terminal of 80 columns has it, without and with
/// --verbose. `gauntlet show` prints them.
inline constexpr const char* kAnswerFile = "answer.txt";
inline constexpr const char* kVerboseAnswerFile = "answer_verbose.txt";

/// Writes both. Errors: RunError.
void WriteAnswer(const std::filesystem::path& folder, const ResultText& answer,
                 const ResultText& verbose);

struct KeptAnswer {
  std::string text;
  bool checked = false;  // by the manifest
};

/// Errors: UserError for a folder that has none, or another than its command wrote.
KeptAnswer ReadAnswer(const std::filesystem::path& folder, bool verbose);

}  // namespace gauntlet::sim
