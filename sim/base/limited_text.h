#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace gauntlet::sim {

/// Longest manifest, and longest file that people may edit (map, scenario, hand) [bytes].
inline constexpr std::size_t kMostManifestBytes = 4'000'000;
inline constexpr std::size_t kMostEditableBytes = 16'000'000;
/// Longest XML of a hand's model, without its meshes [bytes].
inline constexpr std::size_t kMostModelBytes = 64'000'000;
/// Longest table of scores: some thousand seeds of ten controllers [bytes].
inline constexpr std::size_t kMostScoreBytes = 256'000'000;

/// The bytes of a regular file. Every small file that is read whole is read here: a file of a
/// third party may have any size. None if it cannot be read, or has more than `most_bytes`.
std::optional<std::string> LimitedTextIfAny(const std::filesystem::path& file,
                                            std::size_t most_bytes);
/// As LimitedTextIfAny(). Errors: UserError with the file as its place in place of none.
std::string LimitedText(const std::filesystem::path& file, std::size_t most_bytes);

}  // namespace gauntlet::sim
