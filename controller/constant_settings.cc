#include "controller/constant_settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "controller/number.h"

namespace gauntlet::controller {
namespace {

class ConstantReader final : public SettingsVisitor {
 public:
  explicit ConstantReader(std::span<const ConstantSetting> settings) : settings_(settings) {}

  void Number(const Setting& setting, double& value) override { value = NextNumber(setting.key); }
  void Integer(const Setting& setting, int& value) override {
    const double number = NextNumber(setting.key);
    constexpr double kLeast = std::numeric_limits<int>::min();
    constexpr double kMost = std::numeric_limits<int>::max();
    const bool is_int = number >= kLeast && number <= kMost && number == std::round(number);
    if (!is_int) throw SettingError(std::string(setting.key), "must be a whole number");
    value = static_cast<int>(number);
  }
  void Flag(const Setting& setting, bool& value) override {
    const double number = NextNumber(setting.key);
    if (number != 0.0 && number != 1.0) {
      throw SettingError(std::string(setting.key), "must be 0 or 1");
    }
    value = number == 1.0;
  }
  void Text(const Setting& setting, std::string& value) override { value = NextText(setting.key); }
  void Path(const Setting& setting, std::string& value) override { Text(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    value.resize(NextSize(setting.key));
    for (double& number : value) number = NextNumber("");
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    value.resize(NextSize(setting.key));
    for (std::string& text : value) text = NextText("");
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    const std::string_view name = NextText(setting.key);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) Fail(setting.key, "has no choice " + std::string(name));
    index = static_cast<std::size_t>(found - names.begin());
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    NextNumber(setting.key);
    WithinSetting(std::string(setting.key), [&] { visit(*this); });
  }
  void List(const Setting& setting, const SettingList& list) override {
    const std::size_t size = NextSize(setting.key);
    list.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      WithinSetting(std::string(setting.key) + "[" + std::to_string(i) + "]",
                    [&] { list.visit(i, *this); });
    }
  }
  void Map(const Setting& setting, const SettingMap& map) override {
    const std::size_t size = NextSize(setting.key);
    for (std::size_t i = 0; i < size; ++i) {
      const std::string name(NextText(""));
      map.add(name);
      WithinSetting(std::string(setting.key) + "." + name, [&] { map.visit(i, *this); });
    }
  }

  void ExpectEnd() const {
    if (place_ < settings_.size()) Fail(settings_[place_].key, "is one setting too many");
  }

 private:
  [[noreturn]] static void Fail(std::string_view key, const std::string& problem) {
    throw SettingError(std::string(key),
                       problem + " in this version of the controller: export the settings again");
  }
  const ConstantSetting& Next(std::string_view key) {
    const std::string name = key.empty() ? "an item" : std::string(key);
    if (place_ == settings_.size()) Fail(name, "is missing");
    const ConstantSetting& next = settings_[place_];
    if (next.key != key) {
      Fail(name, "stands where the constants have " +
                     (next.key.empty() ? "another item" : std::string(next.key)));
    }
    ++place_;
    return next;
  }
  double NextNumber(std::string_view key) {
    const ConstantSetting& next = Next(key);
    if (next.is_text) throw SettingError(std::string(key), "must be a number");
    return next.number;
  }
  std::string_view NextText(std::string_view key) {
    const ConstantSetting& next = Next(key);
    if (!next.is_text) throw SettingError(std::string(key), "must be a text");
    return next.text;
  }
  /// Of a list, whose items follow: there cannot be more than there are settings left.
  std::size_t NextSize(std::string_view key) {
    const double size = NextNumber(key);
    const auto left = static_cast<double>(settings_.size() - place_);
    if (!(size >= 0.0 && size <= left)) {
      throw SettingError(std::string(key), "has another length than " + NumberText(size));
    }
    return static_cast<std::size_t>(size);
  }

  std::span<const ConstantSetting> settings_;
  std::size_t place_ = 0;
};

/// The constants that a text says, line by line.
class ConstantParser {
 public:
  explicit ConstantParser(std::string_view text) {
    for (int number = 1; !text.empty(); ++number) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      rest_ = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      WithinSetting("line " + std::to_string(number), [this] { ParseLine(); });
    }
  }
  std::span<const ConstantSetting> settings() const { return settings_; }

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
  /// What follows a backslash: three octal digits of a byte, or a character that is meant itself.
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
  std::vector<ConstantSetting> settings_;
};

}  // namespace

RobotConfig RobotFromConstants(std::span<const ConstantSetting> settings) {
  RobotConfig robot;
  ConstantReader reader(settings);
  robot.Visit(reader);
  reader.ExpectEnd();
  return robot;
}

RobotConfig RobotFromText(std::string_view text) {
  return RobotFromConstants(ConstantParser(text).settings());
}

}  // namespace gauntlet::controller
