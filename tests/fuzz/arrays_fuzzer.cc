// Recordings in the formats that Gauntlet reads by itself: NPY, NPZ, JSON, Parquet, MCAP. The first
// byte chooses which; what is not JSON is a list of changes to a good file (see edited_copy.h), or
// the definition of a message of ROS 2, a zero and the message. Whatever the file is, the reader
// ends with a table of text or with a UserError of one line.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/json_arrays.h"
#include "sim/tables/message_file.h"
#include "sim/tables/message_rows.h"
#include "sim/tables/message_table.h"
#include "tests/fuzz/edited_copy.h"
#include "tests/support/source_dir.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using namespace std::string_literals;

/// Three rows of two numbers of 16 bits.
std::string GoodNpy() {
  const std::string header = "{'descr': '<i2', 'fortran_order': False, 'shape': (3, 2), }";
  return "\x93NUMPY\x01\x00"s + static_cast<char>(header.size()) + '\0' + header +
         "\1\0\2\0\3\0\4\0\5\0\6\0"s;
}

std::string Little(std::size_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 255);
  return text;
}

/// One array, stored.
std::string GoodNpz() {
  const std::string npy = GoodNpy();
  const std::string facts = Little(20, 2) + std::string(12, '\0') + Little(npy.size(), 4) +
                            Little(npy.size(), 4) + Little(5, 2) + Little(0, 2);
  const std::string file = "PK\x03\x04" + facts + "a.npy" + npy;
  const std::string entry = "PK\x01\x02" + Little(20, 2) + facts + std::string(14, '\0') + "a.npy";
  return file + entry + "PK\x05\x06" + Little(0, 4) + Little(1, 2) + Little(1, 2) +
         Little(entry.size(), 4) + Little(file.size(), 4) + Little(0, 2);
}

std::string ShippedFile(const std::string& name) {
  std::ifstream file(SourceDir() + "/tests/recordings/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const std::string& GoodParquet() {
  static const std::string kFile = ShippedFile("parquet/snappy.parquet");
  return kFile;
}

const std::string& GoodMcap(bool is_plain) {
  static const std::string kPlain = ShippedFile("mcap/plain.mcap");
  static const std::string kCompressed = ShippedFile("mcap/no_index.mcap");
  return is_plain ? kPlain : kCompressed;
}

/// A table, or a UserError.
void ReadTopic(const std::string& bytes) {
  const std::string text = test::TextFromPipe(
      [&](PipeWriter& pipe) { WriteTopicTable(*ReadMcap(bytes), "/joint_states", pipe); });
  if (std::ranges::count(text, '\n') < 2) std::abort();  // names and a row
}

void ReadMessage(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\0'), bytes.size());
  Topic topic;
  topic.type = "p/T";
  topic.encoding = "cdr";
  topic.schema_encoding = "ros2msg";
  topic.schema = bytes.substr(0, end);
  MessageRows rows(topic);
  for (int i = 0; i < 2; ++i) {
    rows.Read(bytes.substr(std::min(end + 1, bytes.size())));
    if (rows.row().size() != rows.columns().size()) std::abort();
  }
}

void CheckTable(const std::vector<NamedArray>& arrays) {
  for (const NamedArray& array : arrays) {
    if (array.values.size() != array.rows * array.columns) std::abort();
  }
  const auto table_of = [&](const std::string& chosen) {
    return test::TextFromPipe([&](PipeWriter& pipe) { WriteTable(arrays, chosen, pipe); });
  };
  if (std::ranges::count(table_of(""), '\n') < 3) std::abort();  // names and two rows
  if (!arrays.empty() && arrays.back().rows > 1) table_of(arrays.back().name);
}

void Read(char format, const std::uint8_t* data, std::size_t size) {
  try {
    // The numbers of the first formats stay those of the inputs that are kept.
    constexpr std::uint8_t kOctave = 249, kFirstOfMessages = 250;
    const auto kind = static_cast<std::uint8_t>(format);
    if (kind == kOctave) {
      return CheckTable(ReadOctaveText({reinterpret_cast<const char*>(data), size}));
    }
    if (kind >= kFirstOfMessages) {
      if (kind % 3 == 0) return ReadMessage({reinterpret_cast<const char*>(data), size});
      return ReadTopic(EditedCopy(GoodMcap(kind % 3 == 1), data, size));
    }
    switch (format % 5) {
      case 0:
        CheckTable({ReadNpy(EditedCopy(GoodNpy(), data, size), "a")});
        break;
      case 1:
        CheckTable(ReadNpz(EditedCopy(GoodNpz(), data, size)));
        break;
      case 2:
        CheckTable(ReadJsonArrays({reinterpret_cast<const char*>(data), size}));
        break;
      case 4:
        CheckTable(ReadParquet(EditedCopy(GoodParquet(), data, size)));
        break;
      default: {
        const CsvReader::Source text =
            Utf8Of(TextSource({reinterpret_cast<const char*>(data), size}));
        char buffer[5];
        std::size_t given = 0;
        while (const std::size_t got = text(buffer, sizeof buffer)) given += got;
        if (given > 3 * size) std::abort();
      }
    }
  } catch (const UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) gauntlet::sim::Read(static_cast<char>(data[0]), data + 1, size - 1);
  return 0;
}
