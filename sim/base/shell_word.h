#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// `text` as one word of a shell command, on one line: unchanged if the shell accepts it, else in
/// quotes. Control characters and bytes that are not UTF-8 are written as in bash: $'a\nb'.
std::string ShellWord(std::string_view text);

/// Path as one word of a shell command, which must not look like an option: `-a` becomes `./-a`.
std::string ShellPath(const std::filesystem::path& path);

}  // namespace gauntlet::sim
