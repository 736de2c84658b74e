#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/hand/mjcf_element.h"

namespace gauntlet::sim {

/// A model as MuJoCo 2.2.2 can compile it.
struct ReadableMjcf {
  MjcfElement root;
  std::vector<std::string> notes;  // what was left out of the files, a sentence each
  bool lacks_contact_shapes = false;
};

/// Reads an MJCF file with its includes, leaves out what newer versions of MuJoCo have added
/// (newer_mjcf.h) and shapes without a file (mjcf_reader.cc). Included files are relative to the
/// folder of `model`, as in the engine. A URDF file stays as it is.
/// `exact_meshes`: the engine adds up the volume of meshes with signs (kExactMeshes).
/// Errors: UserError with file and line.
ReadableMjcf ReadModelText(const std::filesystem::path& model, bool exact_meshes = false);

/// A setting of the <compiler> elements of a model, of which a later one counts; empty without one.
std::string CompilerSetting(const MjcfElement& root, std::string_view attribute);

}  // namespace gauntlet::sim
