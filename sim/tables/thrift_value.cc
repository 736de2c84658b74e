#include "sim/tables/thrift_value.h"

#include <algorithm>

#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {
namespace {

constexpr int kMostNested = 16;

enum ThriftType {
  kThriftStop = 0,
  kThriftTrue = 1,
  kThriftFalse = 2,
  kThriftByte = 3,
  kThriftInt16 = 4,
  kThriftInt32 = 5,
  kThriftInt64 = 6,
  kThriftDouble = 7,
  kThriftBinary = 8,
  kThriftList = 9,
  kThriftSet = 10,
  kThriftMap = 11,
  kThriftStruct = 12
};

std::int64_t ZigZag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}

ThriftValue StructFrom(ByteReader& bytes, int nested);

ThriftValue ListFrom(ByteReader& bytes, int nested);

/// `in_list`: a flag is a byte there, and part of the type elsewhere.
ThriftValue ValueFrom(ByteReader& bytes, int type, bool in_list, int nested) {
  if (nested > kMostNested) FailAsDamaged("its description is nested too deep");
  switch (type) {
    case kThriftTrue:
    case kThriftFalse:
      return {.number = in_list ? bytes.Little<std::int8_t>() == kThriftTrue : type == kThriftTrue};
    case kThriftByte:
      return {.number = bytes.Little<std::int8_t>()};
    case kThriftInt16:
    case kThriftInt32:
    case kThriftInt64:
      return {.number = ZigZag(bytes.Varint())};
    case kThriftDouble:
      bytes.Take(sizeof(double));
      return {};
    case kThriftBinary:
      return {.bytes = bytes.Take(bytes.Varint())};
    case kThriftList:
    case kThriftSet:
      return ListFrom(bytes, nested);
    case kThriftMap: {
      const std::uint64_t size = bytes.Varint();
      const int types = size == 0 ? 0 : bytes.Little<std::uint8_t>();
      for (std::uint64_t i = 0; i < size; ++i) {
        ValueFrom(bytes, types >> 4, true, nested + 1);
        ValueFrom(bytes, types & 15, true, nested + 1);
      }
      return {};
    }
    case kThriftStruct:
      return StructFrom(bytes, nested);
    default:
      FailAsDamaged("its description has a type that there is not");
  }
}

ThriftValue ListFrom(ByteReader& bytes, int nested) {
  constexpr std::uint64_t kSizeFollows = 15;
  const int header = bytes.Little<std::uint8_t>();
  std::uint64_t size = static_cast<std::uint64_t>(header >> 4);
  if (size == kSizeFollows) size = bytes.Varint();
  // Each item takes a byte at least.
  if (size > bytes.rest().size()) FailAsDamaged("it ends too early");
  ThriftValue list;
  for (std::uint64_t i = 0; i < size; ++i) {
    list.items.push_back(ValueFrom(bytes, header & 15, true, nested + 1));
  }
  return list;
}

ThriftValue StructFrom(ByteReader& bytes, int nested) {
  ThriftValue value;
  std::int64_t id = 0;
  for (int header = bytes.Little<std::uint8_t>(); header != kThriftStop;
       header = bytes.Little<std::uint8_t>()) {
    const int delta = header >> 4;
    id = delta == 0 ? ZigZag(bytes.Varint()) : id + delta;
    value.fields.emplace_back(id, ValueFrom(bytes, header & 15, false, nested + 1));
  }
  return value;
}

}  // namespace

bool ThriftValue::Has(std::int64_t field) const {
  return std::ranges::find(fields, field, &std::pair<std::int64_t, ThriftValue>::first) !=
         fields.end();
}

const ThriftValue& ThriftValue::operator[](std::int64_t field) const {
  static const ThriftValue kEmpty;
  const auto found = std::ranges::find(fields, field, &std::pair<std::int64_t, ThriftValue>::first);
  return found == fields.end() ? kEmpty : found->second;
}

std::int64_t ThriftValue::NumberOr(std::int64_t field, std::int64_t otherwise) const {
  return Has(field) ? (*this)[field].number : otherwise;
}

ThriftValue ReadThrift(ByteReader& bytes) { return StructFrom(bytes, 0); }

}  // namespace gauntlet::sim
