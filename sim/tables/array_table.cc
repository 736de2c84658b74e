#include "sim/tables/array_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include "controller/assert.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostSensors = 64;  // of any glove

/// Far more columns than any glove has sensors.
bool LiesOnItsSide(const NamedArray& array) {
  return array.is_flat && array.rows <= kMostSensors && array.columns > 2 * array.rows &&
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
  const std::string bare = BareName(name);
  constexpr std::array<std::string_view, 6> kEnds = {"rate",       "ratehz",       "fsample",
                                                     "samplefreq", "samplingfreq", "frequency"};
  const std::string last = BareName(name.substr(name.rfind('_') + 1));  // behind its groups
  return last == "fs" || last == "fps" ||
         std::ranges::any_of(kEnds, [&](std::string_view end) { return bare.ends_with(end); });
}

/// Hz of a duration between rows, in s or ms; 0 if either may be meant.
double RateOfPeriod(double period) {
  constexpr double kLongest_s = 0.1;
  if (period > 0.0 && period <= kLongest_s) return 1.0 / period;
  return period >= 1.0 && period <= 1e3 ? 1e3 / period : 0.0;
}

bool IsPeriod(std::string_view name) {
  const std::string bare = BareName(name);
  constexpr std::array<std::string_view, 5> kEnds = {
      "frameduration", "sampleperiod", "samplingperiod", "sampletime", "samplinginterval"};
  return bare == "dt" ||
         std::ranges::any_of(kEnds, [&](std::string_view end) { return bare.ends_with(end); });
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

/// Rows once it does not lie on its side.
std::size_t RowsOf(const NamedArray& array) {
  return LiesOnItsSide(array) ? array.columns : array.rows;
}

/// Part of a name before its last word: `glove_` of `glove_angles`.
std::string GroupOf(const std::string& name) {
  const std::size_t cut = name.rfind('_');
  return cut == std::string::npos ? "" : name.substr(0, cut + 1);
}

/// The group of a time, `glove_` of `glove_time_s`; nothing of what is none.
std::optional<std::string> GroupOfTime(const NamedArray& array) {
  if (array.count() != RowsOf(array)) return std::nullopt;
  const std::string name = Plain(array.name);
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    if (begin > 0 && name[begin - 1] != '_') continue;
    if (TimeScaleS(name.substr(begin))) return name.substr(0, begin);
  }
  return std::nullopt;
}

/// Marks what `chosen` names.
void MarkChosen(const std::vector<NamedArray>& arrays, std::string_view chosen,
                std::vector<ListedArray>& listed) {
  const std::string wanted = Plain(std::string(chosen));
  const auto mark = [&](const auto& is_wanted) {
    bool any = false;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      listed[i].is_taken = is_wanted(Plain(arrays[i].name));
      any = any || listed[i].is_taken;
    }
    return any;
  };
  if (mark([&](const std::string& name) { return name == wanted; })) return;
  if (mark([&](const std::string& name) { return name.starts_with(wanted + "_"); })) return;
  throw UserError(fmt::format("holds no array {}, but {}", Shown(chosen), TextOf(listed)));
}

/// The weight of an array in the choice of the table. An inertial sensor sends more numbers than a
/// glove, and says less of its joints: it is the table where it is alone.
std::size_t WeightOf(const NamedArray& array) {
  constexpr std::string_view kInertial =
      "imu acc accel acceleration accelerometer gyro gyroscope mag magnetometer";
  constexpr std::size_t kLess = 100;
  const bool is_inertial = HasWordOf(WordsOf(array.name), kInertial);
  return is_inertial ? (array.count() + kLess - 1) / kLess : array.count();
}

/// Leaves marked what has the number of rows that holds the most values; gives that number.
/// `left_out`: lines about arrays that are not read.
std::size_t KeepMostRows(const std::vector<NamedArray>& arrays,
                         const std::vector<std::string>& left_out,
                         std::vector<ListedArray>& listed) {
  std::map<std::size_t, std::size_t> values_of_rows;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (!listed[i].is_taken || RowsOf(arrays[i]) < 2) continue;
    values_of_rows[RowsOf(arrays[i])] += WeightOf(arrays[i]);
  }
  const auto most =
      std::ranges::max_element(values_of_rows, {}, [](const auto& entry) { return entry.second; });
  if (most == values_of_rows.end()) {
    throw UserError(fmt::format("holds no array of numbers with two rows{}{}",
                                left_out.empty() ? "" : "; ", fmt::join(left_out, "; ")));
  }
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    listed[i].is_taken = listed[i].is_taken && RowsOf(arrays[i]) == most->first;
  }
  return most->first;
}

/// Marks times with so many rows, unless a time is marked already: those of the group of what is
/// marked, or else the first.
void AddTimes(const std::vector<NamedArray>& arrays, std::size_t rows,
              std::vector<ListedArray>& listed) {
  std::string group;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (!listed[i].is_taken) continue;
    if (GroupOfTime(arrays[i])) return;
    group = GroupOf(Plain(arrays[i].name));
  }
  std::vector<std::size_t> times;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (GroupOfTime(arrays[i]) && RowsOf(arrays[i]) == rows) times.push_back(i);
  }
  const auto is_of_group = [&](std::size_t i) { return GroupOfTime(arrays[i]) == group; };
  const bool has_own = std::ranges::any_of(times, is_of_group);
  if (!has_own && times.size() > 1) times.erase(times.begin() + 1, times.end());
  for (const std::size_t i : times) listed[i].is_taken = !has_own || is_of_group(i);
}

/// Errors: UserError if several cells of one cell array are marked, or one of several that only
/// differ in their number of rows.
void CheckCells(const std::vector<NamedArray>& arrays, const std::vector<ListedArray>& before,
                const std::vector<ListedArray>& listed) {
  constexpr std::size_t kFewestRows = 10;  // of a recording
  const auto is_like_a_marked_one = [&](std::size_t other) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const NamedArray& array = arrays[i];
      if (listed[i].is_taken && array.cells_of == arrays[other].cells_of &&
          array.columns == arrays[other].columns &&
          array.name.substr(std::min(array.name.size(), array.cell.size())) ==
              arrays[other].name.substr(
                  std::min(arrays[other].name.size(), arrays[other].cell.size()))) {
        return true;
      }
    }
    return false;
  };
  struct Cells {
    std::set<std::string> names;
    std::vector<ListedArray> arrays;
  };
  std::map<std::string, Cells> cells;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (arrays[i].cells_of.empty() || !before[i].is_taken) continue;
    const bool is_alike = RowsOf(arrays[i]) >= kFewestRows && is_like_a_marked_one(i);
    if (!listed[i].is_taken && !is_alike) continue;
    Cells& of = cells[arrays[i].cells_of];
    of.names.insert(arrays[i].cell);
    of.arrays.push_back(listed[i]);
  }
  for (const auto& [name, of] : cells) {
    if (of.names.size() < 2) continue;
    const bool is_array = of.arrays.size() == of.names.size();
    throw UserError(fmt::format("has {} recordings in {}: {}; --array {} takes one",
                                of.names.size(), OneLine(name, 60), TextOf(of.arrays),
                                is_array ? "NAME" : OneLine(*of.names.begin(), 60)));
  }
}

bool IsLeftOut(const NamedArray& array) { return !array.left_out.empty(); }

/// Removes the arrays that are left out, and returns a line for each reason: `left out: a, b
/// (complex numbers)`. Errors: UserError if the chosen one is among them.
std::vector<std::string> RemoveLeftOut(std::vector<NamedArray>& arrays, std::string_view chosen) {
  constexpr std::size_t kMostNames = 8;
  std::map<std::string, std::vector<std::string>> names_of;  // by reason
  for (const NamedArray& array : arrays) {
    if (!IsLeftOut(array)) continue;
    const std::string reason = OneLine(array.left_out, 100);
    if (!chosen.empty() && Plain(array.name) == Plain(std::string(chosen))) {
      throw UserError(fmt::format("holds {}, which is left out ({})", Shown(chosen), reason));
    }
    names_of[reason].push_back(OneLine(array.name, 60));
  }
  std::erase_if(arrays, IsLeftOut);
  std::vector<std::string> lines;
  for (auto& [reason, names] : names_of) {
    const std::size_t more = names.size() - std::min(names.size(), kMostNames);
    names.resize(names.size() - more);
    lines.push_back(fmt::format("left out: {}{} ({})", fmt::join(names, ", "),
                                more > 0 ? fmt::format(" and {} more", more) : "", reason));
  }
  return lines;
}

/// Without the group that was chosen, or the group of a time.
std::string NameInTable(const NamedArray& array, std::string_view chosen) {
  const std::string name = Plain(array.name);
  const std::string group = Plain(std::string(chosen)) + "_";
  if (name.starts_with(group)) return name.substr(group.size());
  return name.substr(GroupOfTime(array).value_or("").size());
}

/// ListArrays() for arrays that are all read; `left_out`: lines about others.
std::vector<ListedArray> Listed(const std::vector<NamedArray>& arrays,
                                const std::vector<std::string>& left_out, std::string_view chosen) {
  std::vector<ListedArray> listed;
  for (const NamedArray& array : arrays) {
    listed.push_back(
        {.name = array.name, .rows = array.rows, .columns = array.columns, .is_taken = true});
  }
  if (!chosen.empty()) MarkChosen(arrays, chosen, listed);
  const std::vector<ListedArray> before = listed;
  const std::size_t rows = KeepMostRows(arrays, left_out, listed);
  CheckCells(arrays, before, listed);
  if (!chosen.empty()) AddTimes(arrays, rows, listed);
  return listed;
}

/// The arrays of the table, upright and with their names in it.
std::vector<NamedArray> SelectedArrays(std::vector<NamedArray> arrays,
                                       const std::vector<std::string>& left_out,
                                       std::string_view chosen) {
  const std::vector<ListedArray> listed = Listed(arrays, left_out, chosen);
  std::vector<NamedArray> taken;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (!listed[i].is_taken) continue;
    if (LiesOnItsSide(arrays[i])) {
      ReadValues(arrays[i]);
      Turn(arrays[i]);
    }
    if (!chosen.empty()) arrays[i].name = NameInTable(arrays[i], chosen);
    taken.push_back(std::move(arrays[i]));
  }
  return taken;
}

/// The rate that is noted beside the arrays that are taken, if they agree. Else a lone number: of
/// the innermost group that also holds the first array that is taken; a rate before a period, the
/// last before others. 0 if there is none.
double RateIn(std::vector<NamedArray>& arrays, const std::vector<ListedArray>& listed) {
  std::set<double> noted;
  std::string place;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (!listed[i].is_taken) continue;
    if (place.empty()) place = arrays[i].name;
    if (arrays[i].rate_hz > 0.0) noted.insert(arrays[i].rate_hz);
  }
  if (noted.size() == 1) return *noted.begin();
  double rate_hz = 0.0;
  std::tuple<std::size_t, bool> best = {0, false};
  for (NamedArray& array : arrays) {
    if (array.count() != 1) continue;
    ReadValues(array);
    const double own_hz = RateOf(array.name, array.values.front());
    const std::string group = GroupOf(array.name);
    const std::tuple<std::size_t, bool> rank = {place.starts_with(group) ? group.size() + 1 : 0,
                                                IsRate(array.name)};
    if (!(own_hz > 0.0) || (rate_hz > 0.0 && rank < best)) continue;
    rate_hz = own_hz;
    best = rank;
  }
  return rate_hz;
}

/// True for numbers of sensors that texts of this name may be about: of its group, and no time.
bool IsAbout(const NamedArray& texts, const NamedArray& array) {
  return array.texts.empty() && array.count() > RowsOf(array) && RowsOf(array) > 1 &&
         array.name.starts_with(GroupOf(texts.name));
}

std::size_t SensorsOf(const NamedArray& array) {
  return LiesOnItsSide(array) ? array.rows : array.columns;
}

/// `deg` or `rad` for a text that is such a unit.
std::string AngleUnitOf(std::string_view text) {
  const std::string unit = BareName(text);
  if (unit == "rad" || unit == "radian" || unit == "radians") return "rad";
  return unit == "deg" || unit == "degree" || unit == "degrees" ? "deg" : "";
}

/// Unit in a text beside arrays.
std::string UnitIn(const NamedArray& texts) {
  const std::string bare = BareName(texts.name);
  if (texts.texts.size() != 1 || (!bare.ends_with("unit") && !bare.ends_with("units"))) return "";
  return AngleUnitOf(texts.texts.front());
}

/// Numbers the points of hands in the names of columns: two or three coordinates of 21 to 27
/// points, of one or more hands.
void NamePoints(NamedArray& array, const std::vector<std::size_t>& shape,
                const std::vector<std::size_t>& axes) {
  const auto size = [&](std::size_t from_end) { return shape[axes[axes.size() - from_end]]; };
  if (shape.size() < 3 || shape.size() > 4 || size(2) < 21 || size(2) > 27) return;
  const std::size_t coordinates = size(1);
  if (coordinates != 3 && (coordinates != 2 || size(2) != 21)) return;
  const std::size_t hands = shape.size() == 4 ? size(3) : 1;
  for (std::size_t i = 0; i < hands * size(2); ++i) {
    const std::string hand = hands > 1 ? fmt::format("_{}", i / size(2) + 1) : "";
    for (const char axis : std::string_view("xyz").substr(0, coordinates)) {
      array.column_names.push_back(
          fmt::format("{}{}_{}_{}", array.name, hand, i % size(2) + 1, axis));
    }
  }
}

/// The values of an array, some rows at a time.
class RowsOfArray {
 public:
  explicit RowsOfArray(const NamedArray& array) : array_(array) {
    if (array_.open) next_ = array_.open();
  }
  /// The next ones, until the next call.
  std::span<const double> Next(std::size_t rows) {
    if (!next_) {
      given_ += rows;
      return std::span(array_.values)
          .subspan((given_ - rows) * array_.columns, rows * array_.columns);
    }
    values_.clear();
    next_(rows, values_);
    return values_;
  }

 private:
  const NamedArray& array_;
  NamedArray::NextRows next_;
  std::vector<double> values_;
  std::size_t given_ = 0;
};

}  // namespace

void ReadValues(NamedArray& array) {
  if (!array.open) return;
  RowsOfArray reader(array);
  constexpr std::size_t kRows = 4096;
  for (std::size_t row = 0; row < array.rows; row += kRows) {
    const std::span<const double> part = reader.Next(std::min(kRows, array.rows - row));
    array.values.insert(array.values.end(), part.begin(), part.end());
  }
  array.open = {};
}

void SetValues(NamedArray& array, std::vector<double> values, std::vector<std::size_t> shape,
               ArrayOrder order) {
  array.is_flat = shape.size() < 3;
  if (shape.empty()) shape = {1};
  std::vector<std::size_t> strides(shape.size());
  std::size_t stride = 1;
  for (std::size_t d = 0; d < shape.size(); ++d) {
    const std::size_t axis = order == ArrayOrder::kColumns ? d : shape.size() - 1 - d;
    strides[axis] = stride;
    stride *= shape[axis];
  }
  GAUNTLET_ASSERT(stride == values.size());
  std::vector<std::size_t> axes(shape.size());
  std::iota(axes.begin(), axes.end(), std::size_t{0});
  if (!array.is_flat) {
    const auto longest = std::ranges::max_element(shape) - shape.begin();
    const bool has_few = shape.front() <= kMostSensors && shape[longest] > kMostSensors;
    if (has_few) std::rotate(axes.begin(), axes.begin() + longest, axes.begin() + longest + 1);
    constexpr std::size_t kCoordinates = 3;
    const bool has_coordinates_first =
        axes.size() == 3 && shape[axes[1]] == kCoordinates && shape[axes[2]] > kCoordinates;
    if (has_coordinates_first) std::swap(axes[1], axes[2]);
  }
  NamePoints(array, shape, axes);
  array.rows = shape[axes.front()];
  array.columns = stride / std::max<std::size_t>(array.rows, 1);
  const bool is_in_place =
      order == ArrayOrder::kRows ? std::ranges::is_sorted(axes) : array.columns == 1;
  if (is_in_place) {
    array.values = std::move(values);
    return;
  }
  array.values.resize(values.size());
  std::vector<std::size_t> place(shape.size(), 0);  // of a value, by axis
  std::size_t from = 0;
  for (double& value : array.values) {
    value = values[from];
    for (std::size_t d = axes.size(); d-- > 0;) {
      const std::size_t axis = axes[d];
      from += strides[axis];
      if (++place[axis] < shape[axis]) break;
      from -= strides[axis] * shape[axis];
      place[axis] = 0;
    }
  }
}

std::size_t CountOfRange(double base, double limit, double increment) {
  constexpr double kMost = 1e8;
  const double steps =
      std::floor((limit - base) / increment * (1.0 + 4.0 * std::numeric_limits<double>::epsilon()));
  return steps >= 0.0 && steps < kMost ? static_cast<std::size_t>(steps) + 1 : 0;
}

NamedArray RangeArray(const std::string& name, double base, double limit, double increment,
                      std::size_t count) {
  NamedArray array{.name = name, .rows = count, .values = {}};
  for (std::size_t i = 0; i < count; ++i) {
    const double value = base + static_cast<double>(i) * increment;
    array.values.push_back(increment < 0.0 ? std::max(value, limit) : std::min(value, limit));
  }
  return array;
}

std::string NameOfTimes(const std::string& name, std::string_view unit) {
  const std::string whole = fmt::format("{}_{}", name, unit);
  const std::string last = name.substr(name.rfind('_') + 1);
  const bool is_time = TimeScaleS(whole) || TimeScaleS(fmt::format("{}_{}", last, unit));
  return is_time ? whole : fmt::format("{}_time_{}", name, unit);
}

double RateOf(std::string_view name, double number) {
  if (IsRate(name)) return number > 0.0 ? number : 0.0;
  return IsPeriod(name) ? RateOfPeriod(number) : 0.0;
}

bool IsNameOfNames(std::string_view name) {
  const std::string bare = BareName(name);
  return bare.ends_with("names") || bare.ends_with("labels");
}

void AddUnit(NamedArray& array, std::string_view unit) {
  if (array.count() < 2) return;
  if (array.columns == 1 && GroupOfTime(array)) {
    // A name with a unit of its own keeps it.
    const std::string whole = fmt::format("{}_{}", array.name, unit);
    const std::string last = array.name.substr(array.name.rfind('_') + 1);
    const bool has_none = TimeScaleS(fmt::format("{}_{}", last, unit)) || TimeScaleS(whole);
    if (has_none) array.name = whole;
    return;
  }
  const std::string ending = AngleUnitOf(unit);
  if (ending.empty()) return;
  for (std::size_t i = array.column_names.size(); i < SensorsOf(array); ++i) {
    array.column_names.push_back(
        SensorsOf(array) == 1 ? Plain(array.name) : fmt::format("{}_{}", Plain(array.name), i + 1));
  }
  for (std::string& name : array.column_names) {
    if (!name.ends_with("_" + ending)) name += "_" + ending;
  }
}

std::vector<NamedArray> WithFacts(std::vector<NamedArray> arrays) {
  const auto is_texts = [](const NamedArray& array) { return !array.texts.empty(); };
  for (const NamedArray& texts : arrays) {
    if (texts.texts.size() < 2 || !IsNameOfNames(texts.name)) continue;
    const auto has_as_many = [&](const NamedArray& array) {
      return array.texts.empty() && array.count() > RowsOf(array) && RowsOf(array) > 1 &&
             SensorsOf(array) == texts.texts.size();
    };
    const auto is_of_group = [&](const NamedArray& array) {
      return IsAbout(texts, array) && has_as_many(array);
    };
    // `joint_` of joint_names is no group if nothing else has it.
    const bool has_group = std::ranges::any_of(arrays, is_of_group);
    const bool is_only = std::ranges::count_if(arrays, has_as_many) == 1;
    const auto is_named = [&](const NamedArray& array) {
      return has_group ? is_of_group(array) : is_only && has_as_many(array);
    };
    const bool is_one = std::ranges::count_if(arrays, is_named) == 1;
    for (NamedArray& array : arrays) {
      if (!is_named(array) || !array.column_names.empty()) continue;
      for (const std::string& text : texts.texts) {
        array.column_names.push_back(is_one ? text : array.name + "_" + text);
      }
    }
  }
  for (const NamedArray& texts : arrays) {
    const std::string unit = UnitIn(texts);
    for (NamedArray& array : arrays) {
      if (!unit.empty() && IsAbout(texts, array)) AddUnit(array, unit);
    }
  }
  std::erase_if(arrays, is_texts);
  return arrays;
}

std::string TextOf(const std::vector<ListedArray>& arrays) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(arrays.size(), kMost); ++i) {
    text += fmt::format("{}{} ({} x {})", i == 0 ? "" : ", ", OneLine(arrays[i].name, 60),
                        arrays[i].rows, arrays[i].columns);
  }
  if (arrays.size() > kMost) text += fmt::format(" and {} more", arrays.size() - kMost);
  return text;
}

std::vector<ListedArray> ListArrays(std::vector<NamedArray> arrays, std::string_view chosen) {
  const std::vector<std::string> left_out = RemoveLeftOut(arrays, chosen);
  return Listed(arrays, left_out, chosen);
}

void WriteTable(std::vector<NamedArray> arrays, std::string_view chosen, PipeWriter& pipe) {
  const std::vector<std::string> left_out = RemoveLeftOut(arrays, chosen);
  const double rate_hz = RateIn(arrays, Listed(arrays, left_out, chosen));
  arrays = SelectedArrays(std::move(arrays), left_out, chosen);
  std::vector<std::string> names;
  for (const NamedArray& array : arrays)
    std::ranges::copy(NamesOf(array), std::back_inserter(names));
  const bool has_time = std::ranges::any_of(
      names, [](const std::string& name) { return TimeScaleS(name).has_value(); });
  const bool adds_time = rate_hz > 0.0 && !has_time;
  if (adds_time) names.insert(names.begin(), "time_s");
  const std::size_t rows = arrays.front().rows;
  TableWriter table(pipe, names, chosen.empty() ? left_out : std::vector<std::string>(), rows);
  std::vector<RowsOfArray> readers(arrays.begin(), arrays.end());
  std::vector<double> block;
  const std::size_t most = RowsOfBlock(names.size());
  for (std::size_t first = 0; first < rows; first += most) {
    const std::size_t count = std::min(most, rows - first);
    block.resize(count * names.size());
    std::size_t column = 0;
    if (adds_time) {
      for (std::size_t row = 0; row < count; ++row) {
        block[row * names.size()] = static_cast<double>(first + row) / rate_hz;
      }
      ++column;
    }
    for (std::size_t i = 0; i < arrays.size(); column += arrays[i++].columns) {
      const std::size_t width = arrays[i].columns;
      const std::span<const double> values = readers[i].Next(count);
      for (std::size_t row = 0; row < count; ++row) {
        std::ranges::copy(values.subspan(row * width, width),
                          block.begin() + static_cast<std::ptrdiff_t>(row * names.size() + column));
      }
    }
    table.Rows(block);
  }
  table.Finish();
}

}  // namespace gauntlet::sim
