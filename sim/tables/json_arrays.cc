#include "sim/tables/json_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/tables/missing.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr int kDeepest = 100;
constexpr std::size_t kMostColumns = 1000;

/// NaN and infinities, which Python and others write without quotes, become null.
std::string WithoutNaN(std::string_view text) {
  std::string valid;
  bool is_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"') is_text = !is_text;
    if (is_text && letter == '\\' && i + 1 < text.size()) valid += text[i++];
    std::size_t length = 0;
    for (const std::string_view word : {"NaN", "nan", "Infinity", "-Infinity"}) {
      if (!is_text && text.substr(i).starts_with(word)) length = word.size();
    }
    if (length > 0) {
      valid += "null";
      i += length - 1;
    } else {
      valid += text[i];
    }
  }
  return valid;
}

Json Parsed(std::string_view text) {
  Json value = Json::parse_or_discard(text);
  if (value.is_discarded()) value = Json::parse_or_discard(WithoutNaN(text));
  return value;
}

std::string Join(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "_" + key;
}

std::optional<double> NumberOf(const Json& value) {
  if (value.is_number()) return value.get<double>();
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  if (value.is_null()) return kMissing;
  if (!value.is_string()) return std::nullopt;
  const auto text = value.get<std::string>();
  const auto number = NumberOrMissing(text);
  return number ? number : SecondsOfText(text);
}

/// `left` or `right` in a text, or in a text of the first of several or of an object; else empty.
std::string HandOf(const Json& value, int depth = 0) {
  constexpr int kDeepestLabel = 4;
  if (depth > kDeepestLabel) return "";
  if (value.is_string()) {
    std::string text = value.get<std::string>();
    for (char& letter : text) {
      letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    return text == "left" || text == "right" ? text : "";
  }
  if (value.is_array() && !value.empty()) return HandOf(value.front(), depth + 1);
  if (!value.is_object()) return "";
  for (const char* key : {"handedness", "hand", "side", "label", "categoryName", "category_name",
                          "displayName", "classification"}) {
    const auto found = value.find(key);
    if (found == value.end()) continue;
    if (std::string hand = HandOf(*found, depth + 1); !hand.empty()) return hand;
  }
  return "";
}

/// Hands of the items of a list: by their own words, or by those of the list of hands beside it,
/// as trackers write `landmarks` and `handedness`. Empty where one of them has none, or two have
/// the same.
std::vector<std::string> HandsOf(const Json& list, const Json* beside) {
  const bool has_beside = beside != nullptr && beside->is_array() && beside->size() == list.size();
  std::vector<std::string> hands;
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::string hand = list[i].is_object() ? HandOf(list[i]) : "";
    if (hand.empty() && has_beside && list[i].is_structured()) hand = HandOf((*beside)[i]);
    if (hand.empty() || std::ranges::count(hands, hand) > 0) return {};
    hands.push_back(std::move(hand));
  }
  return hands;
}

/// The hand that a text of a row names.
std::string HandOfRow(const Json& row) {
  for (const char* key : {"hand", "handedness", "side"}) {
    const auto found = row.is_object() ? row.find(key) : row.end();
    if (row.is_object() && found != row.end() && found->is_string()) return HandOf(*found);
  }
  return "";
}

/// Column by column what the rows have, each under the way to it. Rows of both hands are two
/// tables.
class RowCollector {
 public:
  void AddRow(const Json& row) {
    const std::string hand = HandOfRow(row);
    if (!hand.empty() && !is_of_hand_) {
      std::unique_ptr<RowCollector>& of_hand = hands_[hand];
      if (of_hand == nullptr) of_hand = std::make_unique<RowCollector>();
      of_hand->is_of_hand_ = true;
      of_hand->AddRow(row);
      return;
    }
    AddTo("", row, 0);
    ++rows_;
  }
  enum class Missing { kDropColumn, kKeepColumn };  // of a column without a number
  std::vector<NamedArray> Take(const std::string& path, Missing missing = Missing::kDropColumn) {
    std::vector<NamedArray> arrays;
    const bool is_only = hands_.size() == 1 && rows_ == 0;
    for (auto& [hand, rows] : hands_) {
      std::vector<NamedArray> more = rows->Take(is_only ? path : Join(path, hand), missing);
      std::ranges::move(more, std::back_inserter(arrays));
    }
    for (const std::string& name : order_) {
      std::vector<double>& values = columns_[name];
      values.resize(rows_, kMissing);
      const auto is_missing = [](double value) { return std::isnan(value); };
      const bool is_kept = missing == Missing::kKeepColumn;
      if (!is_kept && std::ranges::all_of(values, is_missing)) continue;
      arrays.push_back({.name = Join(path, name.empty() ? "value" : name),
                        .rows = rows_,
                        .values = std::move(values)});
    }
    return arrays;
  }

 private:
  /// Texts that tell sessions or persons apart are numbered.
  std::optional<double> NumberOrPart(const std::string& path, const Json& value) {
    const auto number = NumberOf(value);
    if (number || !value.is_string() || !NamesParts(path)) return number;
    std::vector<std::string>& parts = parts_[path];
    const auto text = value.get<std::string>();
    const auto found = std::ranges::find(parts, text);
    if (found == parts.end() && parts.size() == kMostParts) return std::nullopt;
    const auto place = static_cast<double>(found - parts.begin());
    if (found == parts.end()) parts.push_back(text);
    return place;
  }

  /// `beside`: list of the hands of the items, if there is one.
  void AddTo(const std::string& path, const Json& value, int depth, const Json* beside = nullptr) {
    if (depth > kDeepest) throw UserError("is nested too deeply");
    if (value.is_object()) {
      const Json* hands = nullptr;
      for (const char* key : {"handedness", "handednesses", "multiHandedness"}) {
        if (const auto found = value.find(key); found != value.end()) hands = &*found;
      }
      for (const auto& [key, part] : value.items()) AddTo(Join(path, key), part, depth + 1, hands);
    } else if (value.is_array()) {
      const std::vector<std::string> hands = HandsOf(value, beside);
      for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string name = hands.empty() ? std::to_string(i + 1) : hands[i];
        AddTo(Join(path.empty() ? "value" : path, name), value[i], depth + 1);
      }
    } else if (const auto number = NumberOrPart(path, value)) {
      const auto [column, is_new] = columns_.try_emplace(path);
      if (is_new) order_.push_back(path);
      if (order_.size() > kMostColumns) {
        throw UserError(fmt::format("has rows of more than {} values", kMostColumns));
      }
      column->second.resize(rows_, kMissing);
      column->second.push_back(*number);
    }
  }

  static constexpr std::size_t kMostParts = 1000;
  bool is_of_hand_ = false;
  std::map<std::string, std::unique_ptr<RowCollector>> hands_;
  std::map<std::string, std::vector<std::string>> parts_;
  std::size_t rows_ = 0;
  std::vector<std::string> order_;
  std::map<std::string, std::vector<double>> columns_;
};

/// True for a list of objects of which one has a list of rows, or of times, longer than the list
/// itself: persons with frames, say, some of them with few or none.
bool AreTables(const Json& list) {
  constexpr std::size_t kFewestRows = 10;
  const std::size_t fewest = std::max(kFewestRows, 2 * list.size());
  const auto has_table = [&](const Json& item) {
    if (!item.is_object()) return false;
    for (const auto& [key, part] : item.items()) {
      const bool is_long = part.is_array() && part.size() >= fewest;
      if (is_long && (part.front().is_structured() || TimeScaleS(key))) return true;
    }
    return false;
  };
  return std::ranges::all_of(list, &Json::is_object) && std::ranges::any_of(list, has_table);
}

/// Arrays of one part of a file: those from `first` on, up to the next part.
struct Part {
  std::string name;
  std::size_t first = 0;
};

/// Parts with the same arrays in different lengths are recordings of their own, of which a person
/// chooses one: the cells of `path`.
void MarkRecordings(const std::string& path, const std::vector<Part>& parts,
                    std::vector<NamedArray>& arrays) {
  std::map<std::set<std::string>, std::vector<std::size_t>> parts_of;  // by names of arrays
  std::vector<std::size_t> lengths(parts.size(), 0);
  const auto end_of = [&](std::size_t i) {
    return i + 1 < parts.size() ? parts[i + 1].first : arrays.size();
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::set<std::string> names;
    for (std::size_t a = parts[i].first; a < end_of(i); ++a) {
      if (arrays[a].rows < 2) continue;
      names.insert(arrays[a].name.substr(parts[i].name.size()));
      lengths[i] = arrays[a].rows;
    }
    if (!names.empty()) parts_of[names].push_back(i);
  }
  for (const auto& [names, alike] : parts_of) {
    const std::size_t length = lengths[alike.front()];
    const auto is_other = [&](std::size_t i) { return lengths[i] != length; };
    if (std::ranges::none_of(alike, is_other)) continue;
    for (const std::size_t i : alike) {
      for (std::size_t a = parts[i].first; a < end_of(i); ++a) {
        arrays[a].cell = parts[i].name;
        arrays[a].cells_of = path.empty() ? "the file" : path;
      }
    }
  }
}

/// The keys of an object as the index of rows, numbers or dates; empty if one is neither.
std::vector<double> IndexOf(const Json& object) {
  std::vector<double> index;
  if (!object.is_object() || object.size() < 2) return {};
  for (const auto& [key, part] : object.items()) {
    const auto number = NumberOrMissing(key);
    const auto found = number ? number : SecondsOfText(key);
    if (!found || !std::isfinite(*found)) return {};
    index.push_back(*found);
  }
  return index;
}

/// A table as to_json() of pandas writes it: an object of columns, whose values are under the index
/// of their rows, or (orient="index") an object of rows under theirs. An index that only counts the
/// rows is left out. Nothing for any other object.
std::vector<NamedArray> IndexedTable(const Json& value) {
  if (!value.is_object() || value.empty()) return {};
  if (!std::ranges::all_of(value, &Json::is_object)) return {};
  std::vector<double> index = IndexOf(value);
  std::vector<NamedArray> arrays;
  const auto has_cells = [](const Json& row) {
    return std::ranges::none_of(row, &Json::is_structured);  // else recordings under numbers
  };
  if (!index.empty() && !std::ranges::all_of(value, has_cells)) return {};
  if (!index.empty()) {
    RowCollector rows;
    for (const Json& row : value) rows.AddRow(row);
    arrays = rows.Take("");
  } else {
    index = IndexOf(value.front());
    if (index.empty()) return {};
    for (const auto& [name, column] : value.items()) {
      if (IndexOf(column) != index) return {};
      NamedArray array{.name = name, .rows = index.size(), .values = {}};
      for (const Json& cell : column) array.values.push_back(NumberOf(cell).value_or(kMissing));
      const auto is_missing = [](double number) { return std::isnan(number); };
      if (!std::ranges::all_of(array.values, is_missing)) arrays.push_back(std::move(array));
    }
  }
  bool is_count = true;
  for (std::size_t i = 0; i < index.size(); ++i) {
    is_count = is_count && index[i] == static_cast<double>(i);
  }
  if (!is_count && !arrays.empty()) {
    const std::size_t rows = index.size();
    arrays.insert(arrays.begin(), {.name = "index", .rows = rows, .values = std::move(index)});
  }
  return arrays;
}

void Collect(const std::string& path, const Json& value, int depth,
             std::vector<NamedArray>& arrays) {
  if (depth > kDeepest) throw UserError("is nested too deeply");
  std::vector<Part> parts;
  const auto collect = [&](const std::string& name, const Json& part) {
    parts.push_back({name, arrays.size()});
    Collect(name, part, depth + 1, arrays);
  };
  if (value.is_object()) {
    for (const auto& [key, part] : value.items()) collect(Join(path, key), part);
    MarkRecordings(path, parts, arrays);
  } else if (value.is_array() && AreTables(value)) {
    const std::vector<std::string> hands = HandsOf(value, nullptr);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string name = !hands.empty()      ? hands[i]
                               : value.size() == 1 ? ""
                                                   : std::to_string(i + 1);
      collect(name.empty() ? path : Join(path, name), value[i]);
    }
    MarkRecordings(path, parts, arrays);
  } else if (value.is_array()) {
    RowCollector rows;
    for (const Json& row : value) rows.AddRow(row);
    for (NamedArray& array : rows.Take("")) {
      // A list of plain numbers has the name of the list.
      array.name = array.name == "value" ? (path.empty() ? "value" : path) : Join(path, array.name);
      if (const std::size_t at = array.name.rfind("_value_"); at != std::string::npos) {
        array.name.erase(at, std::string_view("_value").size());
      }
      arrays.push_back(std::move(array));
    }
  } else if (const auto number = NumberOf(value); number && std::isfinite(*number)) {
    arrays.push_back({.name = path, .rows = 1, .values = {*number}});
  }
}

}  // namespace

std::vector<NamedArray> ReadJsonArrays(std::string_view text) {
  const Json whole = Parsed(text);
  std::vector<NamedArray> arrays;
  if (!whole.is_discarded()) {
    arrays = IndexedTable(whole);
    if (arrays.empty()) Collect("", whole, 0, arrays);
    return arrays;
  }
  RowCollector rows;
  std::size_t line_number = 0;
  for (const std::string_view line : SplitLines(text)) {
    ++line_number;
    if (Trimmed(line).empty()) continue;
    const Json row = Parsed(line);
    if (row.is_discarded()) {
      throw UserError(fmt::format("is no JSON, nor is its line {} alone", line_number));
    }
    rows.AddRow(row);
  }
  return rows.Take("");
}

std::vector<NamedArray> ReadJsonRow(std::string_view text) {
  const Json value = Parsed(text);
  if (value.is_discarded()) throw UserError("is no JSON");
  RowCollector row;
  row.AddRow(value);
  return row.Take("", RowCollector::Missing::kKeepColumn);
}

DatasetInfo ReadDatasetInfo(std::string_view text) {
  DatasetInfo found;
  const Json whole = Json::parse_or_discard(text);
  if (!whole.is_object() || !whole.contains("features")) return found;
  const auto take = [&](const char* key, double& number) {
    if (whole.contains(key) && whole[key].is_number()) number = whole[key].get<double>();
  };
  take("fps", found.rate_hz);
  take("total_episodes", found.episodes);
  take("total_frames", found.rows);
  for (const auto& [name, feature] : whole["features"].items()) {
    if (!feature.is_object() || !feature.contains("names")) continue;
    const Json* names = &feature["names"];
    while (names->is_structured() && names->size() == 1 && names->front().is_structured()) {
      names = &names->front();  // {"motors": [..]} or [[..]]
    }
    if (!names->is_array() || !std::ranges::all_of(*names, &Json::is_string)) continue;
    found.names[name] = names->get<std::vector<std::string>>();
  }
  return found;
}

}  // namespace gauntlet::sim
