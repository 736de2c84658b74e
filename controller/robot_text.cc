#include "controller/robot_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/controller.h"
#include "controller/number.h"
#include "controller/robot_key.h"
#include "controller/validate.h"

namespace gauntlet::controller {
namespace {

/// The key of a setting and its value. A list or a map has its length as value, and its items
/// behind it.
struct TextSetting {
  std::string_view key;
  double number = 0.0;
  std::string_view text = {};
  bool is_text = false;

  TextSetting(std::string_view k, double value) : key(k), number(value) {}
  TextSetting(std::string_view k, std::string_view value) : key(k), text(value), is_text(true) {}
};

/// Takes the settings in the order of Visit(). One that is not there keeps its default, if it has
/// one and other settings follow: a text that was cut off must not pass for one with defaults. What
/// is unknown, given twice or out of order is left over, and refused at the end.
class SettingReader final : public SettingsVisitor {
 public:
  /// `lines`: of each setting.
  SettingReader(std::span<const TextSetting> settings, std::span<const int> lines)
      : settings_(settings), lines_(lines) {}

  void Number(const Setting& setting, double& value) override {
    if (!Has(setting)) return;
    value = NextNumber(setting.key);
    CheckRange(setting, value);
  }
  void Integer(const Setting& setting, int& value) override {
    if (!Has(setting)) return;
    const double number = NextNumber(setting.key);
    constexpr double kLeast = std::numeric_limits<int>::min();
    constexpr double kMost = std::numeric_limits<int>::max();
    const bool is_int = number >= kLeast && number <= kMost && number == std::round(number);
    if (!is_int) throw SettingError(std::string(setting.key), "must be a whole number");
    CheckRange(setting, number);
    value = static_cast<int>(number);
  }
  void Flag(const Setting& setting, bool& value) override {
    if (!Has(setting)) return;
    const double number = NextNumber(setting.key);
    if (number != 0.0 && number != 1.0) {
      throw SettingError(std::string(setting.key), "must be 0 or 1");
    }
    value = number == 1.0;
  }
  void Text(const Setting& setting, std::string& value) override {
    if (Has(setting)) value = NextText(setting.key);
  }
  void Path(const Setting& setting, std::string& value) override { Text(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    if (!Has(setting)) return;
    value.resize(NextSize(setting.key));
    if (const std::string problem = CountProblem(setting, value.size()); !problem.empty()) {
      throw SettingError(std::string(setting.key), problem);
    }
    for (double& number : value) {
      number = WithinSetting(std::string(setting.key), [this] { return NextNumber(""); });
      CheckRange(setting, number);
    }
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    if (!Has(setting)) return;
    value.resize(NextSize(setting.key));
    for (std::string& text : value) {
      text = WithinSetting(std::string(setting.key), [this] { return NextText(""); });
    }
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    if (!Has(setting)) return;
    const std::string_view name = NextText(setting.key);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      std::string choices;
      for (const std::string_view choice : names) {
        choices += (choices.empty() ? "" : ", ") + std::string(choice);
      }
      throw SettingError(std::string(setting.key),
                         "is " + std::string(name) + ", must be one of " + choices);
    }
    index = static_cast<std::size_t>(found - names.begin());
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    const bool has = Has(setting);
    if (has) NextNumber(setting.key);
    // Nothing of a group that is not there is taken from those behind it.
    absent_groups_ += has ? 0 : 1;
    Within(setting.key, [&] { visit(*this); });
    absent_groups_ -= has ? 0 : 1;
  }
  void List(const Setting& setting, const SettingList& list) override {
    if (!Has(setting)) return;
    const std::size_t size = NextSize(setting.key);
    list.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      Within(std::string(setting.key) + "[" + std::to_string(i) + "]",
             [&] { list.visit(i, *this); });
    }
  }
  void Map(const Setting& setting, const SettingMap& map) override {
    if (!Has(setting)) return;
    const std::size_t size = NextSize(setting.key);
    for (std::size_t i = 0; i < size; ++i) {
      const std::string name(
          WithinSetting(std::string(setting.key), [this] { return NextText(""); }));
      map.add(name);
      Within(std::string(setting.key) + "." + name, [&] { map.visit(i, *this); });
    }
  }

  bool ShowsOptional(const Setting& setting, bool given) override {
    return given || (absent_groups_ == 0 && place_ < settings_.size() &&
                     settings_[place_].key == setting.key);
  }
  /// A list has its length, and then items without a key.
  bool ShowsList(const Setting& setting, bool given) override {
    return given || (ShowsOptional(setting, false) && place_ + 1 < settings_.size() &&
                     settings_[place_ + 1].key.empty() && !settings_[place_ + 1].is_text);
  }

  void ExpectEnd() {
    at_ = place_;
    if (place_ != settings_.size()) throw Misplaced();
  }
  /// `error` with the line of the setting that was read last.
  SettingError WithLine(const SettingError& error) const {
    if (blocked_) return WithLine(Misplaced(), lines_[place_]);
    return at_ < lines_.size() ? WithLine(error, lines_[at_]) : error;
  }
  /// `error` of a key, with the line of what it names or is part of, if there is one.
  SettingError WithLineOf(const std::string& key, const std::string& problem) const {
    SettingError error(key, problem);
    std::string part = key;
    while (!part.empty()) {
      const auto found = line_of_.find(part);
      if (found != line_of_.end()) return WithLine(error, found->second);
      part.resize(std::min(part.find_last_of(".["), part.size() - 1));
    }
    return error;
  }

 private:
  /// The error of the next setting.
  SettingError Misplaced() const {
    return {settings_[place_].key.empty() ? "an item" : std::string(settings_[place_].key),
            "is not a setting in this place: it is unknown, given twice or out of order"};
  }
  bool IsLeft(std::string_view key) const {
    return std::ranges::find(settings_.subspan(place_), key, &TextSetting::key) != settings_.end();
  }
  static SettingError WithLine(const SettingError& error, int line) {
    return {"line " + std::to_string(line) + ": " + error.key(), error.problem()};
  }
  static void CheckRange(const Setting& setting, double value) {
    if (const std::string problem = RangeProblem(setting, value); !problem.empty()) {
      throw SettingError(std::string(setting.key), problem);
    }
  }
  template <class Work>
  void Within(std::string_view key, const Work& work) {
    const std::size_t length = path_.size();
    path_ = PathOf(key);
    WithinSetting(std::string(key), work);
    path_.resize(length);
  }
  std::string PathOf(std::string_view key) const {
    std::string path = path_;
    if (!path.empty()) path += '.';
    path += key;
    return path;
  }
  /// True if the setting comes next. False: it keeps its default.
  bool Has(const Setting& setting) {
    at_ = place_;
    if (absent_groups_ == 0 && place_ < settings_.size() && settings_[place_].key == setting.key) {
      line_of_[PathOf(setting.key)] = lines_[place_];
      passed_ = 0;
      return true;
    }
    if (setting.required || place_ == settings_.size()) {
      // Neither it nor some before it are missing: the next one is in their way.
      blocked_ = IsLeft(setting.key) && passed_ > 0;
      throw SettingError(std::string(setting.key), "is missing");
    }
    passed_ += IsLeft(setting.key) ? 1 : 0;
    return false;
  }
  const TextSetting& Next(std::string_view key) {
    at_ = place_;
    if (place_ == settings_.size() || settings_[place_].key != key) {
      throw SettingError("", "has too few values");
    }
    return settings_[place_++];
  }
  double NextNumber(std::string_view key) {
    const TextSetting& next = Next(key);
    if (next.is_text) throw SettingError(std::string(key), "must be a number");
    return next.number;
  }
  std::string_view NextText(std::string_view key) {
    const TextSetting& next = Next(key);
    if (!next.is_text) throw SettingError(std::string(key), "must be a text");
    return next.text;
  }
  /// Size of a list, whose items follow: there cannot be more than there are settings left.
  std::size_t NextSize(std::string_view key) {
    const double size = NextNumber(key);
    const auto left = static_cast<double>(settings_.size() - place_);
    if (!(size >= 0.0 && size <= left)) {
      throw SettingError(std::string(key), "has another length than " + NumberText(size));
    }
    return static_cast<std::size_t>(size);
  }

  std::span<const TextSetting> settings_;
  std::span<const int> lines_;
  std::size_t place_ = 0;  // of the next setting
  std::size_t at_ = 0;     // of the one that is read
  int passed_ = 0;         // settings that were not next, but are further on
  bool blocked_ = false;   // by the next one
  int absent_groups_ = 0;  // around it
  std::string path_;       // of the group around it
  std::map<std::string, int, std::less<>> line_of_;
};

/// The settings that a text says, line by line.
class TextParser {
 public:
  explicit TextParser(std::string_view text) {
    for (int number = 1; !text.empty(); ++number) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      rest_ = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      WithinSetting("line " + std::to_string(number), [this] { ParseLine(); });
      lines_.resize(settings_.size(), number);
    }
  }
  std::span<const TextSetting> settings() const { return settings_; }
  std::span<const int> lines() const { return lines_; }

 private:
  void ParseLine() {
    SkipBlanks();
    if (rest_.empty() || rest_.front() == '#') return;
    std::string_view key = rest_.front() == '"' ? TakeQuoted() : TakeWord("=");
    SkipBlanks();
    if (rest_.empty() || rest_.front() != '=') {
      throw SettingError("", "must be a key, \"=\" and its values");
    }
    rest_.remove_prefix(1);
    SkipBlanks();
    if (rest_.empty()) settings_.emplace_back(key, 0.0);
    for (; !rest_.empty(); SkipBlanks()) {
      if (rest_.front() == '"') {
        settings_.emplace_back(key, TakeQuoted());
      } else {
        settings_.emplace_back(key, TakeNumber());
      }
      key = "";
    }
  }
  void SkipBlanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
  }
  std::string_view TakeWord(const std::string& until) {
    const std::size_t end = std::min(rest_.find_first_of(" \t\r" + until), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }
  double TakeNumber() {
    const std::string_view word = TakeWord("\"");
    const std::optional<double> number = ParseNumber(word);
    if (!number) {
      throw SettingError(
          "", "has " + std::string(word) + " behind \"=\", must be numbers or texts in quotes");
    }
    return *number;
  }
  char TakeCharacter() {
    const char character = rest_.front();
    rest_.remove_prefix(1);
    return character;
  }
  std::string_view TakeQuoted() {
    std::string& text = texts_.emplace_back();
    TakeCharacter();
    while (!rest_.empty() && rest_.front() != '"') {
      const char character = TakeCharacter();
      text += character == '\\' && !rest_.empty() ? TakeEscaped() : character;
    }
    if (rest_.empty()) throw SettingError("", "has a quote that does not end");
    TakeCharacter();
    return text;
  }
  /// Character behind a backslash: three octal digits of a byte, or one that is meant itself.
  char TakeEscaped() {
    constexpr int kOctal = 8;
    const std::string_view digits = rest_.substr(0, 3);
    unsigned char byte = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), byte, kOctal);
    if (error != std::errc() || end != digits.data() + 3) return TakeCharacter();
    rest_.remove_prefix(3);
    return static_cast<char>(byte);
  }

  std::string_view rest_;          // of the line
  std::deque<std::string> texts_;  // which the settings refer to
  std::vector<TextSetting> settings_;
  std::vector<int> lines_;  // of each setting
};

}  // namespace

std::string KeyInText(const std::string& key) {
  constexpr std::pair<std::string_view, std::string_view> kGroups[] = {
      {"calibration", "glove"}, {"transmission", "hand"}, {"joint_map", "joint_map"},
      {"timing", "timing"},     {"", "controller."},
  };
  for (const auto& [theirs, ours] : kGroups) {
    if (key.starts_with(theirs)) return std::string(ours) + key.substr(theirs.size());
  }
  return key;
}

namespace {

/// The settings of a text, each within its range.
RobotConfig SettingsOf(SettingReader& reader) {
  RobotConfig robot;
  try {
    robot.Visit(reader);
    reader.ExpectEnd();
  } catch (const SettingError& error) {
    throw reader.WithLine(error);
  }
  return robot;
}

}  // namespace

RobotConfig RobotFromText(std::string_view text) {
  const TextParser parser(text);
  SettingReader reader(parser.settings(), parser.lines());
  RobotConfig robot = SettingsOf(reader);
  try {
    const Controller made(robot);
  } catch (const SettingError& error) {
    throw reader.WithLineOf(KeyInText(error.key()), error.problem());
  }
  return robot;
}

std::vector<std::string> ProblemsOfText(std::string_view text) {
  std::vector<std::string> lines;
  try {
    const TextParser parser(text);
    SettingReader reader(parser.settings(), parser.lines());
    for (RobotProblem& problem : Validate(SettingsOf(reader))) {
      problem.key = reader.WithLineOf(problem.key, problem.problem).key();
      lines.push_back(TextOf(problem));
    }
  } catch (const SettingError& error) {
    lines = {error.what()};
  }
  return lines;
}

}  // namespace gauntlet::controller
