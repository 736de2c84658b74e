#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {

// Numbers of parquet.thrift.
enum ParquetType {
  kParquetBoolean = 0,
  kParquetInt32 = 1,
  kParquetInt64 = 2,
  kParquetInt96 = 3,
  kParquetFloat = 4,
  kParquetDouble = 5,
  kParquetBytes = 6,
  kParquetFixedBytes = 7
};

enum ParquetEncoding {
  kParquetPlain = 0,
  kParquetPlainDictionary = 2,
  kParquetRle = 3,
  kParquetRleDictionary = 8
};

/// A column of the schema. Levels: how many optional or repeated nodes on its way there are.
struct ParquetLeaf {
  std::string name;
  std::int64_t type = 0;
  bool is_unsigned = false;
  bool is_interval = false;   // months, days and ms
  bool is_time_text = false;  // texts, which may be dates or clocks by the name
  double factor = 1.0;        // from whole numbers to values of a decimal
  std::string left_out = {};  // why it is not read; empty: it is
  int repeated = 0;           // repeated nodes
  unsigned most_defined = 0;  // the level of a value
  unsigned item_defined = 0;  // from this level on there is an item in the list
};

/// The `size` bytes of a page. `codec`: as in parquet.thrift.
/// Errors: UserError for another codec, or if there are not as many.
std::string DecompressedPage(std::string_view bytes, std::int64_t codec, std::size_t size);

[[noreturn]] void FailInEncoding(const ParquetLeaf& leaf, std::int64_t encoding);

/// Reads numbers of `width` bits, written as runs and as packed groups of eight, some at a time.
class RunReader {
 public:
  RunReader() = default;
  /// Numbers of width 0 are all 0. Errors: UserError for more than 32 bits.
  RunReader(std::string_view bytes, unsigned width);
  void Next(std::span<std::uint32_t> numbers);

 private:
  void NextRun();

  ByteReader bytes_{{}};
  unsigned width_ = 0;
  std::uint64_t left_ = 0;   // of the run or the groups
  std::uint32_t value_ = 0;  // of the run
  std::string_view packed_;  // groups; empty: a run
  std::uint64_t place_ = 0;  // of the next number in them
};

/// Reads the values of a page, some at a time.
class PageValues {
 public:
  PageValues() = default;
  /// `bytes`: the page behind its levels. All three must outlive this object.
  /// Errors: UserError for an encoding that is not read.
  PageValues(std::string_view bytes, std::int64_t encoding, const ParquetLeaf& leaf,
             const std::vector<double>& dictionary);
  /// Errors: UserError if there are not as many.
  void Next(std::span<double> values);

 private:
  enum class Form { kNone, kPlain, kRuns, kPlaces };
  void NextPlain(std::span<double> values);

  Form form_ = Form::kNone;
  const ParquetLeaf* leaf_ = nullptr;
  const std::vector<double>* dictionary_ = nullptr;
  ByteReader bytes_{{}};
  RunReader runs_;
  std::vector<std::uint32_t> numbers_;  // of the runs
  bool has_width_ = false;
  std::size_t given_ = 0;  // of flags
  std::uint8_t flags_ = 0;
};

}  // namespace gauntlet::sim
