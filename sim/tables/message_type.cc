#include "sim/tables/message_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

struct NamedKind {
  std::string_view name;
  FieldKind kind;
};
constexpr std::array<NamedKind, 18> kKinds = {
    {{"bool", FieldKind::kBool},
     {"byte", FieldKind::kUint8},
     {"char", FieldKind::kUint8},
     {"int8", FieldKind::kInt8},
     {"uint8", FieldKind::kUint8},
     {"int16", FieldKind::kInt16},
     {"uint16", FieldKind::kUint16},
     {"int32", FieldKind::kInt32},
     {"uint32", FieldKind::kUint32},
     {"int64", FieldKind::kInt64},
     {"uint64", FieldKind::kUint64},
     {"float32", FieldKind::kFloat32},
     {"float64", FieldKind::kFloat64},
     {"string", FieldKind::kText},
     {"builtin_interfaces/Time", FieldKind::kTime},
     {"builtin_interfaces/Duration", FieldKind::kDuration},
     {"time", FieldKind::kTime},
     {"duration", FieldKind::kDuration}}};

struct NamedText {
  std::string_view type;
  std::string_view text;
};
constexpr std::array<NamedText, 57> kKnown = {{
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"std_msgs/String", "string data\n"},
    {"std_msgs/Empty", ""},
    {"std_msgs/Bool", "bool data\n"},
    {"std_msgs/Byte", "byte data\n"},
    {"std_msgs/Char", "char data\n"},
    {"std_msgs/Float32", "float32 data\n"},
    {"std_msgs/Float64", "float64 data\n"},
    {"std_msgs/Int8", "int8 data\n"},
    {"std_msgs/Int16", "int16 data\n"},
    {"std_msgs/Int32", "int32 data\n"},
    {"std_msgs/Int64", "int64 data\n"},
    {"std_msgs/UInt8", "uint8 data\n"},
    {"std_msgs/UInt16", "uint16 data\n"},
    {"std_msgs/UInt32", "uint32 data\n"},
    {"std_msgs/UInt64", "uint64 data\n"},
    {"std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"},
    {"std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset\n"},
    {"std_msgs/Float32MultiArray", "MultiArrayLayout layout\nfloat32[] data\n"},
    {"std_msgs/Float64MultiArray", "MultiArrayLayout layout\nfloat64[] data\n"},
    {"std_msgs/Int8MultiArray", "MultiArrayLayout layout\nint8[] data\n"},
    {"std_msgs/Int16MultiArray", "MultiArrayLayout layout\nint16[] data\n"},
    {"std_msgs/Int32MultiArray", "MultiArrayLayout layout\nint32[] data\n"},
    {"std_msgs/Int64MultiArray", "MultiArrayLayout layout\nint64[] data\n"},
    {"std_msgs/UInt8MultiArray", "MultiArrayLayout layout\nuint8[] data\n"},
    {"std_msgs/UInt16MultiArray", "MultiArrayLayout layout\nuint16[] data\n"},
    {"std_msgs/UInt32MultiArray", "MultiArrayLayout layout\nuint32[] data\n"},
    {"std_msgs/UInt64MultiArray", "MultiArrayLayout layout\nuint64[] data\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Vector3Stamped", "std_msgs/Header header\nVector3 vector\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Point32", "float32 x\nfloat32 y\nfloat32 z\n"},
    {"geometry_msgs/PointStamped", "std_msgs/Header header\nPoint point\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/QuaternionStamped", "std_msgs/Header header\nQuaternion quaternion\n"},
    {"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
    {"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose\n"},
    {"geometry_msgs/PoseArray", "std_msgs/Header header\nPose[] poses\n"},
    {"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
    {"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
    {"geometry_msgs/TwistStamped", "std_msgs/Header header\nTwist twist\n"},
    {"geometry_msgs/Accel", "Vector3 linear\nVector3 angular\n"},
    {"geometry_msgs/AccelStamped", "std_msgs/Header header\nAccel accel\n"},
    {"geometry_msgs/Wrench", "Vector3 force\nVector3 torque\n"},
    {"geometry_msgs/WrenchStamped", "std_msgs/Header header\nWrench wrench\n"},
    {"sensor_msgs/JointState",
     "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] "
     "effort\n"},
    {"sensor_msgs/Imu",
     "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] "
     "orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\nfloat64[9] "
     "angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] "
     "linear_acceleration_covariance\n"},
    {"sensor_msgs/MagneticField",
     "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] "
     "magnetic_field_covariance\n"},
    {"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n"},
    {"sensor_msgs/FluidPressure",
     "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n"},
    {"sensor_msgs/Range",
     "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 "
     "min_range\nfloat32 max_range\nfloat32 range\nfloat32 variance\n"},
    {"sensor_msgs/Joy", "std_msgs/Header header\nfloat32[] axes\nint32[] buttons\n"},
    {"trajectory_msgs/JointTrajectoryPoint",
     "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] "
     "effort\nbuiltin_interfaces/Duration time_from_start\n"},
    {"trajectory_msgs/JointTrajectory",
     "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    {"rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n"},
}};

/// The first word of a text, which is taken away.
std::string_view TakeWord(std::string_view& text) {
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  const std::size_t end = std::min(text.find_first_of(" \t\r", begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

bool IsSeparator(std::string_view line) {
  constexpr std::size_t kShortest = 10;
  return line.size() >= kShortest && line.find_first_not_of('=') == std::string_view::npos;
}

/// Texts of the types, by their names.
using Texts = std::map<std::string, std::string, std::less<>>;

Texts SplitTexts(std::string_view type, std::string_view text) {
  Texts texts;
  std::string name = PlainTypeName(type);
  bool expects_name = false;
  for (const std::string_view line : SplitLines(text)) {
    const std::string_view trimmed = Trimmed(line);
    if (IsSeparator(trimmed)) {
      expects_name = true;
    } else if (expects_name && trimmed.starts_with("MSG:")) {
      name = PlainTypeName(Trimmed(trimmed.substr(4)));
      texts.try_emplace(name);  // a message may have no members
      expects_name = false;
    } else {
      texts[name].append(line).push_back('\n');
    }
  }
  return texts;
}

class TypeReader {
 public:
  explicit TypeReader(Texts texts) : texts_(std::move(texts)) {}

  std::size_t Read(const std::string& name, int depth) {
    constexpr int kMostNested = 16;
    if (depth > kMostNested) throw UserError("has messages that are nested too deeply");
    if (const auto known = places_.find(name); known != places_.end()) return known->second;
    const auto given = texts_.find(name);
    const bool is_given = given != texts_.end();
    std::string_view text = is_given ? std::string_view(given->second) : KnownMessage(name);
    if (!is_given && text.empty() && name != "std_msgs/Empty") {
      throw UserError(
          fmt::format("does not contain the definition of the type {}", OneLine(name, 60)));
    }
    MessageType type = {.name = name, .fields = {}};
    for (const std::string_view line : SplitLines(text)) {
      if (std::optional<MessageField> field = FieldIn(line, name, depth)) {
        type.fields.push_back(std::move(*field));
      }
    }
    if (type.fields.empty()) {  // as the generator of ROS 2 writes it
      type.fields.push_back({.name = std::string(kNoMember), .kind = FieldKind::kUint8});
    }
    const std::size_t place = types_.size();
    types_.push_back(std::move(type));
    places_[name] = place;
    return place;
  }

  /// With `root` in front.
  MessageTypes Take(std::size_t root) && {
    std::swap(types_.front(), types_[root]);
    for (MessageType& type : types_) {
      for (MessageField& field : type.fields) {
        if (field.kind != FieldKind::kMessage) continue;
        field.message = field.message == root ? 0 : field.message == 0 ? root : field.message;
      }
    }
    return std::move(types_);
  }

 private:
  /// Nothing for an empty line, a comment or a constant.
  std::optional<MessageField> FieldIn(std::string_view line, const std::string& of, int depth) {
    line = line.substr(0, line.find('#'));
    std::string_view word = TakeWord(line);
    const std::string_view name = TakeWord(line);
    if (word.empty()) return std::nullopt;
    if (name.empty()) {
      throw UserError(fmt::format("has a definition of {} that is not of ROS 2: {}",
                                  OneLine(of, 60), Shown(word)));
    }
    if (name.find('=') != std::string_view::npos || Trimmed(line).starts_with('=')) {
      return std::nullopt;
    }
    MessageField field = {.name = std::string(name)};
    if (const std::size_t bracket = word.find('['); bracket != std::string_view::npos) {
      const std::string_view size = word.substr(bracket + 1, word.find(']') - bracket - 1);
      field.shape = FieldShape::kSequence;
      if (!size.empty() && !size.starts_with("<=")) {
        field.shape = FieldShape::kArray;
        const auto [end, error] =
            std::from_chars(size.data(), size.data() + size.size(), field.length);
        if (error != std::errc() || end != size.data() + size.size()) {
          throw UserError(fmt::format("has a definition of {} that is not of ROS 2: {}",
                                      OneLine(of, 60), Shown(word)));
        }
      }
      word = word.substr(0, bracket);
    }
    word = word.substr(0, word.find("<="));  // a longest length of a text
    if (word == "wstring") {
      throw UserError(
          fmt::format("has wide strings in the type {}, which are not read", OneLine(of, 60)));
    }
    std::string type(word);
    if (const auto kind = KindOf(type)) {
      field.kind = *kind;
      return field;
    }
    type = PlainTypeName(type);
    if (type == "Header") type = "std_msgs/Header";
    if (type.find('/') == std::string::npos) type = of.substr(0, of.find('/') + 1) + type;
    if (const auto kind = KindOf(type)) {
      field.kind = *kind;
      return field;
    }
    field.kind = FieldKind::kMessage;
    field.message = Read(type, depth + 1);
    return field;
  }

  static std::optional<FieldKind> KindOf(std::string_view name) {
    const auto known = std::ranges::find(kKinds, name, &NamedKind::name);
    return known == kKinds.end() ? std::nullopt : std::optional(known->kind);
  }

  Texts texts_;
  std::map<std::string, std::size_t> places_;
  MessageTypes types_;
};

bool IsByte(FieldKind kind) {
  return kind == FieldKind::kInt8 || kind == FieldKind::kUint8 || kind == FieldKind::kBool;
}

bool HasSignals(const MessageTypes& types, const MessageType& type) {
  return std::ranges::any_of(type.fields, [&](const MessageField& field) {
    if (field.kind == FieldKind::kMessage) {
      const MessageType& part = types[field.message];
      return part.name != "std_msgs/MultiArrayLayout" && HasSignals(types, part);
    }
    if (field.kind == FieldKind::kFloat32 || field.kind == FieldKind::kFloat64) return true;
    return field.kind < FieldKind::kText && field.shape != FieldShape::kOne && !IsByte(field.kind);
  });
}

}  // namespace

std::string PlainTypeName(std::string_view type) {
  std::string plain(type);
  if (const std::size_t at = plain.find("/msg/"); at != std::string::npos) plain.erase(at, 4);
  return plain;
}

MessageTypes ReadRos2Msg(std::string_view type, std::string_view text) {
  TypeReader reader(text.empty() ? Texts() : SplitTexts(type, text));
  const std::size_t root = reader.Read(PlainTypeName(type), 0);
  return std::move(reader).Take(root);
}

std::string_view KnownMessage(std::string_view type) {
  const auto known = std::ranges::find(kKnown, PlainTypeName(type), &NamedText::type);
  return known == kKnown.end() ? std::string_view() : known->text;
}

bool HasSignals(const MessageTypes& types) {
  const std::string& name = types.front().name;
  const std::vector<MessageField>& fields = types.front().fields;
  const bool is_number =
      name.starts_with("std_msgs/") && fields.size() == 1 && fields.front().name != kNoMember &&
      fields.front().kind < FieldKind::kText && fields.front().shape == FieldShape::kOne;
  return is_number || HasSignals(types, types.front());
}

}  // namespace gauntlet::sim
