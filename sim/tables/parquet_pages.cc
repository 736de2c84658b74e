#include "sim/tables/parquet_pages.h"

#include <fmt/format.h>
#include <snappy-c.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>

#include "sim/base/error.h"
#include "sim/tables/missing.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 10> kEncodings = {
    "PLAIN",          "GROUP_VAR_INT",       "PLAIN_DICTIONARY",        "RLE",
    "BIT_PACKED",     "DELTA_BINARY_PACKED", "DELTA_LENGTH_BYTE_ARRAY", "DELTA_BYTE_ARRAY",
    "RLE_DICTIONARY", "BYTE_STREAM_SPLIT"};
constexpr std::array<std::string_view, 8> kCodecs = {"none",   "snappy", "gzip", "LZO",
                                                     "brotli", "LZ4",    "zstd", "LZ4_RAW"};

std::string Inflated(std::string_view bytes, std::size_t size) {
  std::string text(size, '\0');
  z_stream stream = {};
  constexpr int kGzipToo = 32;
  if (inflateInit2(&stream, MAX_WBITS + kGzipToo) != Z_OK) FailAsDamaged("gzip cannot begin");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(size);
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (result != Z_STREAM_END || stream.avail_out != 0) FailAsDamaged("a page is not whole");
  return text;
}

std::string_view NameIn(std::span<const std::string_view> names, std::int64_t number) {
  return number >= 0 && number < std::ssize(names) ? names[static_cast<std::size_t>(number)]
                                                   : "an unknown one";
}

}  // namespace

std::string DecompressedPage(std::string_view bytes, std::int64_t codec, std::size_t size) {
  std::string text;
  switch (codec) {
    case 0:
      text = bytes;
      break;
    case 1: {
      std::size_t found = 0;
      if (snappy_uncompressed_length(bytes.data(), bytes.size(), &found) != SNAPPY_OK ||
          found != size) {
        FailAsDamaged("a page has another size than it says");
      }
      text.resize(size);
      if (snappy_uncompress(bytes.data(), bytes.size(), text.data(), &found) != SNAPPY_OK) {
        FailAsDamaged("a page is not whole");
      }
      break;
    }
    case 2:
      return Inflated(bytes, size);
    case 6: {
      text.resize(size);
      const std::size_t found =
          ZSTD_decompress(text.data(), text.size(), bytes.data(), bytes.size());
      if (ZSTD_isError(found) != 0 || found != size) FailAsDamaged("a page is not whole");
      break;
    }
    default:
      throw UserError(
          fmt::format("is compressed by {}, which is not read; write it with snappy, "
                      "gzip or zstd",
                      NameIn(kCodecs, codec)));
  }
  if (text.size() != size) FailAsDamaged("a page has another size than it says");
  return text;
}

void FailInEncoding(const ParquetLeaf& leaf, std::int64_t encoding) {
  throw UserError(
      fmt::format("column {} has the encoding {}, which is not read; write it with "
                  "PLAIN or a dictionary",
                  leaf.name, NameIn(kEncodings, encoding)));
}

RunReader::RunReader(std::string_view bytes, unsigned width) : bytes_(bytes), width_(width) {
  constexpr unsigned kMostWidth = 32;
  if (width > kMostWidth) FailAsDamaged("a number of more than 32 bits");
}

void RunReader::NextRun() {
  const std::uint64_t header = bytes_.Varint();
  if (header % 2 == 0) {
    value_ = 0;
    packed_ = {};
    const std::string_view digits = bytes_.Take((width_ + 7) / 8);
    for (std::size_t i = 0; i < digits.size(); ++i) {
      value_ |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(digits[i])) << (8 * i);
    }
    if (header == 0) FailAsDamaged("a run of no values");
    left_ = header / 2;
    return;
  }
  const std::uint64_t groups = header / 2;
  if (groups == 0 || groups > bytes_.rest().size()) FailAsDamaged("a run is longer than its page");
  packed_ = bytes_.Take(groups * width_);
  place_ = 0;
  left_ = 8 * groups;
}

void RunReader::Next(std::span<std::uint32_t> numbers) {
  if (width_ == 0) {
    std::ranges::fill(numbers, 0U);
    return;
  }
  while (!numbers.empty()) {
    if (left_ == 0) NextRun();
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, numbers.size()));
    left_ -= count;
    const std::span<std::uint32_t> part = numbers.first(count);
    numbers = numbers.subspan(count);
    if (packed_.empty()) {
      std::ranges::fill(part, value_);
      continue;
    }
    const std::uint64_t mask = (std::uint64_t{1} << width_) - 1;
    for (std::uint32_t& number : part) {
      std::uint64_t bits = 0;
      const std::uint64_t first = place_++ * width_;
      for (std::uint64_t byte = first / 8; byte <= (first + width_ - 1) / 8; ++byte) {
        bits |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(packed_[byte]))
                << (8 * (byte - first / 8));
      }
      number = static_cast<std::uint32_t>((bits >> (first % 8)) & mask);
    }
  }
}

PageValues::PageValues(std::string_view bytes, std::int64_t encoding, const ParquetLeaf& leaf,
                       const std::vector<double>& dictionary)
    : leaf_(&leaf), dictionary_(&dictionary), bytes_(bytes) {
  if (encoding == kParquetPlain) {
    form_ = Form::kPlain;
  } else if (encoding == kParquetRle && leaf.type == kParquetBoolean) {
    form_ = Form::kRuns;
  } else if (encoding == kParquetPlainDictionary || encoding == kParquetRleDictionary) {
    form_ = Form::kPlaces;
  } else {
    FailInEncoding(leaf, encoding);
  }
}

void PageValues::Next(std::span<double> values) {
  if (values.empty()) return;
  if (form_ == Form::kPlain) return NextPlain(values);
  if (!has_width_ && form_ == Form::kPlaces) {
    const unsigned width = bytes_.Little<std::uint8_t>();
    runs_ = RunReader(bytes_.rest(), width);
  } else if (!has_width_) {
    runs_ = RunReader(bytes_.Take(bytes_.Little<std::uint32_t>()), 1);
  }
  has_width_ = true;
  numbers_.resize(values.size());
  runs_.Next(numbers_);
  if (form_ == Form::kRuns) {
    std::ranges::copy(numbers_, values.begin());
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (numbers_[i] >= dictionary_->size()) FailAsDamaged("a value is not in its dictionary");
    values[i] = (*dictionary_)[numbers_[i]];
  }
}

void PageValues::NextPlain(std::span<double> values) {
  const auto fill = [&](const auto& next) {
    for (double& value : values) value = next();
  };
  const bool is_unsigned = leaf_->is_unsigned;
  switch (leaf_->type) {
    case kParquetBoolean:
      fill([&]() -> double {
        const std::size_t bit = given_++ % 8;
        if (bit == 0) flags_ = bytes_.Little<std::uint8_t>();
        return flags_ >> bit & 1;
      });
      break;
    case kParquetInt32:
      fill([&]() -> double {
        return is_unsigned ? static_cast<double>(bytes_.Little<std::uint32_t>())
                           : bytes_.Little<std::int32_t>();
      });
      break;
    case kParquetInt64:
      fill([&] {
        return is_unsigned ? static_cast<double>(bytes_.Little<std::uint64_t>())
                           : static_cast<double>(bytes_.Little<std::int64_t>());
      });
      break;
    case kParquetInt96:  // time of day [ns] and day, as Spark writes them
      fill([&] {
        constexpr double kDay1970 = 2440588.0;
        const auto time_ns = static_cast<double>(bytes_.Little<std::int64_t>());
        const double day = bytes_.Little<std::uint32_t>() - kDay1970;
        return day * 86400e9 + time_ns;
      });
      break;
    case kParquetFloat:
      fill([&]() -> double { return bytes_.Little<float>(); });
      break;
    case kParquetBytes:
      fill([&] {
        return SecondsOfText(bytes_.Take(bytes_.Little<std::uint32_t>())).value_or(kMissing);
      });
      break;
    case kParquetFixedBytes:
      if (!leaf_->is_interval) {
        fill([&] { return ValueOfHalf(bytes_.Little<std::uint16_t>()); });
        break;
      }
      fill([&] {
        constexpr double kDay_ms = 86400e3;
        const auto months = bytes_.Little<std::uint32_t>();
        const double days = bytes_.Little<std::uint32_t>();
        const double time_ms = days * kDay_ms + bytes_.Little<std::uint32_t>();
        return months == 0 ? time_ms : kMissing;
      });
      break;
    default:
      fill([&] { return bytes_.Little<double>(); });
      break;
  }
  if (leaf_->factor == 1.0) return;
  for (double& value : values) value *= leaf_->factor;
}

}  // namespace gauntlet::sim
