#pragma once

#include <string>
#include <vector>

#include "sim/answers/compare/study_folder.h"

namespace gauntlet::sim {

/// One page of several output folders: settings that differ, and the primary scores of every
/// controller side by side. A change is marked as in DifferenceText(), against the first folder.
/// Shapes: at least two folders.
std::string FoldersPage(std::vector<StudyFolder> folders);

}  // namespace gauntlet::sim
