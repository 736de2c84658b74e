#include "sim/recordings/table_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"
#include "sim/base/text.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/tables/array_files.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_bytes.h"
#include "sim/tables/file_format.h"
#include "sim/tables/message_file.h"
#include "sim/tables/message_table.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/table_pipe.h"
#include "sim/tables/text_forms.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFormatBytes = 4096;                     // enough to know the format
constexpr std::uint64_t kMostListed = std::uint64_t{1} << 20;  // arrays or topics

std::string BytesOfOnly(const fs::path& file) {
  const CsvReader::Source source = FileSource(file);
  std::string bytes(fs::file_size(file), '\0');
  OpenNoMoreFiles();
  std::size_t read = 0;
  while (const std::size_t got = source(bytes.data() + read, bytes.size() - read)) read += got;
  bytes.resize(read);
  return bytes;
}

/// The columns of all files, one below the other.
std::vector<NamedArray> JoinParquets(std::vector<FileBytes> files) {
  std::vector<NamedArray> all;
  std::vector<std::vector<NamedArray>> parts;  // of each array
  for (FileBytes& bytes : files) {
    std::vector<NamedArray> arrays = OpenParquet(std::move(bytes));
    if (all.empty()) {
      all = arrays;
      parts.resize(all.size());
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      NamedArray& whole = all[i];
      if (!whole.left_out.empty()) continue;
      const auto part = std::ranges::find(arrays, whole.name, &NamedArray::name);
      if (part == arrays.end() || part->columns != whole.columns) {
        throw UserError(
            fmt::format("has files without a column {} of {} values", whole.name, whole.columns));
      }
      if (!parts[i].empty()) whole.rows += part->rows;
      parts[i].push_back(*part);
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (parts[i].size() < 2) continue;
    all[i].open = [parts = std::make_shared<const std::vector<NamedArray>>(parts[i])] {
      return [parts, part = std::size_t{0}, given = std::size_t{0}, next = NamedArray::NextRows()](
                 std::size_t rows, std::vector<double>& values) mutable {
        while (rows > 0) {
          const NamedArray& of = (*parts)[part];
          if (!next) next = of.open();
          const std::size_t count = std::min(rows, of.rows - given);
          next(count, values);
          given += count;
          rows -= count;
          if (given < of.rows) continue;
          next = {};
          given = 0;
          ++part;
        }
      };
    };
  }
  return all;
}

/// True if the number of the frame over the rate is the time in all rows but for rounding.
bool AreTimesOfFrames(const NamedArray& frame, const NamedArray& time, double rate_hz) {
  constexpr double kRounding_s = 1e-3;
  constexpr std::size_t kRows = 4096;
  if (frame.count() != frame.rows || time.count() != time.rows || frame.rows != time.rows) {
    return false;
  }
  const NamedArray::NextRows next_frames = frame.open(), next_times = time.open();
  std::vector<double> frames, times_s;
  for (std::size_t row = 0; row < frame.rows; row += kRows) {
    frames.clear();
    times_s.clear();
    next_frames(std::min(kRows, frame.rows - row), frames);
    next_times(std::min(kRows, frame.rows - row), times_s);
    const bool are_same = std::ranges::equal(frames, times_s, [&](double number, double time_s) {
      return std::abs(number / rate_hz - time_s) < kRounding_s;
    });
    if (!are_same) return false;
  }
  return true;
}

/// Names what the data set names. Its times are rounded to some microseconds; the number of the
/// frame tells them exactly, unless they are measured.
void UseInfo(const DatasetInfo& info, std::vector<NamedArray>& arrays) {
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
  if (!time->left_out.empty() || !frame->left_out.empty()) return;
  if (!AreTimesOfFrames(*frame, *time, info.rate_hz)) return;
  time->open = [open = frame->open, rate_hz = info.rate_hz]() -> NamedArray::NextRows {
    return [next = open(), rate_hz](std::size_t rows, std::vector<double>& values) {
      const auto before = static_cast<std::ptrdiff_t>(values.size());
      next(rows, values);
      std::for_each(values.begin() + before, values.end(),
                    [&](double& value) { value /= rate_hz; });
    };
  };
}

[[noreturn]] void FailInPart(const fs::path& part, FileFormat format) {
  throw UserError(fmt::format("has a file {}, which is {}{}{}", part.filename().string(),
                              NameOf(format), WayOut(format).empty() ? "" : "; ", WayOut(format)));
}

std::vector<NamedArray> ArraysOf(const fs::path& file, const std::vector<fs::path>& parts,
                                 FileFormat format, const DatasetInfo& info) {
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
      std::vector<FileBytes> files;
      for (const fs::path& part : parts.empty() ? std::vector{file} : parts) {
        files.push_back(FileBytes::Of(part));
        std::string room;
        const std::size_t head = std::min<std::uint64_t>(files.back().size(), kFormatBytes);
        const FileFormat part_format = FormatOfBytes(files.back().At(0, head, room));
        if (part_format == FileFormat::kParquet) continue;
        FailInPart(part, part_format);
      }
      OpenNoMoreFiles();
      std::vector<NamedArray> arrays = JoinParquets(std::move(files));
      UseInfo(info, arrays);
      return arrays;
    }
    default:
      return ReadHdf5Arrays(file);
  }
}

/// The messages in a file or in the files of a bag.
std::unique_ptr<MessageFile> MessagesOf(const fs::path& file, const std::vector<fs::path>& parts) {
  std::vector<std::unique_ptr<MessageFile>> opened;
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

/// Work of a helper on a file: what it found goes through the pipe.
using Work = std::function<void(PipeWriter& pipe)>;

HelperLimits LimitsFor(std::uintmax_t file_bytes) {
  HelperLimits limits;
  constexpr double kStart_s = 5.0;
  constexpr double kPerByte_s = 1e-6;  // some 20 times as long as it takes
  limits.processor_s = kStart_s + kPerByte_s * static_cast<double>(file_bytes);
  limits.memory_bytes = std::size_t{1} << 30;
  return limits;
}

/// A helper that works on a file.
class FileHelper {
 public:
  FileHelper(std::string place, std::uintmax_t file_bytes, const Work& work)
      : place_(std::move(place)),
        helper_([&work](const HelperProcess::Send& send) { Send(work, send); },
                LimitsFor(file_bytes)),
        pipe_([this](std::span<char> bytes) { helper_.Receive(bytes); }) {}

  /// The result of `take`, which reads of what the helper sends. Errors: as of `work` and of
  /// `take`, with the place.
  template <class Take>
  auto Receive(const Take& take) {
    try {
      return take(pipe_);
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
  void Finish() {
    Receive([this](PipeReader&) { helper_.Finish(); });
  }

 private:
  static void Send(const Work& work, const HelperProcess::Send& send) {
    // Many small pieces would be as many system calls.
    constexpr std::size_t kTogether = std::size_t{1} << 16;
    std::string waiting;
    PipeWriter pipe([&](std::span<const char> bytes) {
      waiting.append(bytes.begin(), bytes.end());
      if (waiting.size() < kTogether) return;
      send(waiting);
      waiting.clear();
    });
    work(pipe);
    send(waiting);
  }

  std::string place_;
  HelperProcess helper_;
  PipeReader pipe_;
};

/// The table that the helper sends next, block by block, while it is read.
std::shared_ptr<TableStream> StreamFrom(const std::shared_ptr<FileHelper>& helper) {
  const auto reader =
      helper->Receive([](PipeReader& pipe) { return std::make_shared<TableReader>(pipe); });
  return std::make_shared<TableStream>(
      reader->head(), reader->known_rows(), [helper, reader](Table& table) {
        if (helper->Receive([&](PipeReader&) { return reader->ReadBlock(table); })) return true;
        helper->Receive([&](PipeReader&) { reader->ReadOrder(table); });
        helper->Finish();
        return false;
      });
}

void WriteTopics(const std::vector<ListedTopic>& topics, PipeWriter& pipe) {
  pipe.Count(topics.size());
  for (const ListedTopic& topic : topics) {
    pipe.Texts({topic.name, topic.type, topic.problem});
    pipe.Count(topic.messages);
    pipe.Number(topic.rate_hz);
    for (const bool fact : {topic.has_signals, topic.is_taken, topic.has_stamps, topic.is_cut}) {
      pipe.Count(fact ? 1 : 0);
    }
  }
}

std::vector<ListedTopic> ReadTopics(PipeReader& pipe) {
  std::vector<ListedTopic> topics(pipe.Count(kMostListed));
  for (ListedTopic& topic : topics) {
    std::vector<std::string> texts = pipe.Texts();
    texts.resize(3);
    topic.name = OneLine(texts[0]);
    topic.type = OneLine(texts[1]);
    topic.problem = OneLine(texts[2]);
    topic.messages = pipe.Count(UINT64_MAX);
    topic.rate_hz = pipe.Number();
    for (bool* fact : {&topic.has_signals, &topic.is_taken, &topic.has_stamps, &topic.is_cut}) {
      *fact = pipe.Count(1) > 0;
    }
  }
  return topics;
}

void WriteArrays(const std::vector<ListedArray>& arrays, PipeWriter& pipe) {
  pipe.Count(arrays.size());
  for (const ListedArray& array : arrays) {
    pipe.Text(array.name);
    for (const std::size_t count : {array.rows, array.columns}) pipe.Count(count);
    pipe.Count(array.is_taken ? 1 : 0);
  }
}

std::vector<ListedArray> ReadArrays(PipeReader& pipe) {
  std::vector<ListedArray> arrays(pipe.Count(kMostListed));
  for (ListedArray& array : arrays) {
    array.name = OneLine(pipe.Text());
    array.rows = pipe.Count(UINT64_MAX);
    array.columns = pipe.Count(UINT64_MAX);
    array.is_taken = pipe.Count(1) > 0;
  }
  return arrays;
}

bool HasArrays(FileFormat format) {
  return format != FileFormat::kText && format != FileFormat::kUtf16 &&
         format != FileFormat::kEmpty && TextReaderOf(format) == nullptr && !HasTopics(format);
}

/// Errors: UserError if it is a format that is not read.
void CheckFormat(const fs::path& file, const std::vector<fs::path>& parts, FileFormat format) {
  if (!parts.empty() && WayOut(format).empty() && !HasTopics(format) &&
      format != FileFormat::kParquet) {
    throw UserError({.place = parts.front().string(),
                     .problem = fmt::format("is {}, must be MCAP or a ROS 2 bag", NameOf(format))});
  }
  if (const std::string_view way_out = WayOut(format); !way_out.empty()) {
    throw UserError(
        {.place = (parts.empty() ? file : parts.front()).string(),
         .problem = fmt::format("is {}, which is not read; {}", NameOf(format), way_out)});
  }
}

[[noreturn]] void FailWithoutArrays(const fs::path& file, const std::string& array) {
  throw UserError(
      {.place = file.string(),
       .problem = fmt::format("is text, which has no array or topic {}", Shown(array))});
}

/// Errors: UserError where a topic has to be chosen first.
TableInput TableOf(OpenedTable opened, const fs::path& file) {
  if (opened.table) return std::move(*opened.table);
  throw UserError({.place = file.string(), .problem = QuestionOf(opened.topics)});
}

/// The text that begins with `head`.
TableInput TextTable(const fs::path& file, FileFormat format, std::string head,
                     CsvReader::Source rest) {
  CsvReader::Source source = WithHead(std::move(head), std::move(rest));
  if (auto* const read = TextReaderOf(format)) {
    return std::make_shared<const Table>(read(file.string(), WholeTextOf(source, file.string())));
  }
  if (format == FileFormat::kUtf16) source = Utf8Of(std::move(source));
  TableInput wide = KeypointsInColumns(file.string(), std::move(source));
  return PlainTable(std::get<CsvReader::Source>(std::move(wide)), DatasetInfoOf(file).names);
}

}  // namespace

TextReader TextReaderOf(FileFormat format) {
  if (format == FileFormat::kBvh) return TableOfBvh;
  if (format == FileFormat::kStorage) return TableOfStorage;
  return format == FileFormat::kTrc ? TableOfTrc : nullptr;
}

OpenedTable OpenStoredTable(const fs::path& file, const std::string& array) {
  const std::vector<fs::path> parts = DataSetFiles(file);
  if (parts.empty()) CheckFolder(file);
  OpenedTable opened;
  CsvReader::Source source = FileSource(parts.empty() ? file : parts.front());
  std::string head = BytesOf(source, kFormatBytes);
  const bool is_data_set = !parts.empty() && parts.front().extension() == ".parquet";
  opened.format = is_data_set ? FileFormat::kParquet : FormatOfBytes(head);
  CheckFormat(file, parts, opened.format);
  opened.file_bytes = RecordingBytes(file, parts);
  if (!HasTopics(opened.format) && !HasArrays(opened.format)) {
    if (!array.empty()) FailWithoutArrays(file, array);
    opened.table = TextTable(file, opened.format, std::move(head), std::move(source));
    return opened;
  }
  source = nullptr;
  const auto write_topics = [&](PipeWriter& pipe) {
    const std::unique_ptr<MessageFile> messages = MessagesOf(file, parts);
    const std::vector<ListedTopic> topics = ListTopics(*messages, array);
    WriteTopics(topics, pipe);
    if (std::ranges::any_of(topics, &ListedTopic::is_taken))
      WriteTopicTable(*messages, array, pipe);
  };
  const DatasetInfo info = HasArrays(opened.format) ? DatasetInfoOf(file) : DatasetInfo();
  const auto write_arrays = [&](PipeWriter& pipe) {
    std::vector<NamedArray> arrays = WithFacts(ArraysOf(file, parts, opened.format, info));
    WriteArrays(ListArrays(arrays, array), pipe);
    WriteTable(std::move(arrays), array, pipe);
  };
  const auto helper =
      std::make_shared<FileHelper>(file.string(), opened.file_bytes,
                                   HasTopics(opened.format) ? Work(write_topics) : write_arrays);
  if (HasTopics(opened.format)) {
    opened.topics = helper->Receive(ReadTopics);
    if (opened.topics.empty()) {
      throw UserError({.place = file.string(), .problem = QuestionOf(opened.topics)});
    }
    if (std::ranges::none_of(opened.topics, &ListedTopic::is_taken)) {
      helper->Finish();
      return opened;
    }
  } else {
    opened.arrays = helper->Receive(ReadArrays);
  }
  TableInput table;
  if (opened.format == FileFormat::kParquet) {
    table = StreamFrom(helper);
  } else {
    table = std::make_shared<const Table>(helper->Receive(ReadTable));
    helper->Finish();
  }
  opened.table = KeypointsInColumns(file.string(), std::move(table));
  return opened;
}

DatasetInfo DatasetInfoOf(const fs::path& file) {
  constexpr int kMostFolders = 4;
  constexpr std::size_t kMostInfoBytes = 4'000'000;
  fs::path folder = fs::is_directory(file) ? file : fs::absolute(file).parent_path();
  for (int i = 0; i < kMostFolders; ++i, folder = folder.parent_path()) {
    std::error_code ignored;
    const fs::path info = folder / "meta" / "info.json";
    if (!IsOutside(info) && fs::is_regular_file(info, ignored)) {
      return ReadDatasetInfo(LimitedText(InputFile(info), kMostInfoBytes));
    }
  }
  return {};
}

OpenedTable OpenTable(const fs::path& file, const std::string& array) {
  OpenedTable opened = OpenStoredTable(file, array);
  if (opened.table) opened.table = AnglesOfKeypoints(file.string(), std::move(*opened.table));
  return opened;
}

TableInput TableSource(const fs::path& file, const std::string& array) {
  return TableOf(OpenTable(file, array), file);
}

TableInput StoredTable(const fs::path& file, const std::string& array) {
  return TableOf(OpenStoredTable(file, array), file);
}

}  // namespace gauntlet::sim
