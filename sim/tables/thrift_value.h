#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {

/// A value of Thrift's compact protocol. A number has only `number`, a text only `bytes`, a list
/// only `items`, a structure only `fields`; double numbers and maps are passed over.
/// Source: thrift/doc/specs/thrift-compact-protocol.md.
struct ThriftValue {
  std::int64_t number = 0;
  std::string_view bytes = {};  // of the file
  std::vector<ThriftValue> items = {};
  std::vector<std::pair<std::int64_t, ThriftValue>> fields = {};

  /// The field with this number, or an empty value.
  const ThriftValue& operator[](std::int64_t field) const;
  bool Has(std::int64_t field) const;
  std::int64_t NumberOr(std::int64_t field, std::int64_t otherwise) const;
};

/// The structure at the front of the bytes. Errors: UserError without a place.
ThriftValue ReadThrift(ByteReader& bytes);

}  // namespace gauntlet::sim
