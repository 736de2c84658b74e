#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/tables/name_words.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Row = std::vector<std::string>;

constexpr std::size_t kLongestHead = std::size_t{64} << 10;
constexpr std::size_t kMostWideColumns = 1000;
constexpr std::size_t kMostWideCells = 10000000;  // a quarter of an hour of both hands

// --- A row per keypoint --------------------------------------------------------------------------

/// Columns of a table with a row per keypoint.
struct RowForm {
  std::optional<std::size_t> keypoint, hand;
  std::vector<std::size_t> frame;   // time and number
  std::vector<std::size_t> values;  // x, y, z; of a table without them, those of a quaternion
  std::vector<std::string> value_names;
};

std::optional<RowForm> RowFormOf(const std::vector<std::string>& names) {
  RowForm form;
  constexpr std::string_view kKeypoints =
      "landmark landmarkid landmarkindex landmarkname joint jointid jointname jointindex keypoint "
      "keypointid keypointname point pointid bone bonename node nodeid";
  std::vector<std::size_t> rotation;
  std::vector<std::string> rotation_names;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::string bare = BareName(names[c]);
    const std::vector<std::string> words = WordsOf(names[c]);
    const bool is_axis = !words.empty() && words.back().size() == 1 &&
                         std::string_view("xyz").find(words.back()) != std::string_view::npos;
    if (IsWordOf(kKeypoints, bare)) {
      if (form.keypoint) return std::nullopt;
      form.keypoint = c;
    } else if (IsWordOf("hand side handedness handid handindex handlabel type", bare)) {
      if (!form.hand) form.hand = c;
    } else if (TimeScaleS(names[c]) || IsSampleNumber(names[c]) || IsWordOf("frameid", bare)) {
      form.frame.push_back(c);
    } else if (is_axis && !HasWordOf(words, "rot rotation quat quaternion euler q vel")) {
      form.values.push_back(c);
      form.value_names.push_back(words.back());
    } else if (IsWordOf("qw qx qy qz", bare) ||
               (!words.empty() && IsWordOf("w x y z", words.back()) &&
                HasWordOf(words, "rot rotation quat quaternion orientation"))) {
      rotation.push_back(c);
      rotation_names.push_back(std::string("q") + words.back().back());
    }
  }
  const bool has_rotations = form.values.empty() && rotation.size() == 4;
  if (has_rotations) {
    form.values = std::move(rotation);
    form.value_names = std::move(rotation_names);
  }
  if (!form.keypoint || form.frame.empty()) return std::nullopt;
  if (form.values.size() != 3 && !has_rotations) return std::nullopt;
  return form;
}

/// The table with a row per frame.
std::string WideText(CsvReader& reader, const RowForm& form) {
  Row names;  // of the frame, then of the keypoints
  for (const std::size_t c : form.frame) names.push_back(reader.header()[c]);
  std::map<std::string, std::size_t> place_of;  // first column of a keypoint
  std::vector<Row> frames;
  Row cells, before;
  while (reader.NextRow(cells)) {
    Row frame;
    for (const std::size_t c : form.frame) frame.push_back(cells[c]);
    std::string keypoint = cells[*form.keypoint];
    if (keypoint.empty()) continue;
    if (std::isdigit(static_cast<unsigned char>(keypoint.front())) != 0) {
      keypoint.insert(0, "landmark_");
    }
    if (form.hand) keypoint = cells[*form.hand] + "_" + keypoint;
    const auto [place, is_new] = place_of.try_emplace(keypoint, names.size());
    if (is_new) {
      for (const std::string& axis : form.value_names) names.push_back(keypoint + "_" + axis);
      if (names.size() > kMostWideColumns) {
        throw UserError({.place = reader.name(),
                         .problem = fmt::format(
                             "column {} {} has more than {} different keypoints; give each "
                             "the same name in every frame, as 0 to 20",
                             *form.keypoint + 1, reader.Quoted(reader.header()[*form.keypoint]),
                             kMostWideColumns / 3)});
      }
    }
    if (frames.empty() || frame != before) frames.push_back(frame);
    if (frames.size() * names.size() > kMostWideCells) {
      throw UserError({.place = reader.name(),
                       .problem = fmt::format("has more than {} values of keypoints; write a part "
                                              "of it, or a row per frame",
                                              kMostWideCells)});
    }
    before = std::move(frame);
    const std::size_t values = form.values.size();
    frames.back().resize(std::max(frames.back().size(), place->second + values));
    for (std::size_t i = 0; i < values; ++i)
      frames.back()[place->second + i] = cells[form.values[i]];
  }
  std::string text = CsvLine(names);
  for (Row& frame : frames) {
    frame.resize(names.size());
    text += CsvLine(frame);
  }
  return text;
}

// --- Lines of Hand Tracking Streamer -------------------------------------------------------------

/// A line of a hand: `Right landmarks | f = 1 | t = 5:, 0.1, ..`.
struct HandLine {
  bool is_right = false;
  std::string time_ns;
  Row values;  // x, y, z of 21 points
};

std::optional<HandLine> HandLineOf(std::string_view line) {
  constexpr std::size_t kValues = 63;
  line = Trimmed(line);
  HandLine hand;
  hand.is_right = line.starts_with("Right landmarks");
  if (!hand.is_right && !line.starts_with("Left landmarks")) return std::nullopt;
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view head = line.substr(0, colon);
  if (const std::size_t time = head.find("t = "); time != std::string_view::npos) {
    hand.time_ns = Trimmed(head.substr(time + 4, head.find('|', time) - time - 4));
    if (!controller::ParseNumber(hand.time_ns)) return std::nullopt;
  }
  std::string_view rest = Trimmed(line.substr(colon + 1));
  if (rest.starts_with(',')) rest.remove_prefix(1);
  for (const std::string_view cell : SplitCells(rest)) hand.values.emplace_back(Trimmed(cell));
  if (hand.values.size() != kValues ||
      !std::ranges::all_of(
          hand.values, [](const std::string& cell) { return NumberOrMissing(cell).has_value(); })) {
    return std::nullopt;
  }
  return hand;
}

/// A row per frame: of one hand, or of both, which are sent one after the other.
std::string TextOfHandLines(std::string_view text) {
  std::vector<HandLine> lines;
  bool has_left = false, has_right = false, has_time = true;
  for (const std::string_view line : SplitLines(text)) {
    auto hand = HandLineOf(line);
    if (!hand) continue;
    (hand->is_right ? has_right : has_left) = true;
    has_time = has_time && !hand->time_ns.empty();
    lines.push_back(std::move(*hand));
  }
  Row names;
  if (has_time) names.emplace_back("timestamp_ns");
  for (const bool is_right : {false, true}) {
    if (is_right ? !has_right : !has_left) continue;
    for (std::size_t i = 0; i < 21; ++i) {
      for (const char axis : {'x', 'y', 'z'}) {
        names.push_back(fmt::format("{}_landmark_{}_{}", is_right ? "right" : "left", i, axis));
      }
    }
  }
  const std::size_t begin = has_time ? 1 : 0;
  std::string table = CsvLine(names);
  Row row(names.size());
  bool has_row[2] = {false, false};
  const auto finish = [&] {
    if (has_row[0] || has_row[1]) table += CsvLine(row);
    row.assign(names.size(), "");
    has_row[0] = has_row[1] = false;
  };
  for (const HandLine& hand : lines) {
    if (has_row[hand.is_right ? 1 : 0]) finish();
    if (has_time && row[0].empty()) row[0] = hand.time_ns;
    const std::size_t place = begin + (hand.is_right && has_left ? hand.values.size() : 0);
    std::ranges::copy(hand.values, row.begin() + static_cast<std::ptrdiff_t>(place));
    has_row[hand.is_right ? 1 : 0] = true;
  }
  finish();
  return table;
}

/// True if a line of a hand is among the first lines.
bool HasHandLines(std::string_view head) {
  constexpr std::size_t kLines = 8;
  std::size_t seen = 0;
  for (const std::string_view line : SplitLines(head)) {
    if (HandLineOf(line)) return true;
    if (++seen == kLines) return false;
  }
  return false;
}

}  // namespace

TableInput KeypointsInColumns(const std::string& name, TableInput input) {
  if (!std::holds_alternative<CsvReader::Source>(input)) {
    const std::optional<RowForm> form =
        RowFormOf(CsvReader(name, input, ProblemHandling::kRepair).header());
    if (!form) return input;
    CsvReader reader(name, std::move(input), ProblemHandling::kRepair);
    return WithHead(WideText(reader, *form), nullptr);
  }
  auto source = std::get<CsvReader::Source>(std::move(input));
  std::string head = BytesOf(source, kLongestHead);
  if (HasHandLines(head)) {
    return WithHead(TextOfHandLines(head + WholeTextOf(source, name)), nullptr);
  }
  std::optional<RowForm> form;
  try {
    form = RowFormOf(CsvReader(name, TextSource(head), ProblemHandling::kRepair).header());
  } catch (const UserError&) {  // no table: its reader tells
  }
  if (!form) return WithHead(std::move(head), std::move(source));
  CsvReader reader(name, WithHead(std::move(head), std::move(source)), ProblemHandling::kRepair);
  return WithHead(WideText(reader, *form), nullptr);
}

}  // namespace gauntlet::sim
