#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/tables/array_files.h"
#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {
namespace {

/// The value behind `# key: `; none in another line.
std::optional<std::string_view> FactIn(std::string_view line, std::string_view key) {
  for (const std::string_view part : {std::string_view("# "), key, std::string_view(": ")}) {
    if (!line.starts_with(part)) return std::nullopt;
    line.remove_prefix(part.size());
  }
  return Trimmed(line);
}

/// A variable while its lines are read.
struct Variable {
  NamedArray array;
  std::string type = {};
  std::size_t rows = 0, columns = 0;  // of a matrix that is written row by row
  std::size_t dimensions = 0;         // that stand before the values, which go by columns; 0: none
  std::vector<double> values = {};
};

class OctaveReader {
 public:
  std::vector<NamedArray> Read(std::string_view text) {
    for (const std::string_view line : SplitLines(text)) ReadLine(Trimmed(line));
    Finish();
    return std::move(arrays_);
  }

 private:
  void ReadLine(std::string_view line) {
    if (const auto name = FactIn(line, "name")) {
      Finish();
      Begin(std::string(*name));
    } else if (const auto type = FactIn(line, "type")) {
      variable_.type = *type;
      if (variable_.type == "cell") {
        cells_ = variable_.array.name;
        cell_ = 0;
      }
    } else if (const auto rows = FactIn(line, "rows")) {
      variable_.rows = Size(*rows);
    } else if (const auto columns = FactIn(line, "columns")) {
      variable_.columns = Size(*columns);
    } else if (const auto dimensions = FactIn(line, "ndims")) {
      variable_.dimensions = Size(*dimensions);
    } else if (!line.starts_with('#') && HasNumbers()) {
      AddNumbers(line);
    }
  }

  void Begin(std::string name) {
    variable_ = {.array = {.name = std::move(name), .values = {}}};
    if (variable_.array.name != "<cell-element>") return;
    variable_.array.cells_of = cells_;
    variable_.array.name = variable_.array.cell = fmt::format("{}_{}", cells_, ++cell_);
  }

  bool HasNumbers() const {
    const std::string& type = variable_.type;
    return (type.ends_with("matrix") || type.ends_with("scalar") || type.ends_with("range") ||
            type == "bool") &&
           type.find("complex") == std::string::npos && type.find("sparse") == std::string::npos;
  }

  void AddNumbers(std::string_view line) {
    while (!line.empty()) {
      const std::string word(line.substr(0, line.find_first_of(" \t")));
      line = Trimmed(line.substr(word.size()));
      const std::optional<double> number = NumberOrMissing(word);
      if (!number) FailAsDamaged(fmt::format("{} has a value that is no number", Name()));
      variable_.values.push_back(*number);
    }
  }

  std::size_t Size(std::string_view text) const {
    const auto size = controller::ParseWholeNumber(std::string(text), 0, std::int64_t{1} << 32);
    if (!size) FailAsDamaged(fmt::format("{} has a wrong size", Name()));
    return static_cast<std::size_t>(*size);
  }

  const std::string& Name() const { return variable_.array.name; }

  void Finish() {
    const std::string& type = variable_.type;
    NamedArray& array = variable_.array;
    if (type.empty() || type.find("string") != std::string::npos || type.ends_with("struct") ||
        type == "cell") {
      return;
    }
    if (!HasNumbers()) {
      array.left_out = type;
    } else if (type.ends_with("range")) {
      if (variable_.values.size() != 3) FailAsDamaged(Name() + " is no range");
      const auto [base, limit, increment] =
          std::array{variable_.values[0], variable_.values[1], variable_.values[2]};
      NamedArray range =
          RangeArray(array.name, base, limit, increment, CountOfRange(base, limit, increment));
      range.cell = std::move(array.cell);
      range.cells_of = std::move(array.cells_of);
      array = std::move(range);
    } else {
      AddMatrix();
    }
    if (!array.left_out.empty() || !array.values.empty()) arrays_.push_back(std::move(array));
  }

  void AddMatrix() {
    std::vector<double>& values = variable_.values;
    std::vector<std::size_t> shape;
    if (variable_.type == "matrix" || variable_.rows > 0) {
      shape = {variable_.rows, variable_.columns};
    }
    if (variable_.dimensions > 0) {
      if (values.size() < variable_.dimensions) FailAsDamaged(Name() + " ends too early");
      const auto end = values.begin() + static_cast<std::ptrdiff_t>(variable_.dimensions);
      shape.clear();
      for (auto size = values.begin(); size != end; ++size) {
        shape.push_back(Size(fmt::format("{}", *size)));
      }
      values.erase(values.begin(), end);
    }
    std::size_t count = 1;
    for (const std::size_t size : shape) {
      if (size > 0 && count > values.size() / size) FailAsDamaged(Name() + " ends too early");
      count *= size;
    }
    if (count != values.size()) FailAsDamaged(Name() + " has another size than it says");
    if (count == 0) return;
    const bool is_by_columns = variable_.dimensions > 0;
    SetValues(variable_.array, std::move(values), shape,
              is_by_columns ? ArrayOrder::kColumns : ArrayOrder::kRows);
  }

  Variable variable_;
  std::string cells_;  // the cell array that was begun last
  int cell_ = 0;       // of its cells
  std::vector<NamedArray> arrays_;
};

}  // namespace

bool IsOctaveText(std::string_view head) {
  if (head.starts_with("# Created by Octave")) return true;
  const std::size_t end = head.find('\n');
  return head.starts_with("# name: ") && end != std::string_view::npos &&
         head.substr(end + 1).starts_with("# type: ");
}

std::vector<NamedArray> ReadOctaveText(std::string_view text) { return OctaveReader().Read(text); }

}  // namespace gauntlet::sim
