#include "sim/tables/message_rows.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>

#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostColumns = 1000;
constexpr std::size_t kMostBytesInList = 64;  // more is an image or the like
constexpr int kDeepest = 32;
constexpr std::int64_t kNsPerS = 1000000000;

bool IsNamesKey(std::string_view key) {
  return key == "name" || key == "names" || key == "joint_names";
}

/// Fields of control_msgs and trajectory_msgs that are lists with a value for each joint.
constexpr std::array<std::string_view, 9> kPerJoint = {
    "position",      "positions", "velocity", "velocities", "acceleration",
    "accelerations", "effort",    "efforts",  "values"};

bool IsStampPath(std::string_view path) {
  return path == "header_stamp" || path == "stamp" || path == "timestamp";
}

std::string Join(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}_{}", path, key);
}

double SecondsOf(std::int64_t seconds, std::uint32_t ns) {
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(ns);
}

/// ZSTD's mark of a frame; CDR and JSON begin in other ways.
bool IsCompressed(std::string_view message) { return message.starts_with("\x28\xb5\x2f\xfd"); }

}  // namespace

/// A value, a list or a group of them, with its place in the row.
struct MessageRows::Node {
  std::string path;
  const Node* parent = nullptr;
  bool is_per_joint = false;  // by its name, a list with a value for each joint
  int column = -1;
  std::vector<std::pair<std::string, std::unique_ptr<Node>>> parts;
  std::vector<int> numbered;       // columns of a list by place
  std::vector<std::string> names;  // of a list, and the columns of these
  std::vector<int> named;
  std::map<std::string, int> by_name;

  Node& Part(std::size_t place, std::string_view key) {
    // Messages have the same parts in the same order, nearly always.
    if (place < parts.size() && parts[place].first == key) return *parts[place].second;
    const auto known = std::ranges::find(parts, key, [](const auto& part) { return part.first; });
    if (known != parts.end()) return *known->second;
    if (parts.size() >= kMostColumns) {
      throw UserError(fmt::format("has messages of more than {} values", kMostColumns));
    }
    auto part = std::make_unique<Node>();
    part->path = Join(path, key);
    part->parent = this;
    part->is_per_joint = std::ranges::find(kPerJoint, key) != kPerJoint.end();
    parts.emplace_back(std::string(key), std::move(part));
    return *parts.back().second;
  }
};

/// Reads one message of CDR.
class MessageRows::Cdr {
 public:
  Cdr(MessageRows& rows, std::string_view message) : rows_(rows) {
    constexpr std::size_t kHead = 4;
    ByteReader head(message);
    const auto first = head.Little<std::uint8_t>();
    const auto kind = head.Little<std::uint8_t>();
    if (first != 0 || kind > 1) {
      throw UserError(
          fmt::format("has messages of the CDR variant {:02x} {:02x}; only 00 00 and 00 01 are "
                      "read",
                      first, kind));
    }
    is_swapped_ = (kind == 1) != (std::endian::native == std::endian::little);
    body_ = message.substr(std::min(kHead, message.size()));
    ReadMessage(rows.types_.front(), *rows.root_, false, 0);
    if (body_.size() - at_ > most_padding_) {
      FailAsDamaged("a message is longer than its type");
    }
  }

 private:
  std::string_view Take(std::size_t size) {
    if (size > body_.size() - at_) FailAsDamaged("a message is shorter than its type");
    at_ += size;
    return body_.substr(at_ - size, size);
  }
  void Align(std::size_t size) { Take((size - at_ % size) % size); }

  template <class Number>
  Number Next() {
    Align(sizeof(Number));
    std::array<char, sizeof(Number)> bytes;
    std::ranges::copy(Take(sizeof(Number)), bytes.begin());
    if (is_swapped_) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  std::string_view Text() {
    const auto size = Next<std::uint32_t>();
    std::string_view text = Take(size);
    if (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    return text;
  }

  /// Calls `use` with a value of the type of a number.
  template <class Use>
  static auto OfType(FieldKind kind, const Use& use) {
    using enum FieldKind;
    if (kind == kInt8) return use(std::int8_t{});
    if (kind == kInt16) return use(std::int16_t{});
    if (kind == kUint16) return use(std::uint16_t{});
    if (kind == kInt32) return use(std::int32_t{});
    if (kind == kUint32) return use(std::uint32_t{});
    if (kind == kInt64) return use(std::int64_t{});
    if (kind == kUint64) return use(std::uint64_t{});
    if (kind == kFloat32) return use(float{});
    if (kind == kFloat64) return use(double{});
    return use(std::uint8_t{});  // kBool, too
  }

  double Number(FieldKind kind) {
    if (kind == FieldKind::kTime || kind == FieldKind::kDuration) {
      const auto seconds = Next<std::int32_t>();
      return SecondsOf(seconds, Next<std::uint32_t>());
    }
    return OfType(kind, [this](auto zero) { return static_cast<double>(Next<decltype(zero)>()); });
  }

  /// Least bytes of a value.
  static std::size_t SizeOf(FieldKind kind) {
    if (kind == FieldKind::kTime || kind == FieldKind::kDuration) return 8;
    if (kind == FieldKind::kText) return 4;
    return OfType(kind, [](auto zero) { return sizeof zero; });
  }

  void ReadMessage(const MessageType& type, Node& node, bool is_left_out, int depth) {
    if (depth > kDeepest) FailAsDamaged("its messages are nested too deeply");
    is_left_out = is_left_out || type.name == "std_msgs/MultiArrayLayout" ||
                  type.fields.front().name == kNoMember;
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      ReadField(type.fields[i], node.Part(i, type.fields[i].name), is_left_out, depth);
    }
  }

  void ReadField(const MessageField& field, Node& node, bool is_left_out, int depth) {
    if (field.shape != FieldShape::kOne) {
      const std::size_t size =
          field.shape == FieldShape::kArray ? field.length : Next<std::uint32_t>();
      constexpr std::size_t kEight = 8;
      if (size == 0 && SizeOf(field.kind) == kEight) most_padding_ += 4;
      if (size > (body_.size() - at_) / SizeOf(field.kind)) {
        FailAsDamaged("a message has a list that is longer than the message");
      }
      ReadList(field, size, node, is_left_out, depth);
      return;
    }
    if (field.kind == FieldKind::kMessage) {
      ReadMessage(rows_.types_[field.message], node, is_left_out, depth + 1);
    } else if (field.kind == FieldKind::kText) {
      Text();
    } else if (field.kind == FieldKind::kTime && IsStampPath(node.path)) {
      const auto seconds = Next<std::int32_t>();
      const std::int64_t ns = std::int64_t{seconds} * kNsPerS + Next<std::uint32_t>();
      if (ns != 0) rows_.stamp_ns_ = ns;
    } else {
      const double value = Number(field.kind);
      if (!is_left_out) rows_.SetNumber(node, value);
    }
  }

  void ReadList(const MessageField& field, std::size_t size, Node& node, bool is_left_out,
                int depth) {
    if (field.kind == FieldKind::kMessage) {
      for (std::size_t i = 0; i < size; ++i) {
        ReadMessage(rows_.types_[field.message], node.Part(i, std::to_string(i + 1)), is_left_out,
                    depth + 1);
      }
      return;
    }
    if (field.kind == FieldKind::kText) {
      const bool are_names = IsNamesKey(field.name) && size > 0;
      if (are_names) {
        rows_.names_.resize(size);
        rows_.names_parent_ = node.parent;
        ++rows_.name_lists_;
      }
      for (std::size_t i = 0; i < size; ++i) {
        const std::string_view text = Text();
        if (are_names) rows_.names_[i] = text;
      }
      return;
    }
    const std::size_t bytes = SizeOf(field.kind);
    if (bytes == 1 && size > kMostBytesInList) {
      Take(size);
      return;
    }
    if (size > kMostColumns) {
      throw UserError(fmt::format("has messages of more than {} values", kMostColumns));
    }
    if (!is_left_out) rows_.lists_.push_back({&node, rows_.list_values_.size(), size});
    for (std::size_t i = 0; i < size; ++i) {
      const double value = Number(field.kind);
      if (!is_left_out) rows_.list_values_.push_back(value);
    }
  }

  MessageRows& rows_;
  std::string_view body_;
  std::size_t at_ = 0;
  // Senders may count the place of an aligned element for each empty list, and leave it unset.
  std::size_t most_padding_ = 7;
  bool is_swapped_ = false;
};

/// Reads one message of JSON.
class MessageRows::Json {
 public:
  using Value = sim::Json;

  Json(MessageRows& rows, std::string_view message) : rows_(rows) {
    const Value value = Value::parse_or_discard(message);
    if (value.is_discarded()) FailAsDamaged("a message is no JSON");
    Read("", value, *rows.root_, 0);
  }

 private:
  static bool IsNumber(const Value& value) {
    return value.is_number() || value.is_boolean() || value.is_null();
  }
  static double NumberOf(const Value& value) {
    if (value.is_null()) return kMissing;
    return value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0) : value.get<double>();
  }

  /// A time of ROS: whole seconds and nanoseconds.
  static std::optional<std::int64_t> TimeOf(const Value& value) {
    if (!value.is_object() || value.size() != 2 || !value.contains("sec")) return std::nullopt;
    const char* const key = value.contains("nsec") ? "nsec" : "nanosec";
    if (!value.contains(key) || !value["sec"].is_number_integer() ||
        !value[key].is_number_integer()) {
      return std::nullopt;
    }
    const auto seconds = value["sec"].get<std::int64_t>();
    constexpr std::int64_t kMost_s = 9000000000;
    if (seconds < -kMost_s || seconds > kMost_s) return std::nullopt;
    return seconds * kNsPerS + value[key].get<std::uint32_t>();
  }

  void Read(std::string_view key, const Value& value, Node& node, int depth) {
    if (depth > kDeepest) FailAsDamaged("its messages are nested too deeply");
    if (const auto ns = TimeOf(value)) {
      if (!IsStampPath(node.path)) {
        rows_.SetNumber(node, 1e-9 * static_cast<double>(*ns));
      } else if (*ns != 0) {
        rows_.stamp_ns_ = *ns;
      }
    } else if (value.is_object()) {
      std::size_t place = 0;
      for (const auto& [name, part] : value.items()) {
        Read(name, part, node.Part(place++, name), depth + 1);
      }
    } else if (value.is_array()) {
      ReadList(key, value, node, depth);
    } else if (IsNumber(value)) {
      rows_.SetNumber(node, NumberOf(value));
    }
  }

  void ReadList(std::string_view key, const Value& value, Node& node, int depth) {
    if (value.size() > kMostColumns) {
      throw UserError(fmt::format("has messages of more than {} values", kMostColumns));
    }
    if (IsNamesKey(key) && !value.empty() && std::ranges::all_of(value, &Value::is_string)) {
      rows_.names_ = value.get<std::vector<std::string>>();
      rows_.names_parent_ = node.parent;
      ++rows_.name_lists_;
    } else if (std::ranges::all_of(value, IsNumber)) {
      rows_.lists_.push_back({&node, rows_.list_values_.size(), value.size()});
      for (const Value& number : value) rows_.list_values_.push_back(NumberOf(number));
    } else {
      const std::vector<std::string> names = NamesOfItems(value);
      for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string name = names.empty() ? std::to_string(i + 1) : names[i];
        Read(name, value[i], node.Part(i, name), depth + 1);
      }
    }
  }

  /// Names of the objects in a list, as joints of foxglove.JointStates have them: they may change
  /// their order. Empty unless all have one of their own.
  static std::vector<std::string> NamesOfItems(const Value& list) {
    for (const char* key : {"name", "child_frame_id", "joint"}) {
      std::vector<std::string> names;
      for (const Value& item : list) {
        if (!item.is_object() || !item.contains(key) || !item[key].is_string()) break;
        auto name = item[key].get<std::string>();
        if (name.empty() || std::ranges::find(names, name) != names.end()) break;
        names.push_back(std::move(name));
      }
      if (names.size() == list.size()) return names;
    }
    return {};
  }

  MessageRows& rows_;
};

MessageRows::MessageRows(const Topic& topic)
    : is_joint_state_(PlainTypeName(topic.type) == "sensor_msgs/JointState"),
      root_(std::make_unique<Node>()),
      column_counts_{{"time_s", 1}} {
  if (std::string problem = ProblemOf(topic); !problem.empty()) throw UserError(problem);
  if (topic.encoding == "cdr") {
    const bool has_text = topic.schema_encoding == "ros2msg";
    types_ = ReadRos2Msg(topic.type, has_text ? topic.schema : std::string());
  }
}

MessageRows::~MessageRows() = default;

void MessageRows::Read(std::string_view message) {
  stamp_ns_.reset();
  lists_.clear();
  list_values_.clear();
  names_.clear();
  name_lists_ = 0;
  std::ranges::fill(row_, kMissing);
  if (IsCompressed(message)) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
    const std::uint64_t size = ZSTD_getFrameContentSize(message.data(), message.size());
    if (size > kMostBytes) FailAsDamaged("a compressed message has no size");
    expanded_.resize(static_cast<std::size_t>(size));
    const std::size_t found =
        ZSTD_decompress(expanded_.data(), expanded_.size(), message.data(), message.size());
    if (ZSTD_isError(found) != 0 || found != size) FailAsDamaged("a message is not whole");
    message = expanded_;
  }
  if (types_.empty()) {
    Json(*this, message);
  } else {
    Cdr(*this, message);
  }
  SetLists();
}

void MessageRows::SetNumber(Node& node, double value) {
  if (node.column < 0) node.column = NewColumn(node.path.empty() ? "value" : node.path);
  row_[static_cast<std::size_t>(node.column)] = value;
}

int MessageRows::NewColumn(const std::string& path) {
  if (columns_.size() >= kMostColumns) {
    throw UserError(fmt::format("has messages of more than {} values", kMostColumns));
  }
  std::string name = path;
  std::ranges::replace_if(
      name, [](unsigned char letter) { return std::isalnum(letter) == 0 && letter != '_'; }, '_');
  const int before = column_counts_[name]++;
  if (before > 0) name += fmt::format("_{}", before + 1);
  columns_.push_back(name);
  row_.push_back(kMissing);
  return static_cast<int>(columns_.size() - 1);
}

void MessageRows::SetLists() {
  for (const List& list : lists_) {
    Node& node = *list.node;
    const std::string path = node.path.empty() ? "value" : node.path;
    const bool is_position = is_joint_state_ && path == "position";
    const auto new_column = [&](const std::string& name) {
      const int column = NewColumn(name);
      if (is_position) positions_.push_back(static_cast<std::size_t>(column));
      return column;
    };
    const std::vector<int>* columns = &node.numbered;
    const bool may_be_named = node.parent == names_parent_ || node.is_per_joint;
    if (name_lists_ == 1 && may_be_named && list.size == names_.size()) {
      if (node.names != names_) {
        node.names = names_;
        node.named.clear();
        for (const std::string& name : names_) {
          const auto [known, is_new] = node.by_name.try_emplace(name, -1);
          if (is_new) known->second = new_column(is_position ? name : Join(path, name));
          if (std::ranges::find(node.named, known->second) != node.named.end()) {
            throw UserError(fmt::format("has a message with two values of {}", Shown(name)));
          }
          node.named.push_back(known->second);
        }
      }
      columns = &node.named;
    } else {
      if (list.size > 0 && !node.named.empty()) {
        throw UserError(fmt::format("has a message with {} values of {} for {} names", list.size,
                                    OneLine(path, 60), names_.size()));
      }
      while (node.numbered.size() < list.size) {
        node.numbered.push_back(new_column(Join(path, std::to_string(node.numbered.size() + 1))));
      }
    }
    for (std::size_t i = 0; i < list.size; ++i) {
      row_[static_cast<std::size_t>((*columns)[i])] = list_values_[list.begin + i];
    }
  }
}

std::string ProblemOf(const Topic& topic) {
  if (!topic.problem.empty()) return topic.problem;
  if (topic.encoding == "json") return "";
  if (topic.encoding != "cdr") {
    return fmt::format("its messages are encoded as {}, not as cdr or json; write them as json",
                       topic.encoding.empty() ? "nothing known" : OneLine(topic.encoding, 30));
  }
  const bool has_text = topic.schema_encoding == "ros2msg" && !topic.schema.empty();
  if (!has_text && KnownMessage(topic.type).empty() && topic.type != "std_msgs/msg/Empty") {
    return fmt::format("the file has no definition of {} as ros2msg", OneLine(topic.type, 60));
  }
  try {
    ReadRos2Msg(topic.type, has_text ? topic.schema : std::string());
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace gauntlet::sim
