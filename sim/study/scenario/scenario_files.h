#pragma once

#include <vector>

#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// The files that the scenario's gloves are made from (recordings, references, column maps) and
/// those of its programs, each once, with its hash as it is now. What is no regular file, as a
/// pipe, has no hash and is left out. Errors: as HashOfFile().
std::vector<NamedFile> FilesOf(const Scenario& scenario);

/// Leaves of every path its last name: for a scenario that is known by what is in its files.
void DropFolders(Scenario& scenario);
void DropFolders(NamedController& controller);

/// A file that is not what it was when the scenario was resolved.
struct ChangedFile {
  NamedFile then;
  NamedFile now;
};

/// Those of `made_with` that the scenario still names.
std::vector<ChangedFile> ChangedFiles(const Scenario& scenario);

}  // namespace gauntlet::sim
