#pragma once

#include <filesystem>
#include <string>

#include "sim/hand/engine_types.h"
#include "sim/hand/mjcf_reader.h"

namespace gauntlet::sim {

/// Takes a MuJoCo model for an input (input_file.h), with the files that its text names as
/// file="..", where the engine looks for them: beside the model and in the folders of its meshdir,
/// texturedir and assetdir. Errors: as of InputFile().
void RegisterModelFiles(const std::filesystem::path& model);

/// The compiled model of an MJCF file as ReadModelText() gives it; the caller deletes it.
/// `readable` gets all but the elements. Errors: UserError with the file.
mjModel_* LoadModel(const std::filesystem::path& path, ReadableMjcf& readable);

/// Loads a model of other people in a helper process with limits: the engine trusts a model file,
/// so that some files use all memory, or name a pipe as a mesh. Gauntlet's own are not tried. A
/// helper must not start while other threads work. `key`: the setting or option of the file.
/// Errors: UserError.
void TryModel(const std::filesystem::path& path, const std::string& key);

}  // namespace gauntlet::sim
