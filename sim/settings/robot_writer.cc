#include "sim/settings/robot_writer.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;

std::string Digits(double value) { return fmt::format("{}", value); }

/// A text as it may stand between braces: with quotes where it needs them.
std::string InFlow(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << YAML::BeginSeq << text << YAML::EndSeq;
  const std::string list = emitter.c_str();
  return list.substr(1, list.size() - 2);
}

/// `key: [a, b, ...]` over as many lines as it takes.
std::string WrappedList(const std::string& key, const std::vector<std::string>& texts) {
  constexpr std::size_t kWidth = 100;
  std::string list = "  " + key + ": [";
  const std::string indent(list.size(), ' ');
  std::size_t column = list.size();
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::string item = InFlow(texts[i]) + (i + 1 < texts.size() ? "," : "");
    if (i > 0 && column + item.size() + 1 > kWidth) {
      list += "\n" + indent;
      column = indent.size();
    } else if (i > 0) {
      list += " ";
      ++column;
    }
    list += item;
    column += item.size();
  }
  return list + "]\n";
}

/// Rows of a table: `name: {key: 1, ..}`, or `name: [1, ..]` for a matrix.
class Table {
 public:
  void BeginRow(const std::string& name, bool matrix) {
    rows_.push_back({.name = InFlow(name) + ":", .matrix = matrix, .cells = {}});
  }
  void Add(std::string cell) { rows_.back().cells.push_back(std::move(cell)); }

  /// `column_names` stand above a matrix.
  std::string Text(const std::vector<std::string>& column_names) const {
    const bool matrix = !rows_.empty() && rows_.front().matrix;
    std::vector<Row> rows = rows_;
    if (matrix) rows.insert(rows.begin(), {.name = "#", .matrix = true, .cells = column_names});
    std::size_t name_width = 0;
    std::vector<std::size_t> widths;
    for (const Row& row : rows) {
      name_width = std::max(name_width, row.name.size());
      widths.resize(std::max(widths.size(), row.cells.size()));
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        widths[i] = std::max(widths[i], row.cells[i].size());
      }
    }
    std::string text;
    for (const Row& row : rows) text += Line(row, name_width, widths);
    return text;
  }

 private:
  struct Row {
    std::string name;
    bool matrix = false;
    std::vector<std::string> cells;
  };

  static std::string Line(const Row& row, std::size_t name_width,
                          const std::vector<std::size_t>& widths) {
    const bool comment = row.name == "#";
    const char* open = comment ? " " : row.matrix ? "[" : "{";
    std::string line = fmt::format("    {:<{}} {}", row.name, name_width, open);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const bool last = i + 1 == row.cells.size();
      const std::string cell = row.cells[i] + (last || comment ? "" : ",");
      line += last ? cell : fmt::format("{:<{}} ", cell, widths[i] + 1);
    }
    return line + (comment ? "" : row.matrix ? "]" : "}") + "\n";
  }

  std::vector<Row> rows_;
};

/// Groups at the top of the file are sections; the groups in the sections of glove and hand are
/// tables, and what is in a table is its rows.
class RobotWriter final : public SettingsVisitor {
 public:
  explicit RobotWriter(const std::vector<std::string>& matrix_columns) : columns_(matrix_columns) {}

  void Number(const Setting& setting, double& value) override { Add(setting, Digits(value)); }
  void Integer(const Setting& setting, int& value) override {
    Add(setting, fmt::format("{}", value));
  }
  void Flag(const Setting& setting, bool& value) override {
    Add(setting, value ? "true" : "false");
  }
  void Text(const Setting& setting, std::string& value) override { Add(setting, InFlow(value)); }
  void Path(const Setting& setting, std::string& value) override { Text(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    Expect(level_ == Level::kTable, setting);
    table_.BeginRow(std::string(setting.key), true);
    for (const double number : value) table_.Add(Digits(number));
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    Expect(level_ == Level::kSection, setting);
    text_ += WrappedList(std::string(setting.key), value);
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Add(setting, InFlow(std::string(names[index])));
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    Expect(level_ != Level::kRow, setting);
    if (level_ == Level::kFile) {
      Section(setting, visit);
    } else if (level_ == Level::kSection) {
      text_ += fmt::format("  {}:  # {}\n", setting.key, setting.help);
      table_ = Table();
      Inside(Level::kTable, visit);
      text_ += table_.Text(columns_);
    } else {
      table_.BeginRow(std::string(setting.key), false);
      Inside(Level::kRow, visit);
    }
  }
  void List(const Setting& setting, const controller::SettingList&) override {
    Expect(false, setting);
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    Expect(level_ == Level::kFile, setting);
    Title(setting);
    text_ += SettingsToYaml([&](SettingsVisitor& plain) { plain.Map(setting, map); });
  }

  const std::string& text() const { return text_; }

 private:
  enum class Level { kFile, kSection, kTable, kRow };

  /// A robot's glove and hand have no other shapes.
  static void Expect(bool fits, const Setting& setting) {
    if (!fits) throw std::logic_error(std::string(setting.key) + ": no way to write it");
  }
  void Title(const Setting& setting) { text_ += fmt::format("\n# {}\n", setting.help); }
  void Section(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) {
    Title(setting);
    if (setting.key == "glove" || setting.key == "hand") {
      text_ += fmt::format("{}:\n", setting.key);
      Inside(Level::kSection, visit);
    } else {
      text_ += SettingsToYaml([&](SettingsVisitor& plain) { plain.Group(setting, visit); });
    }
  }
  void Add(const Setting& setting, const std::string& value) {
    const std::string line = fmt::format("{}: {}", setting.key, value);
    if (level_ == Level::kRow) {
      table_.Add(line);
    } else {
      Expect(level_ == Level::kSection, setting);
      text_ += "  " + line + "\n";
    }
  }
  void Inside(Level level, const std::function<void(SettingsVisitor&)>& visit) {
    const Level outer = std::exchange(level_, level);
    visit(*this);
    level_ = outer;
  }

  const std::vector<std::string>& columns_;
  Level level_ = Level::kFile;
  Table table_;
  std::string text_;
};

}  // namespace

std::string RobotSettingsToYaml(const controller::RobotConfig& robot) {
  controller::RobotConfig copy = robot;  // a visitor may change what it sees
  RobotWriter writer(robot.hand.joint_names);
  copy.Visit(writer);
  return writer.text();
}

}  // namespace gauntlet::sim
