#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "sim/tables/message_file.h"

namespace gauntlet::sim {

/// Opens an MCAP file. Chunks are uncompressed, lz4 or zstd. The index of the file is used if it
/// is complete: then only chunks with the topic's messages are read. Checksums are checked.
/// Source: mcap.dev/spec. Errors: UserError without a place for a damaged file, for a chunk above
/// 256 MB and for another compression.
std::unique_ptr<MessageFile> OpenMcap(const std::filesystem::path& file);
/// As OpenMcap(), for the bytes of a file.
std::unique_ptr<MessageFile> ReadMcap(std::string bytes);

}  // namespace gauntlet::sim
