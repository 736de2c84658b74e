#include "sim/recordings/array_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <map>

#include "sim/base/error.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

/// Far more columns than any glove has sensors.
bool LiesOnItsSide(const NamedArray& array) {
  constexpr std::size_t kMostSensors = 64;
  return array.rows <= kMostSensors && array.columns > 2 * array.rows &&
         (array.rows == 1 || array.columns > kMostSensors);
}

void Turn(NamedArray& array) {
  std::vector<double> turned(array.values.size());
  for (std::size_t row = 0; row < array.rows; ++row) {
    for (std::size_t column = 0; column < array.columns; ++column) {
      turned[column * array.rows + row] = array.values[row * array.columns + column];
    }
  }
  array.values = std::move(turned);
  std::swap(array.rows, array.columns);
}

bool IsRate(std::string_view name) {
  std::string bare;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) != 0) bare.push_back(static_cast<char>(std::tolower(byte)));
  }
  constexpr std::array<std::string_view, 12> kNames = {
      "fs",      "rate",       "ratehz",       "srate",     "samplerate", "samplingrate",
      "fsample", "samplefreq", "samplingfreq", "framerate", "fps",        "frequency"};
  return std::ranges::any_of(kNames, [&](std::string_view name_of_rate) {
    return std::string_view(bare).ends_with(name_of_rate) &&
           (bare.size() == name_of_rate.size() || name_of_rate.size() > 3);
  });
}

/// Fit for a line of names: no separators, no quotes.
std::string Plain(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char letter) { return std::isalnum(letter) == 0 && letter != '_'; }, '_');
  return name;
}

std::vector<std::string> NamesOf(const NamedArray& array) {
  std::vector<std::string> names;
  for (std::size_t column = 0; column < array.columns; ++column) {
    if (column < array.column_names.size()) {
      names.push_back(Plain(array.column_names[column]));
    } else {
      names.push_back(array.columns == 1 ? Plain(array.name)
                                         : fmt::format("{}_{}", Plain(array.name), column + 1));
    }
  }
  return names;
}

}  // namespace

void WriteTable(std::vector<NamedArray> arrays,
                const std::function<void(std::string_view)>& write) {
  std::map<std::size_t, std::size_t> values_of_rows;
  double rate_hz = 0.0;
  for (NamedArray& array : arrays) {
    if (LiesOnItsSide(array)) Turn(array);
    if (array.rows > 1) values_of_rows[array.rows] += array.values.size();
    if (array.values.size() == 1 && IsRate(array.name)) rate_hz = array.values.front();
  }
  const auto most =
      std::ranges::max_element(values_of_rows, {}, [](const auto& entry) { return entry.second; });
  if (most == values_of_rows.end()) throw UserError("holds no array of numbers with two rows");
  const std::size_t rows = most->first;
  std::erase_if(arrays, [rows](const NamedArray& array) { return array.rows != rows; });

  std::vector<std::string> names;
  for (const NamedArray& array : arrays)
    std::ranges::copy(NamesOf(array), std::back_inserter(names));
  const bool has_time = std::ranges::any_of(
      names, [](const std::string& name) { return TimeScaleS(name).has_value(); });
  const bool adds_time = rate_hz > 0.0 && !has_time;
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  if (adds_time) names.insert(names.begin(), "time_s");
  fmt::format_to(out, "{}\n", fmt::join(names, ","));
  for (std::size_t row = 0; row < rows; ++row) {
    if (adds_time) fmt::format_to(out, "{},", static_cast<double>(row) / rate_hz);
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      const NamedArray& array = arrays[a];
      for (std::size_t column = 0; column < array.columns; ++column) {
        if (a + column > 0) text.push_back(',');
        fmt::format_to(out, "{}", array.values[row * array.columns + column]);
      }
    }
    text.push_back('\n');
    constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
    if (text.size() < kBlockBytes && row + 1 < rows) continue;
    write({text.data(), text.size()});
    text.clear();
  }
}

}  // namespace gauntlet::sim
