#include "sim/recordings/table_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <sstream>
#include <string>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/base/text.h"
#include "sim/recordings/keypoints/bvh_file.h"
#include "sim/recordings/keypoints/keypoint_rows.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/tables/echo_file.h"
#include "sim/tables/file_format.h"
#include "sim/tables/json_arrays.h"
#include "sim/tables/library_arrays.h"
#include "sim/tables/mcap_file.h"
#include "sim/tables/message_file.h"
#include "sim/tables/message_table.h"
#include "sim/tables/numpy_file.h"
#include "sim/tables/octave_text.h"
#include "sim/tables/parquet_file.h"
#include "sim/tables/rosbag_file.h"
#include "sim/tables/source_bytes.h"
#include "sim/tables/text_forms.h"
#include "sim/tables/utf16.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFormatBytes = 4096;  // enough to know the format

std::string BytesOfOnly(const fs::path& file) {
  const CsvReader::Source source = FileSource(file);
  OpenNoMoreFiles();
  return BytesOf(source);
}

/// The columns of all files, one below the other.
std::vector<NamedArray> ReadParquets(const std::vector<std::string>& files) {
  std::vector<NamedArray> all;
  for (const std::string& bytes : files) {
    std::vector<NamedArray> arrays = ReadParquet(bytes);
    if (all.empty()) {
      all = std::move(arrays);
      continue;
    }
    for (NamedArray& whole : all) {
      if (!whole.left_out.empty()) continue;
      const auto part = std::ranges::find(arrays, whole.name, &NamedArray::name);
      if (part == arrays.end() || part->columns != whole.columns) {
        throw UserError(
            fmt::format("has files without a column {} of {} values", whole.name, whole.columns));
      }
      whole.rows += part->rows;
      whole.values.insert(whole.values.end(), part->values.begin(), part->values.end());
    }
  }
  return all;
}

/// Names what the data set names. Its times are rounded to some microseconds; the number of the
/// frame tells them exactly, unless they are measured.
void UseInfo(const DatasetInfo& info, std::vector<NamedArray>& arrays) {
  constexpr double kRounding_s = 1e-3;
  for (NamedArray& array : arrays) {
    const auto names = info.names.find(array.name);
    if (array.columns < 2 || names == info.names.end()) continue;
    if (names->second.size() != array.columns) continue;
    for (const std::string& name : names->second) {
      array.column_names.push_back(array.name + "." + name);
    }
  }
  const auto time = std::ranges::find(arrays, "timestamp", &NamedArray::name);
  const auto frame = std::ranges::find(arrays, "frame_index", &NamedArray::name);
  if (info.rate_hz <= 0.0 || time == arrays.end() || frame == arrays.end()) return;
  std::vector<double> exact_s = frame->values;
  for (double& value : exact_s) value /= info.rate_hz;
  if (std::ranges::equal(exact_s, time->values, [](double exact, double rounded) {
        return std::abs(exact - rounded) < kRounding_s;
      })) {
    time->values = std::move(exact_s);
  }
}

[[noreturn]] void FailInPart(const fs::path& part, FileFormat format) {
  throw UserError(fmt::format("has a file {}, which is {}{}{}", part.filename().string(),
                              NameOf(format), WayOut(format).empty() ? "" : "; ", WayOut(format)));
}

std::vector<NamedArray> ArraysOf(const fs::path& file, FileFormat format, const DatasetInfo& info) {
  switch (format) {
    case FileFormat::kNpy:
      return {ReadNpy(BytesOfOnly(file), "value")};
    case FileFormat::kNpz:
      return ReadNpz(BytesOfOnly(file));
    case FileFormat::kJson:
      return ReadJsonArrays(BytesOfOnly(file));
    case FileFormat::kOctave:
      return ReadOctaveText(BytesOfOnly(file));
    case FileFormat::kMat:
      return ReadMatArrays(file);
    case FileFormat::kParquet: {
      std::vector<std::string> files;
      const std::vector<fs::path> parts = DataSetFiles(file);
      for (const fs::path& part : parts.empty() ? std::vector{file} : parts) {
        files.push_back(BytesOf(FileSource(part)));
        const FileFormat part_format = FormatOfBytes(files.back());
        if (part_format == FileFormat::kParquet) continue;
        FailInPart(part, part_format);
      }
      OpenNoMoreFiles();
      std::vector<NamedArray> arrays = ReadParquets(files);
      UseInfo(info, arrays);
      return arrays;
    }
    default:
      return ReadHdf5Arrays(file);
  }
}

/// The messages in a file or in the files of a bag.
std::unique_ptr<MessageFile> MessagesOf(const fs::path& file) {
  std::vector<std::unique_ptr<MessageFile>> opened;
  const std::vector<fs::path> parts = DataSetFiles(file);
  for (const fs::path& part : parts.empty() ? std::vector{file} : parts) {
    const FileFormat format = FormatOfBytes(BytesOf(FileSource(part), kFormatBytes));
    if (!HasTopics(format)) FailInPart(part, format);
    opened.push_back(format == FileFormat::kMcap     ? OpenMcap(part)
                     : format == FileFormat::kSqlite ? OpenRosbag(part)
                                                     : OpenEcho(part));
  }
  OpenNoMoreFiles();
  if (opened.size() == 1) return std::move(opened.front());
  return JoinMessageFiles(std::move(opened));
}

using Write = std::function<void(std::string_view)>;
/// Work of a helper on a file: it writes a text in parts.
using WriteText = std::function<void(const Write& write)>;
/// Work of a helper on the arrays of a file.
using WriteArrays = std::function<void(std::vector<NamedArray> arrays, const Write& write)>;

/// Text from a helper, which makes it of a file.
class HelperText {
 public:
  HelperText(const fs::path& file, const WriteText& write_text)
      : place_(file.string()),
        helper_(
            [=](const HelperProcess::Send& send) {
              write_text([&](std::string_view text) { send(text); });
            },
            LimitsFor(RecordingBytes(file))) {}
  HelperText(const fs::path& file, FileFormat format, const DatasetInfo& info,
             const WriteArrays& write_arrays)
      : HelperText(file, [=](const Write& write) {
          write_arrays(WithFacts(ArraysOf(file, format, info)), write);
        }) {}

  std::size_t Read(char* buffer, std::size_t size) {
    try {
      return helper_.ReceiveSome({buffer, size});
    } catch (const HelperEnded& ended) {
      throw UserError(
          {.place = place_,
           .problem = fmt::format("is damaged or too large: the process that read it {}; write it "
                                  "as CSV",
                                  ended.what())});
    } catch (const HelperSilent& silent) {
      throw RunError(fmt::format("{}: the process that reads it {}", place_, silent.what()));
    } catch (const HelperError& problem) {
      throw UserError({.place = place_, .problem = problem.what()});
    }
  }

 private:
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
};

bool HasArrays(FileFormat format) {
  return format != FileFormat::kText && format != FileFormat::kUtf16 &&
         format != FileFormat::kBvh && format != FileFormat::kEmpty && !HasTopics(format);
}

/// Errors: UserError if it is a format that is not read.
FileFormat ReadableFormat(const fs::path& file) {
  const FileFormat format = FormatOfFile(file);
  if (fs::is_directory(file) && WayOut(format).empty() && !HasTopics(format) &&
      format != FileFormat::kParquet) {
    throw UserError({.place = DataSetFiles(file).front().string(),
                     .problem = fmt::format("is {}, must be MCAP or a ROS 2 bag", NameOf(format))});
  }
  if (const std::string_view way_out = WayOut(format); !way_out.empty()) {
    const fs::path part = fs::is_directory(file) ? DataSetFiles(file).front() : file;
    throw UserError(
        {.place = part.string(),
         .problem = fmt::format("is {}, which is not read; {}", NameOf(format), way_out)});
  }
  return format;
}

/// LeRobot's meta/info.json in the folder, beside the file or in a folder above it; empty if there
/// is none.
DatasetInfo InfoOf(const fs::path& file) {
  constexpr int kMostFolders = 4;
  constexpr std::size_t kMostInfoBytes = std::size_t{4} << 20;
  fs::path folder = fs::is_directory(file) ? file : fs::absolute(file).parent_path();
  for (int i = 0; i < kMostFolders; ++i, folder = folder.parent_path()) {
    std::error_code ignored;
    const fs::path info = folder / "meta" / "info.json";
    if (fs::is_regular_file(info, ignored)) {
      return ReadDatasetInfo(BytesOf(FileSource(info), kMostInfoBytes));
    }
  }
  return {};
}

CsvReader::Source SourceOf(const std::shared_ptr<HelperText>& text) {
  return [text](char* buffer, std::size_t size) { return text->Read(buffer, size); };
}

[[noreturn]] void FailWithoutArrays(const fs::path& file, const std::string& array) {
  throw UserError(
      {.place = file.string(),
       .problem = fmt::format("is text, which has no array or topic {}", Shown(array))});
}

}  // namespace

CsvReader::Source StoredTable(const fs::path& file, const std::string& array) {
  const FileFormat format = ReadableFormat(file);
  if (HasTopics(format)) {
    return SourceOf(std::make_shared<HelperText>(
        file, [=](const Write& write) { WriteTopicTable(*MessagesOf(file), array, write); }));
  }
  if (!HasArrays(format)) {
    CsvReader::Source source = FileSource(file);
    if (!array.empty()) FailWithoutArrays(file, array);
    if (format == FileFormat::kBvh) {
      return WithHead(TableOfBvh(file.string(), BytesOf(source)), nullptr);
    }
    if (format == FileFormat::kUtf16) source = Utf8Of(std::move(source));
    return PlainTable(KeypointsInColumns(file.string(), std::move(source)), InfoOf(file).names);
  }
  const auto write_table = [array](std::vector<NamedArray> arrays, const auto& write) {
    WriteTable(std::move(arrays), array, write);
  };
  return KeypointsInColumns(file.string(), SourceOf(std::make_shared<HelperText>(
                                               file, format, InfoOf(file), write_table)));
}

CsvReader::Source TableSource(const fs::path& file, const std::string& array) {
  return AnglesOfKeypoints(file.string(), StoredTable(file, array));
}

std::vector<ListedTopic> TopicsIn(const fs::path& file, const std::string& topic) {
  if (!HasTopics(ReadableFormat(file))) return {};
  const auto write_topics = [=](const Write& write) {
    for (const ListedTopic& one : ListTopics(*MessagesOf(file), topic)) {
      write(fmt::format("{} {} {:d} {:d} {:d} {:d}\n{}\n{}\n{}\n", one.messages, one.rate_hz,
                        one.has_signals, one.is_taken, one.has_stamps, one.is_cut,
                        OneLine(one.name), OneLine(one.type), OneLine(one.problem)));
    }
  };
  std::vector<ListedTopic> listed;
  std::istringstream lines(BytesOf(SourceOf(std::make_shared<HelperText>(file, write_topics))));
  for (ListedTopic one; lines >> one.messages >> one.rate_hz >> one.has_signals >> one.is_taken >>
                        one.has_stamps >> one.is_cut;) {
    lines.get();  // the end of the line
    for (std::string* text : {&one.name, &one.type, &one.problem}) std::getline(lines, *text);
    listed.push_back(one);
  }
  return listed;
}

std::vector<ListedArray> ArraysIn(const fs::path& file, const std::string& array) {
  const FileFormat format = ReadableFormat(file);
  if (!HasArrays(format)) return {};
  HelperText helper(file, format, {}, [&array](std::vector<NamedArray> arrays, const auto& write) {
    for (const auto& [name, rows, columns, is_taken] : ListArrays(std::move(arrays), array)) {
      write(fmt::format("{} {} {} {}\n", rows, columns, is_taken ? 1 : 0, OneLine(name)));
    }
  });
  std::vector<ListedArray> listed;
  std::istringstream lines(
      BytesOf([&helper](char* buffer, std::size_t size) { return helper.Read(buffer, size); }));
  for (ListedArray one; lines >> one.rows >> one.columns >> one.is_taken;) {
    lines.get();  // the blank before the name
    std::getline(lines, one.name);
    listed.push_back(one);
  }
  return listed;
}

}  // namespace gauntlet::sim
