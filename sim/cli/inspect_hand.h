#pragma once

#include <filesystem>

namespace gauntlet::sim {

/// Whether a file is a model of a hand, by its ending.
bool IsHandFile(const std::filesystem::path& file);

/// Builds the hand of an MJCF, as a scenario would, and prints what it has: motors, joints, what
/// turns what, and which joints no channel of a glove is named like. Errors: UserError for what
/// docs/how-to/your-hand-model.md asks for and the file does not have.
void PrintHand(const std::filesystem::path& file);

}  // namespace gauntlet::sim
