#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// A model as MuJoCo 2.2.2 can compile it.
struct ReadableMjcf {
  std::string text;
  std::vector<std::string> notes;  // what was left out of the files, a sentence each
  bool lacks_contact_shapes = false;
};

/// Reads an MJCF file with its includes, leaves out what newer versions of MuJoCo have added
/// (newer_mjcf.h) and shapes without a file (mjcf_reader.cc). Included files are relative to the
/// folder of `model`, as in the engine. A URDF file stays as it is.
/// `exact_meshes`: the engine adds up the volume of meshes with signs (kExactMeshes).
/// Errors: UserError with file and line.
ReadableMjcf ReadModelText(const std::filesystem::path& model, bool exact_meshes = false);

}  // namespace gauntlet::sim
