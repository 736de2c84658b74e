#include "sim/recordings/table_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/recordings/array_table.h"
#include "sim/recordings/file_format.h"
#include "sim/recordings/json_arrays.h"
#include "sim/recordings/library_arrays.h"
#include "sim/recordings/numpy_file.h"
#include "sim/recordings/utf16.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

std::string BytesOf(const fs::path& file) {
  const CsvReader::Source source = FileSource(file);
  OpenNoMoreFiles();
  std::string bytes;
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  for (;;) {
    const std::size_t size = bytes.size();
    bytes.resize(size + kBlock);
    const std::size_t got = source(bytes.data() + size, kBlock);
    bytes.resize(size + got);
    if (got == 0) return bytes;
  }
}

std::vector<NamedArray> ArraysOf(const fs::path& file, FileFormat format) {
  switch (format) {
    case FileFormat::kNpy:
      return {ReadNpy(BytesOf(file), "value")};
    case FileFormat::kNpz:
      return ReadNpz(BytesOf(file));
    case FileFormat::kJson:
      return ReadJsonArrays(BytesOf(file));
    case FileFormat::kMat5:
      return ReadMatArrays(file);
    default:
      return ReadHdf5Arrays(file);
  }
}

/// Text that comes in blocks from a helper, which makes it of a file with arrays. A block is its
/// size, then its bytes; an empty one is the end.
class HelperText {
 public:
  HelperText(const fs::path& file, FileFormat format)
      : place_(file.string()),
        helper_([=](const HelperProcess::Send& send) { Work(file, format, send); },
                LimitsFor(fs::file_size(file))) {}

  std::size_t Read(char* buffer, std::size_t size) {
    try {
      if (left_ == 0 && !at_end_) {
        helper_.Receive({reinterpret_cast<char*>(&left_), sizeof left_});
        at_end_ = left_ == 0;
      }
      if (at_end_) return 0;
      const std::size_t count = std::min<std::size_t>(size, left_);
      helper_.Receive({buffer, count});
      left_ -= static_cast<std::uint32_t>(count);
      return count;
    } catch (const HelperEnded& ended) {
      throw UserError(
          {.place = place_,
           .problem = fmt::format("is damaged or too large: the process that read it {}; write it "
                                  "as CSV",
                                  ended.what())});
    } catch (const HelperError& problem) {
      throw UserError({.place = place_, .problem = problem.what()});
    }
  }

 private:
  static void Work(const fs::path& file, FileFormat format, const HelperProcess::Send& send) {
    const auto send_block = [&send](std::string_view text) {
      const auto size = static_cast<std::uint32_t>(text.size());
      send({reinterpret_cast<const char*>(&size), sizeof size});
      send(std::span(text));
    };
    WriteTable(ArraysOf(file, format), send_block);
    send_block("");
  }
  static HelperLimits LimitsFor(std::uintmax_t file_bytes) {
    HelperLimits limits;
    constexpr double kStart_s = 5.0;
    constexpr double kPerByte_s = 1e-6;  // some 20 times as long as it takes
    limits.processor_s = kStart_s + kPerByte_s * static_cast<double>(file_bytes);
    limits.memory_bytes = std::size_t{1} << 30;
    return limits;
  }

  std::string place_;
  HelperProcess helper_;
  std::uint32_t left_ = 0;  // of the block
  bool at_end_ = false;
};

}  // namespace

CsvReader::Source TableSource(const fs::path& file) {
  std::error_code unreadable;
  // What has been looked at once, a pipe does not give again.
  if (!fs::is_regular_file(file, unreadable)) return FileSource(file);
  const FileFormat format = FormatOfFile(file);
  if (const std::string_view way_out = WayOut(format); !way_out.empty()) {
    throw UserError(
        {.place = file.string(),
         .problem = fmt::format("is {}, which is not read; {}", NameOf(format), way_out)});
  }
  switch (format) {
    case FileFormat::kText:
    case FileFormat::kEmpty:
      return FileSource(file);
    case FileFormat::kUtf16:
      return Utf8Of(FileSource(file));
    default:
      break;
  }
  const auto text = std::make_shared<HelperText>(file, format);
  return [text](char* buffer, std::size_t size) { return text->Read(buffer, size); };
}

}  // namespace gauntlet::sim
