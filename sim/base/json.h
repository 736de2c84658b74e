#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// A text that is no JSON, a value of another type than the reader asks for, or text to be written
/// that is not UTF-8.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Json;
struct JsonItem;

/// A range that no constructor of Json takes as something else.
template <class Range>
concept JsonRange =
    !std::same_as<Range, Json> && !std::convertible_to<const Range&, std::string_view> &&
    requires(const Range& range) {
  range.begin() != range.end();
};

/// A value of JSON; an object keeps the order of its keys. Members are called, and mean, what they
/// do in nlohmann::ordered_json, which json.cc reads and writes with: its header alone takes
/// seconds to compile, so no other file includes it.
class Json {
 public:
  using Iterator = Json*;
  using ConstIterator = const Json*;
  /// Bytes of a text that are not UTF-8 are an error, or become the replacement character.
  enum class InvalidText { kError, kReplaced };

  Json() noexcept = default;
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  // Values become JSON where they are named, as in `json["rate_hz"] = 200.0`.
  // NOLINTBEGIN(google-explicit-constructor)
  Json(std::nullptr_t) noexcept {}
  Json(const char* text);
  Json(std::string_view text);
  Json(std::string text);
  Json(std::vector<bool>::reference value) noexcept : Json(static_cast<bool>(value)) {}
  template <std::integral Number>
  Json(Number value) noexcept {
    content_.type = std::same_as<Number, bool> ? Type::kBoolean
                    : std::is_signed_v<Number> ? Type::kSigned
                                               : Type::kUnsigned;
    content_.integer = static_cast<std::int64_t>(value);
  }
  template <std::floating_point Number>
  Json(Number value) noexcept {
    content_.type = Type::kDouble;
    content_.number = value;
  }
  /// An object of a map with keys of text, an array of the elements of another range.
  template <JsonRange Range>
  Json(const Range& range) : Json(requires { typename Range::mapped_type; } ? object() : array()) {
    for (const auto& element : range) {
      static_assert(!std::same_as<std::remove_cvref_t<decltype(element)>, Range>, "a path");
      if constexpr (requires { typename Range::mapped_type; }) {
        (*this)[element.first] = element.second;
      } else {
        push_back(element);
      }
    }
  }
  /// An object if all elements are pairs of a text and a value ({{"seed", 1}, {"rate_hz", 200}}),
  /// of which the first one of a key counts; else an array. Elements are moved.
  Json(std::initializer_list<Json> elements);
  // NOLINTEND(google-explicit-constructor)

  static Json array();
  static Json object();

  /// The last value of a key counts. Errors: JsonError.
  static Json parse(std::string_view text);
  /// A value with is_discarded() where the text is no JSON.
  static Json parse_or_discard(std::string_view text);
  /// In one line, or with `indent` blanks for each level. Errors: JsonError.
  std::string dump(int indent = -1, InvalidText invalid = InvalidText::kError) const;

  bool is_null() const { return content_.type == Type::kNull; }
  bool is_boolean() const { return content_.type == Type::kBoolean; }
  bool is_number() const { return is_number_integer() || content_.type == Type::kDouble; }
  bool is_number_integer() const {
    return content_.type == Type::kSigned || content_.type == Type::kUnsigned;
  }
  bool is_string() const { return content_.type == Type::kString; }
  bool is_array() const { return content_.type == Type::kArray; }
  bool is_object() const { return content_.type == Type::kObject; }
  bool is_structured() const { return is_array() || is_object(); }
  bool is_discarded() const { return content_.type == Type::kDiscarded; }
  /// Numbers are compared as such: 1 == 1.0.
  bool operator==(const Json& other) const;

  /// The value as bool, int, std::int64_t, std::uint32_t, std::uint64_t, double, std::string, or a
  /// vector of double or std::string: only these link. Errors: JsonError for one of another type.
  template <class Value>
  Value get() const;

  /// Values of an array or object. A scalar is one value, as which it is itself; null has none.
  std::size_t size() const;
  bool empty() const { return size() == 0; }
  Iterator begin();
  Iterator end() { return begin() + size(); }
  ConstIterator begin() const;
  ConstIterator end() const { return begin() + size(); }
  const Json& front() const;
  Json& back();
  /// Values with their keys, which are numbers in an array.
  std::vector<JsonItem> items() const;

  /// A null becomes an object, and a new key gets a null.
  Json& operator[](std::string_view key);
  const Json& operator[](std::string_view key) const;
  Json& operator[](std::size_t place);
  const Json& operator[](std::size_t place) const;
  /// Errors: JsonError where there is none.
  const Json& at(std::string_view key) const;
  /// end() where there is none.
  ConstIterator find(std::string_view key) const;
  bool contains(std::string_view key) const { return find(key) != end(); }
  /// The value of the key, or `otherwise` without one. Errors: JsonError for no object.
  Json value(std::string_view key, const Json& otherwise) const;

  /// A null becomes an array.
  void push_back(Json element) { emplace_back(std::move(element)); }
  Json& emplace_back(Json element);
  /// The keys of another object replace, or follow, the own ones.
  void update(const Json& other);

 private:
  enum class Type : std::uint8_t {
    kNull,
    kBoolean,
    kSigned,
    kUnsigned,
    kDouble,
    kString,
    kArray,
    kObject,
    kDiscarded
  };
  struct Children;
  friend class JsonConverter;

  struct Content {
    Type type = Type::kNull;
    union {
      std::int64_t integer = 0;  // of kBoolean, kSigned, and the bits of kUnsigned
      double number;
      std::string* text;
      Children* children;
    };
  };

  explicit Json(Type type);
  void Swap(const Json& other) const noexcept;
  void Clear() noexcept;

  // Elements of a list in braces are constant, and are moved from all the same.
  mutable Content content_;
};

/// A value with its key.
struct JsonItem {
  std::string key;
  const Json& value;
};

/// In one line.
std::ostream& operator<<(std::ostream& stream, const Json& json);

/// A number as JSON can hold it: null where it is not finite.
Json NumberOrNull(double value);

}  // namespace gauntlet::sim
