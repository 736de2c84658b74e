#include "sim/base/json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "controller/assert.h"

namespace gauntlet::sim {

using Nlohmann = nlohmann::ordered_json;

/// The values of an array; of an object with their keys.
struct Json::Children {
  std::vector<Json> values = {};
  std::vector<std::string> keys = {};
};

/// Between a Json and nlohmann's value of the same type.
class JsonConverter {
 public:
  static Nlohmann Converted(const Json& json) {
    const Json::Content& content = json.content_;
    if (content.type == Json::Type::kDouble) return content.number;
    if (content.type == Json::Type::kSigned) return content.integer;
    if (content.type == Json::Type::kUnsigned) return static_cast<std::uint64_t>(content.integer);
    if (json.is_boolean()) return content.integer != 0;
    if (json.is_string()) return *content.text;
    if (json.is_discarded()) return Nlohmann::value_t::discarded;
    if (json.is_null()) return nullptr;
    const std::vector<Json>& values = content.children->values;
    if (json.is_array()) {
      Nlohmann::array_t array;
      for (const Json& value : values) array.push_back(Converted(value));
      return array;
    }
    Nlohmann::object_t object;
    for (std::size_t i = 0; i < values.size(); ++i) {
      object.emplace_back(content.children->keys[i], Converted(values[i]));
    }
    return object;
  }
};

namespace {

/// Builds a value from what nlohmann's parser finds, which calls its member functions.
class JsonBuilder {
 public:
  Json& result() { return result_; }
  const std::string& problem() const { return problem_; }

  bool null() { return Add(nullptr); }
  bool boolean(bool value) { return Add(value); }
  bool number_integer(std::int64_t value) { return Add(value); }
  bool number_unsigned(std::uint64_t value) { return Add(value); }
  bool number_float(double value, const std::string& /*text*/) { return Add(value); }
  bool string(std::string& text) { return Add(std::move(text)); }
  bool binary(Nlohmann::binary_t& /*bytes*/) { return false; }  // JSON has none
  bool start_object(std::size_t /*size*/) { return Open(Json::object()); }
  bool start_array(std::size_t /*size*/) { return Open(Json::array()); }
  bool key(const std::string& key) {
    value_of_key_ = &(*open_.back())[key];
    return true;
  }
  bool end_object() { return Close(); }
  bool end_array() { return Close(); }
  bool parse_error(std::size_t /*place*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) {
    problem_ = error.what();
    return false;
  }

 private:
  Json& Place(Json value) {
    if (open_.empty()) return result_ = std::move(value);
    if (open_.back()->is_array()) return open_.back()->emplace_back(std::move(value));
    return *value_of_key_ = std::move(value);
  }
  bool Add(Json value) {
    Place(std::move(value));
    return true;
  }
  bool Open(Json value) {
    open_.push_back(&Place(std::move(value)));
    return true;
  }
  bool Close() {
    open_.pop_back();
    return true;
  }

  Json result_;
  std::vector<Json*> open_;  // arrays and objects, each in the one before
  Json* value_of_key_ = nullptr;
  std::string problem_;
};

[[noreturn]] void FailAs(const char* wanted) {
  throw JsonError(std::string("a value of JSON is no ") + wanted);
}

}  // namespace

Json::Json(Type type) {
  content_.type = type;
  if (is_structured()) content_.children = new Children;
}
Json::Json(const Json& other) : content_(other.content_) {
  if (is_string()) content_.text = new std::string(*other.content_.text);
  if (is_structured()) content_.children = new Children(*other.content_.children);
}
Json::Json(Json&& other) noexcept { Swap(other); }
Json& Json::operator=(const Json& other) { return *this = Json(other); }
Json& Json::operator=(Json&& other) noexcept {
  const Json moved = std::move(other);  // `other` may be a part of this one
  Swap(moved);
  return *this;
}
Json::~Json() {
  if (is_string()) delete content_.text;
  if (is_structured()) Clear();
}

Json::Json(const char* text) : Json(std::string(text)) {}
Json::Json(std::string_view text) : Json(std::string(text)) {}
Json::Json(std::string text) {
  content_.text = new std::string(std::move(text));
  content_.type = Type::kString;
}
Json::Json(std::initializer_list<Json> elements) : Json(Type::kArray) {
  const bool is_object_in_braces = std::ranges::all_of(elements, [](const Json& element) {
    return element.is_array() && element.size() == 2 && element.front().is_string();
  });
  if (is_object_in_braces) content_.type = Type::kObject;
  for (const Json& element : elements) {
    Json moved;
    moved.Swap(element);
    if (!is_object_in_braces) {
      push_back(std::move(moved));
    } else if (const std::string& key = *moved.front().content_.text; !contains(key)) {
      (*this)[key] = std::move(moved.back());
    }
  }
}

/// Not as a recursion, since a text may be nested as deeply as it is long.
void Json::Clear() noexcept {
  std::vector<Json> nested;
  Children* children = content_.children;
  while (children != nullptr) {
    for (Json& value : children->values) {
      if (value.is_structured()) nested.push_back(std::move(value));
    }
    delete children;
    children = nullptr;
    if (nested.empty()) return;
    children = nested.back().content_.children;
    nested.back().content_ = {};
    nested.pop_back();
  }
}

void Json::Swap(const Json& other) const noexcept { std::swap(content_, other.content_); }

Json Json::array() { return Json(Type::kArray); }
Json Json::object() { return Json(Type::kObject); }

Json Json::parse(std::string_view text) {
  JsonBuilder builder;
  if (!Nlohmann::sax_parse(text, &builder)) throw JsonError(builder.problem());
  return std::move(builder.result());
}
Json Json::parse_or_discard(std::string_view text) {
  JsonBuilder builder;
  if (!Nlohmann::sax_parse(text, &builder)) return Json(Type::kDiscarded);
  return std::move(builder.result());
}

std::string Json::dump(int indent, InvalidText invalid) const {
  const auto handler = invalid == InvalidText::kReplaced ? Nlohmann::error_handler_t::replace
                                                         : Nlohmann::error_handler_t::strict;
  try {
    return JsonConverter::Converted(*this).dump(indent, ' ', false, handler);
  } catch (const Nlohmann::exception& error) {
    throw JsonError(error.what());
  }
}

bool Json::operator==(const Json& other) const {
  if (is_number() && other.is_number()) {
    return JsonConverter::Converted(*this) == JsonConverter::Converted(other);
  }
  if (content_.type != other.content_.type || is_discarded()) return false;
  if (is_string()) return *content_.text == *other.content_.text;
  if (is_object() && content_.children->keys != other.content_.children->keys) return false;
  if (is_structured()) return content_.children->values == other.content_.children->values;
  return content_.integer == other.content_.integer;
}

template <class Value>
Value Json::get() const {
  if constexpr (std::same_as<Value, std::string>) {
    if (!is_string()) FailAs("text");
    return *content_.text;
  } else if constexpr (std::is_arithmetic_v<Value>) {
    // As nlohmann has it, the widest types are those that are no boolean.
    const bool may_be_boolean = std::same_as<Value, bool> || sizeof(Value) < sizeof(std::int64_t);
    if (is_boolean() ? !may_be_boolean : !is_number() || std::same_as<Value, bool>) {
      FailAs(std::same_as<Value, bool> ? "boolean" : "number");
    }
    if (content_.type == Type::kDouble) return static_cast<Value>(content_.number);
    if (content_.type == Type::kSigned) return static_cast<Value>(content_.integer);
    return static_cast<Value>(static_cast<std::uint64_t>(content_.integer));
  } else {
    if (!is_array()) FailAs("array");
    Value elements;
    for (const Json& element : *this) elements.push_back(element.get<typename Value::value_type>());
    return elements;
  }
}
template bool Json::get() const;
template int Json::get() const;
template std::int64_t Json::get() const;
template std::uint32_t Json::get() const;
template std::uint64_t Json::get() const;
template double Json::get() const;
template std::string Json::get() const;
template std::vector<double> Json::get() const;
template std::vector<std::string> Json::get() const;

std::size_t Json::size() const {
  return is_structured() ? content_.children->values.size() : is_null() ? 0 : 1;
}
Json* Json::begin() { return is_structured() ? content_.children->values.data() : this; }
const Json* Json::begin() const {
  return is_structured() ? content_.children->values.data() : this;
}
const Json& Json::front() const {
  GAUNTLET_ASSERT(!empty());
  return *begin();
}
Json& Json::back() {
  GAUNTLET_ASSERT(!empty());
  return *(end() - 1);
}
std::vector<JsonItem> Json::items() const {
  std::vector<JsonItem> items;
  for (const Json& value : *this) {
    std::string key = is_object()  ? content_.children->keys[items.size()]
                      : is_array() ? std::to_string(items.size())
                                   : "";
    items.push_back({.key = std::move(key), .value = value});
  }
  return items;
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) *this = object();
  GAUNTLET_ASSERT(is_object());
  const auto place = static_cast<std::size_t>(std::as_const(*this).find(key) - begin());
  if (place == size()) {
    content_.children->keys.emplace_back(key);
    content_.children->values.emplace_back();
  }
  return content_.children->values[place];
}
const Json& Json::operator[](std::string_view key) const {
  const Json* const found = find(key);
  GAUNTLET_ASSERT(found != end());
  return *found;
}
Json& Json::operator[](std::size_t place) {
  GAUNTLET_ASSERT(is_array() && place < size());
  return content_.children->values[place];
}
const Json& Json::operator[](std::size_t place) const {
  GAUNTLET_ASSERT(is_array() && place < size());
  return content_.children->values[place];
}
const Json& Json::at(std::string_view key) const {
  if (!is_object()) FailAs("object");
  if (!contains(key)) throw JsonError("an object of JSON has no key " + std::string(key));
  return *find(key);
}
const Json* Json::find(std::string_view key) const {
  if (!is_object()) return end();
  const std::vector<std::string>& keys = content_.children->keys;
  return begin() + (std::ranges::find(keys, key) - keys.begin());
}
Json Json::value(std::string_view key, const Json& otherwise) const {
  if (!is_object()) FailAs("object");
  return contains(key) ? *find(key) : otherwise;
}

Json& Json::emplace_back(Json element) {
  if (is_null()) *this = array();
  GAUNTLET_ASSERT(is_array());
  return content_.children->values.emplace_back(std::move(element));
}
void Json::update(const Json& other) {
  if (is_null()) *this = object();
  GAUNTLET_ASSERT(is_object() && other.is_object());
  for (const auto& [key, value] : other.items()) (*this)[key] = value;
}

std::ostream& operator<<(std::ostream& stream, const Json& json) { return stream << json.dump(); }

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace gauntlet::sim
