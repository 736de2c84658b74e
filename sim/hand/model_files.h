#pragma once

#include <filesystem>

namespace gauntlet::sim {

/// Takes a MuJoCo model for an input (input_file.h), with the files that its text names as
/// file="..", where the engine looks for them: beside the model and in the folders of its meshdir,
/// texturedir and assetdir. Errors: as of InputFile().
void TakeModelFiles(const std::filesystem::path& model);

}  // namespace gauntlet::sim
