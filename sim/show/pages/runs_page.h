#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/results/runs.h"

namespace gauntlet::sim {

/// A page without scripts over finished output folders: name, date, question, answer, size, and
/// jitter against delay as a small picture, from the numbers of each folder. Names link to the
/// pages of the folders, as seen from `folder`, where the page will stand.
std::string RunsPage(const std::vector<Run>& runs, const std::filesystem::path& folder);

/// Writes it, with its folder. Errors: UserError for a file that was read; RunError.
void WriteRunsPage(const std::vector<Run>& runs, const std::filesystem::path& page);

}  // namespace gauntlet::sim
