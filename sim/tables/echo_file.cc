#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/message_file.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kEnd = "---";  // a line behind each message

/// `header` in the line `header: `; empty for a line of another kind, or with blanks before it.
std::string_view KeyOf(std::string_view line) {
  const std::string_view key = line.substr(0, line.find(':'));
  const bool is_name = !key.empty() && key.size() < line.size() &&
                       std::isdigit(static_cast<unsigned char>(key.front())) == 0 &&
                       std::ranges::all_of(key, [](unsigned char letter) {
                         return std::isalnum(letter) != 0 || letter == '_';
                       });
  const std::string_view rest = line.substr(std::min(key.size() + 1, line.size()));
  return is_name && (Trimmed(rest).empty() || rest.front() == ' ') ? key : "";
}

Json ValueOf(const YAML::Node& node, int depth = 0) {
  constexpr int kDeepest = 32;
  if (depth > kDeepest) FailAsDamaged("its messages are nested too deeply");
  if (node.IsMap()) {
    Json value = Json::object();
    for (const auto& part : node) {
      // ROS 1 has secs and nsecs where ROS 2 has sec and nanosec.
      const auto key = part.first.as<std::string>();
      value[key == "secs"    ? "sec"
            : key == "nsecs" ? "nanosec"
                             : key] = ValueOf(part.second, depth + 1);
    }
    return value;
  }
  if (node.IsSequence()) {
    Json value = Json::array();
    for (const YAML::Node& part : node) value.push_back(ValueOf(part, depth + 1));
    return value;
  }
  if (!node.IsScalar()) return nullptr;
  const std::string& text = node.Scalar();
  if (text == "...") {
    throw UserError("has shortened lists; ros2 topic echo --full-length writes whole ones");
  }
  const bool is_quoted = node.Tag() == "!";
  if (is_quoted) return text;
  constexpr double kMostWhole = 9e18;
  const auto number = controller::ParseNumber(text);
  if (number && *number == std::trunc(*number) && std::abs(*number) < kMostWhole) {
    return static_cast<std::int64_t>(*number);
  }
  if (number) return *number;
  if (text == ".nan" || text == "nan" || text == ".inf" || text == "-.inf" || text == "inf" ||
      text == "-inf") {
    return nullptr;
  }
  if (text == "true" || text == "True") return true;
  if (text == "false" || text == "False") return false;
  return text;
}

class EchoFile : public MessageFile {
 public:
  explicit EchoFile(const fs::path& file) : stream_(InputFile(file), std::ios::binary) {
    has_log_times_ = false;
    Topic topic;
    topic.name = file.stem().string();
    topic.encoding = "json";
    ForEachText([&topic](const std::string& text) {
      ++topic.messages;
      const auto has = [&text](const char* key) { return text.find(key) != std::string::npos; };
      if (topic.messages == 1 && has("\nname:") && has("\nposition:") && has("\nvelocity:") &&
          has("\neffort:")) {
        topic.type = "sensor_msgs/msg/JointState";
      }
    });
    topics_.push_back(std::move(topic));
  }

  void ForEachMessage(std::size_t /*topic*/, const Visit& visit) override {
    std::uint64_t number = 0;
    ForEachText([&](const std::string& text) {
      ++number;
      Json value;
      try {
        value = ValueOf(YAML::Load(text));
      } catch (const YAML::Exception& error) {
        FailAsDamaged(fmt::format("message {} is no YAML: {}", number, OneLine(error.msg, 60)));
      }
      visit(0, value.dump(-1, Json::InvalidText::kReplaced));
    });
  }

 private:
  template <class VisitText>
  void ForEachText(const VisitText& visit) {
    stream_.clear();
    stream_.seekg(0);
    std::string text;  // of the message, each line behind its beginning
    for (std::string line; std::getline(stream_, line);) {
      if (Trimmed(line) == kEnd) {
        if (!text.empty()) visit(text);
        text.clear();
      } else if (!Trimmed(line).empty()) {
        text += '\n';
        text += line;
      }
    }
    is_cut_ = !text.empty();
  }

  std::ifstream stream_;
};

}  // namespace

bool IsEcho(std::string_view head) {
  head = head.substr(0, head.rfind('\n') + 1);  // the last line may be cut
  std::string_view first_key;
  bool is_behind_end = false;
  for (const std::string_view line : SplitLines(head)) {
    if (Trimmed(line).empty()) continue;
    const std::string_view key = KeyOf(line);
    if (Trimmed(line) == kEnd) {
      is_behind_end = true;
    } else if (first_key.empty()) {
      if (key.empty()) return false;
      first_key = key;
      is_behind_end = false;
    } else if (is_behind_end) {
      return key == first_key;
    } else if (key.empty() && line.front() != ' ' && line.front() != '-') {
      return false;
    }
  }
  // A message may be longer than the head.
  return first_key == "header" && head.find("\n  stamp:") != std::string_view::npos;
}

std::unique_ptr<MessageFile> OpenEcho(const fs::path& file) {
  return std::make_unique<EchoFile>(file);
}

}  // namespace gauntlet::sim
