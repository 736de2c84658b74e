#include "sim/tables/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <system_error>
#include <utility>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"
#include "sim/base/text.h"
#include "sim/tables/array_files.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/message_file.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

struct Signature {
  std::string_view bytes;  // at the beginning of the file
  FileFormat format;
};
constexpr std::array<Signature, 23> kSignatures = {{
    {"\x89HDF\r\n\x1a\n"sv, FileFormat::kHdf5},
    {"\x93NUMPY"sv, FileFormat::kNpy},
    {"\x1f\x8b"sv, FileFormat::kGzip},
    {"\x28\xb5\x2f\xfd"sv, FileFormat::kZstd},
    {"SQLite format 3\0"sv, FileFormat::kSqlite},
    {"#ROSBAG"sv, FileFormat::kRosBag},
    {"\x89MCAP0\r\n"sv, FileFormat::kMcap},
    {"PAR1"sv, FileFormat::kParquet},
    {"version https://git-lfs"sv, FileFormat::kLfsPointer},
    {"\x1a\x45\xdf\xa3"sv, FileFormat::kVideo},  // Matroska, WebM
    {"XDF:"sv, FileFormat::kXdf},
    {"Kaydara FBX Binary"sv, FileFormat::kFbx},
    {"ARROW1"sv, FileFormat::kArrow},
    {"FEA1"sv, FileFormat::kArrow},
    {"\xff\x42IOSEMI"sv, FileFormat::kEdf},
    {"TDSm"sv, FileFormat::kTdms},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, FileFormat::kXls},
    {"\x80\x02"sv, FileFormat::kPickle},
    {"\x80\x03"sv, FileFormat::kPickle},
    {"\x80\x04\x95"sv, FileFormat::kPickle},
    {"\x80\x05\x95"sv, FileFormat::kPickle},
    {"\xff\xfe"sv, FileFormat::kUtf16},
    {"\xfe\xff"sv, FileFormat::kUtf16},
}};

struct FormatFacts {
  FileFormat format;
  std::string_view name;
  std::string_view in_profiles = "other";
  std::string_view way_out = "";
};
const FormatFacts& FactsOf(FileFormat format) {
  static constexpr std::array<FormatFacts, 34> kFacts = {{
      {FileFormat::kText, "text", "text"},
      {FileFormat::kUtf16, "UTF-16 text", "text"},
      {FileFormat::kBvh, "BVH"},
      {FileFormat::kStorage, "OpenSim storage"},
      {FileFormat::kTrc, "TRC"},
      {FileFormat::kEmpty, "empty"},
      {FileFormat::kJson, "JSON", "json"},
      {FileFormat::kNpy, "NPY of NumPy", "npy"},
      {FileFormat::kNpz, "NPZ of NumPy", "npy"},
      {FileFormat::kMat, "MAT of MATLAB", "mat"},
      {FileFormat::kHdf5, "HDF5", "hdf5"},
      {FileFormat::kXlsx, "XLSX", "other", "save the sheet as CSV"},
      {FileFormat::kZip, "ZIP", "other", "unpack it and give the file that is in it"},
      {FileFormat::kGzip, "gzip", "other", "unpack it: gunzip --keep FILE"},
      {FileFormat::kZstd, "zstd", "other", "unpack it: zstd -d FILE"},
      {FileFormat::kSqlite, "a ROS 2 bag", "bag"},
      {FileFormat::kRosEcho, "text of rostopic echo", "echo"},
      {FileFormat::kRosBag, "a ROS 1 bag", "other",
       "write a topic as CSV: rostopic echo -b FILE -p /TOPIC > TOPIC.csv"},
      {FileFormat::kMcap, "MCAP", "mcap"},
      {FileFormat::kOctave, "text of Octave"},
      {FileFormat::kParquet, "Parquet", "parquet"},
      {FileFormat::kLfsPointer, "a pointer of Git LFS", "other",
       "fetch the file itself: git lfs pull"},
      {FileFormat::kVideo, "a video", "other",
       "find the joint angles in it with a hand tracker and write them as CSV"},
      {FileFormat::kC3d, "C3D", "other",
       "write the angles of its joints as .mot or CSV, or markers as .trc"},
      {FileFormat::kXdf, "XDF of the Lab Streaming Layer", "other",
       "write one stream as CSV, with pyxdf"},
      {FileFormat::kFbx, "FBX", "other", "write its skeleton as BVH, with Blender"},
      {FileFormat::kUrdf, "a URDF, a model of a robot", "other",
       "a hand must be an MJCF file as models/README.md describes"},
      {FileFormat::kArrow, "Arrow or Feather", "other",
       "write it as Parquet: pyarrow.parquet.write_table(TABLE, FILE)"},
      {FileFormat::kEdf, "EDF or BDF", "other", "write its signals as CSV, with pyedflib"},
      {FileFormat::kTdms, "TDMS of LabVIEW", "other", "write a group as CSV, with nptdms"},
      {FileFormat::kWave, "a WAV of sound", "other",
       "write its samples as NPY, with scipy.io.wavfile, and give --rate HZ"},
      {FileFormat::kPickle, "a pickle of Python", "other",
       "write its arrays as NPZ: numpy.savez(FILE, t=TIME, angles=ANGLES)"},
      {FileFormat::kXls, "XLS", "other", "save the sheet as CSV"},
      {FileFormat::kBinary, "binary, of a kind that is not known", "other",
       "export it as CSV from the program that wrote it"},
  }};
  return *std::ranges::find(kFacts, format, &FormatFacts::format);
}

/// By what the first file in it is called.
FileFormat FormatOfZip(std::string_view head) {
  constexpr std::size_t kNameAt = 30;
  const std::string_view names = head.substr(std::min(kNameAt, head.size()));
  if (names.starts_with("[Content_Types].xml") || names.starts_with("xl/") ||
      names.starts_with("_rels/") || names.starts_with("docProps/")) {
    return FileFormat::kXlsx;
  }
  return names.find(".npy") != std::string_view::npos ? FileFormat::kNpz : FileFormat::kZip;
}

bool IsJson(std::string_view head) {
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  if (head[first] == '{') return true;
  if (head[first] != '[') return false;
  const std::size_t second = head.find_first_not_of(" \t\r\n", first + 1);
  if (second == std::string_view::npos) return false;
  if (head[second] == '{' || head[second] == '[') return true;
  // `[Header]` of a sensor's software is text, and so is `[2026-04-27 02:16:12]` of a log.
  const std::string_view entry =
      head.substr(second, head.find_first_of(" \t\r\n,]", second) - second);
  return controller::ParseNumber(entry).has_value();
}

bool IsBvh(std::string_view head) {
  head = Trimmed(WithoutByteOrderMark(head));
  const std::string_view word = head.substr(0, head.find_first_of(" \t\r\n"));
  return IsWordOf("hierarchy", BareName(word));
}

/// The file that `zstd -d` made of a compressed one, if it is there; else the file itself.
fs::path Unpacked(const fs::path& file) {
  std::error_code missing;
  if (file.extension() != ".zstd") return file;
  const fs::path unpacked = file.parent_path() / file.stem();
  return fs::is_regular_file(unpacked, missing) ? unpacked : file;
}

/// Files that the metadata.yaml of a bag lists under relative_file_paths. rosbag2 writes one in a
/// line.
std::vector<fs::path> ListedFiles(const fs::path& folder) {
  constexpr std::size_t kMostBytes = 16'000'000;
  std::vector<fs::path> files;
  std::error_code missing;
  if (!fs::is_regular_file(folder / "metadata.yaml", missing)) return files;
  const std::string text = LimitedText(InputFile(folder / "metadata.yaml"), kMostBytes);
  bool is_list = false;
  for (const std::string_view line : SplitLines(text)) {
    const std::string_view trimmed = Trimmed(line);
    const bool is_item = trimmed.starts_with("- ");
    if (is_list && is_item) {
      const fs::path listed(Unquoted(Trimmed(trimmed.substr(2))));
      // The first versions list them as seen from the folder above.
      const bool is_below = fs::exists(Unpacked(folder / listed), missing);
      files.push_back(Unpacked(folder / (is_below ? listed : listed.filename())));
      if (fs::is_regular_file(files.back(), missing)) continue;
      throw UserError(
          {.place = (folder / "metadata.yaml").string(),
           .problem = fmt::format("lists {}, which is not there", OneLine(listed.string(), 80))});
    }
    is_list = trimmed == "relative_file_paths:" || (is_list && is_item);
  }
  return files;
}

/// A stem without the number at its end, and this number: `bag_` and 12 of `bag_12.db3`.
std::pair<std::string, std::int64_t> PartsOfStem(const fs::path& file) {
  std::string stem = (file.extension() == ".zstd" ? file.stem() : file).stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  const auto number =
      controller::ParseWholeNumber(stem.substr(digits), 0, std::int64_t{1} << 50).value_or(0);
  stem.resize(digits);
  return {stem, number};
}

/// Errors: UserError if the folder has parts of several bags.
std::vector<fs::path> BagFiles(const fs::path& folder) {
  std::vector<fs::path> files = ListedFiles(folder);
  std::error_code ignored;
  // A result of Gauntlet has one MCAP file for each controller.
  if (!files.empty() || fs::exists(folder / "manifest.json", ignored)) return files;
  for (const auto& file : fs::directory_iterator(folder, ignored)) {
    const bool is_packed = file.path().extension() == ".zstd";
    const fs::path kind = is_packed ? file.path().stem().extension() : file.path().extension();
    const bool is_part = kind == ".db3" || kind == ".mcap";
    if (is_part && Unpacked(file.path()) == file.path()) files.push_back(file.path());
  }
  std::ranges::sort(files, {}, PartsOfStem);
  if (!files.empty() && PartsOfStem(files.front()).first != PartsOfStem(files.back()).first) {
    throw UserError({.place = folder.string(),
                     .problem = fmt::format("has several recordings, {} and {}; give one of them",
                                            OneLine(files.front().filename().string(), 60),
                                            OneLine(files.back().filename().string(), 60))});
  }
  return files;
}

}  // namespace

bool IsMat4(std::string_view head) {
  constexpr std::size_t kNumbers = 20;
  if (head.size() < kNumbers) return false;
  const auto number = [head](std::size_t place, bool is_big) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto byte = static_cast<std::uint8_t>(head[place + (is_big ? 3 - i : i)]);
      value |= std::uint32_t{byte} << (8 * i);
    }
    return value;
  };
  for (const bool is_big : {false, true}) {
    constexpr std::uint32_t kBig = 1000, kMostName = 64;
    const std::uint32_t type = number(0, is_big) - (is_big ? kBig : 0);
    const std::uint32_t name = number(16, is_big);
    if (type > 52 || type % 10 > 2 || number(12, is_big) > 1) continue;
    if (name < 2 || name > kMostName || head.size() < kNumbers + name) continue;
    const std::string_view letters = head.substr(kNumbers, name - 1);
    const bool is_name = std::ranges::all_of(
        letters, [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '_'; });
    if (is_name && head[kNumbers + name - 1] == '\0') return true;
  }
  return false;
}

FileFormat FormatOfBytes(std::string_view head) {
  if (head.empty()) return FileFormat::kEmpty;
  for (const Signature& signature : kSignatures) {
    if (head.starts_with(signature.bytes)) return signature.format;
  }
  if (head.starts_with("PK\x03\x04")) return FormatOfZip(head);
  constexpr std::size_t kBrandAt = 4;  // of MP4 and MOV
  const bool is_avi = head.starts_with("RIFF") && head.substr(0, 12).ends_with("AVI ");
  if (is_avi || head.substr(std::min(kBrandAt, head.size())).starts_with("ftyp")) {
    return FileFormat::kVideo;
  }
  constexpr std::size_t kEndOfMatText = 126;
  if (head.starts_with("MATLAB ") && head.size() >= kEndOfMatText + 2) {
    const std::string_view order = head.substr(kEndOfMatText, 2);
    // MAT 7.3 has 512 bytes of its own before those of HDF5.
    if (head.starts_with("MATLAB 7.3")) return FileFormat::kHdf5;
    if (order == "IM" || order == "MI") return FileFormat::kMat;
  }
  if (IsMat4(head)) return FileFormat::kMat;
  // A stream: the mark of a message, and the size of the schema.
  constexpr std::size_t kSizeBehind = 8;
  if (head.size() > kSizeBehind && head.starts_with("\xff\xff\xff\xff") &&
      head.substr(0, kSizeBehind).ends_with("\0\0"sv)) {
    return FileFormat::kArrow;
  }
  if (head.starts_with("RIFF") && head.substr(0, 12).ends_with("WAVE")) return FileFormat::kWave;
  // Version, and the date and the time at their places.
  constexpr std::size_t kDateAt = 168;
  if (head.starts_with("0       ") && head.size() >= kDateAt + 16 && head[kDateAt + 2] == '.' &&
      head[kDateAt + 5] == '.' && head[kDateAt + 10] == '.' && head[kDateAt + 13] == '.') {
    return FileFormat::kEdf;
  }
  // The block of the parameters, the second as a rule, and the format's number.
  const bool is_c3d = head.size() > 2 && head[0] > 1 && head[0] < 16 && head[1] == '\x50';
  if (is_c3d && head.find('\0') != std::string_view::npos) return FileFormat::kC3d;
  constexpr int kTextPerZero = 20;  // a broken line of text may hold some
  if (std::ranges::count(head, '\0') * kTextPerZero > std::ssize(head)) return FileFormat::kBinary;
  const std::size_t first = std::min(head.find_first_not_of(" \t\r\n"), head.size());
  if (head.substr(first, 1) == "<" && head.find("<robot") != std::string_view::npos) {
    return FileFormat::kUrdf;
  }
  if (IsBvh(head)) return FileFormat::kBvh;
  if (IsStorage(head)) return FileFormat::kStorage;
  if (IsTrc(head)) return FileFormat::kTrc;
  if (IsOctaveText(head)) return FileFormat::kOctave;
  if (IsEcho(head)) return FileFormat::kRosEcho;
  return IsJson(head) ? FileFormat::kJson : FileFormat::kText;
}

std::vector<fs::path> DataSetFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return files;
  for (const auto& chunk : fs::directory_iterator(folder / "data", ignored)) {
    for (const auto& file : fs::directory_iterator(chunk.path(), ignored)) {
      if (file.path().extension() == ".parquet") files.push_back(file.path());
    }
  }
  std::ranges::sort(files);
  return files.empty() ? BagFiles(folder) : files;
}

bool HasTopics(FileFormat format) {
  return format == FileFormat::kMcap || format == FileFormat::kSqlite ||
         format == FileFormat::kRosEcho;
}

std::uintmax_t RecordingBytes(const fs::path& file, const std::vector<fs::path>& parts) {
  if (parts.empty()) return fs::file_size(file);
  std::uintmax_t bytes = 0;
  for (const fs::path& part : parts) bytes += fs::file_size(part);
  return bytes;
}

void CheckFolder(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_directory(file, ignored)) return;
  const bool is_output = fs::exists(file / "manifest.json", ignored);
  for (const char* name : {"zarr.json", ".zgroup", ".zarray"}) {
    if (!fs::exists(file / name, ignored)) continue;
    throw UserError({.place = file.string(),
                     .problem = "is Zarr, which is not read; write its arrays as NPZ: "
                                "numpy.savez(FILE, t=TIME, angles=ANGLES)"});
  }
  throw UserError(
      {.place = file.string(),
       .problem = is_output
                      ? "is an output folder of gauntlet, must be a recording: a file, a data "
                        "set of LeRobot or a ROS 2 bag"
                      : "is a folder without data/*/*.parquet (LeRobot), .db3 or .mcap "
                        "(ROS 2); name a file in it"});
}

std::string_view NameOf(FileFormat format) { return FactsOf(format).name; }

std::string_view NameInProfiles(FileFormat format) { return FactsOf(format).in_profiles; }

std::string_view WayOut(FileFormat format) { return FactsOf(format).way_out; }

}  // namespace gauntlet::sim
