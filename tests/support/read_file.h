#pragma once

#include <filesystem>
#include <string>

namespace gauntlet::test {

/// All bytes of a file; nothing of one that is not there.
std::string ReadFile(const std::filesystem::path& file);

}  // namespace gauntlet::test
