#include "sim/recordings/keypoints/keypoint_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/keypoints/hand_rotations.h"
#include "sim/tables/missing.h"
#include "sim/tables/source_bytes.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{256} << 10;
constexpr std::size_t kFewestColumns = 60;  // rotations of fingers and thumb

/// Keypoints that the beginning of a text has.
KeypointLayout LayoutOfHead(const std::string& name, std::string_view head,
                            Quaternions quaternions) {
  try {
    const CsvReader reader(name, TextSource(head), ProblemHandling::kRepair);
    if (reader.column_count() < kFewestColumns) return {};
    std::vector<std::string> names = reader.header();
    names.resize(reader.column_count());
    return FindKeypoints(names, quaternions);
  } catch (const UserError&) {  // no table: its reader tells
    return {};
  }
}

/// A table with keypoints, row by row.
struct KeypointText {
  std::vector<std::string> names;
  std::vector<std::size_t> others;  // columns that are no keypoints
  std::vector<std::vector<std::string>> other_cells;
  std::vector<std::vector<HandPoints>> points;        // per hand and row
  std::vector<std::vector<HandRotations>> rotations;  // the same; a hand has either
  std::string remarks;                                // lines of the text about itself
};

double NumberOfCell(const std::string& cell, char separator) {
  std::string text = cell;
  if (separator != ',') std::ranges::replace(text, ',', '.');
  return NumberOrMissing(text).value_or(kMissing);
}

KeypointText ReadText(CsvReader& reader, const std::vector<KeypointColumns>& hands) {
  constexpr double kLeastConfidence = 0.5;
  KeypointText text;
  text.names = reader.header();
  text.names.resize(reader.column_count());
  text.points.resize(hands.size());
  text.rotations.resize(hands.size());
  std::set<std::size_t> of_hands;
  for (const KeypointColumns& hand : hands) of_hands.insert(hand.all.begin(), hand.all.end());
  for (std::size_t c = 0; c < text.names.size(); ++c) {
    if (!of_hands.contains(c)) text.others.push_back(c);
  }
  std::vector<std::string> cells;
  while (reader.NextRow(cells)) {
    const auto value = [&](std::size_t column) {
      return NumberOfCell(cells[column], reader.separator());
    };
    for (std::size_t h = 0; h < hands.size(); ++h) {
      const bool is_doubtful =
          hands[h].confidence && value(*hands[h].confidence) < kLeastConfidence;
      if (hands[h].rotations) {
        HandRotations& rotations = text.rotations[h].emplace_back();
        rotations.setConstant(kMissing);
        for (int bone = 0; bone < kTurnedBones && !is_doubtful; ++bone) {
          const auto& columns = hands[h].rotations->bone[static_cast<std::size_t>(bone)];
          if (!columns) continue;
          rotations.col(bone) << value((*columns)[0]), value((*columns)[1]), value((*columns)[2]),
              value((*columns)[3]);
        }
        continue;
      }
      HandPoints& points = text.points[h].emplace_back();
      for (int k = 0; k < kKeypoints; ++k) {
        const auto& position = hands[h].position[static_cast<std::size_t>(k)];
        points.col(k) << value(position[0]), value(position[1]), value(position[2]);
      }
      if (is_doubtful) points.setConstant(kMissing);
    }
    std::vector<std::string>& others = text.other_cells.emplace_back();
    for (const std::size_t c : text.others) others.push_back(cells[c]);
  }
  for (const std::string& remark : reader.remarks()) text.remarks += RemarkLine(remark);
  return text;
}

/// True if a column that is no keypoint rises in every row, by its name a time.
bool HasTimes(const KeypointText& text) {
  return std::ranges::any_of(text.others, [&](std::size_t c) {
    return TimeScaleS(text.names[c]).has_value() ||
           (MayBeTime(text.names[c]) && !IsSampleNumber(text.names[c]));
  });
}

/// True if the numbers are those of hands, where the names do not tell it.
bool AreHands(const KeypointText& text, const std::vector<KeypointColumns>& hands) {
  for (std::size_t h = 0; h < hands.size(); ++h) {
    const bool is_hand = hands[h].rotations ? AreUnitQuaternions(text.rotations[h])
                                            : hands[h].is_named || LooksLikeHand(text.points[h]);
    if (!is_hand) return false;
  }
  return true;
}

/// Left or right by the geometry; empty for a hand that is in no frame or never bends.
std::string SideOf(const std::vector<HandPoints>& points, double unit_m) {
  try {
    return PlaceHand(points, unit_m).is_left ? "left" : "right";
  } catch (const UserError&) {  // AnglesOfHand() reports it
    return "";
  }
}

/// Names the hands of a pair. Errors: UserError without a place if both are of one side.
void NameSides(const KeypointText& text, std::vector<KeypointColumns>& hands) {
  for (std::size_t h = 0; h < hands.size(); ++h) {
    hands[h].hand = SideOf(text.points[h], hands[h].unit_m);
  }
  std::string& first = hands.front().hand;
  std::string& second = hands.back().hand;
  if (first == second && !first.empty()) {
    throw UserError(
        fmt::format("has keypoints of two {} hands by their shape; keep those of one", first));
  }
  if (first.empty()) first = second == "left" ? "right" : "left";
  if (second.empty() || second == first) second = first == "left" ? "right" : "left";
}

/// Facts about a hand: its angles, lost frames, and remarks.
AnglesOfBones AnglesOfHand(const KeypointText& text, std::size_t h, const KeypointColumns& columns,
                           std::string& remarks) {
  if (columns.rotations) {
    AnglesOfBones bones = AnglesOf(text.rotations[h], columns);
    for (const std::string& remark : bones.remarks) remarks += RemarkLine(remark);
    return bones;
  }
  const PlacedHand placed = PlaceHand(text.points[h], columns.unit_m);
  KeypointAngles angles = AnglesOf(placed);
  remarks += RemarkLine(RemarkOf(placed, columns));
  remarks += RemarkLine(fmt::format(
      "{}angles from keypoints: the points are {:.2g} mm RMS off a hand with these angles",
      text.points.size() > 1 ? columns.hand + " hand: " : "", 1e3 * angles.residual_m));
  return {.angles = std::move(angles), .is_lost = placed.is_lost, .remarks = {}};
}

std::string TextOfAngles(const KeypointText& text, const std::vector<KeypointColumns>& hands) {
  std::vector<std::string> names;
  for (const std::size_t c : text.others) names.push_back(text.names[c]);
  std::vector<AnglesOfBones> of_hands;
  std::string remarks = text.remarks;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    try {
      of_hands.push_back(AnglesOfHand(text, h, hands[h], remarks));
    } catch (const UserError& error) {
      // Of two hands, often one does nothing.
      if (h + 1 == hands.size() && of_hands.empty()) throw;
      remarks += RemarkLine(fmt::format("left out: {} hand: {}", hands[h].hand, error.what()));
      continue;
    }
    const std::string side = hands.size() > 1 ? hands[h].hand + "_" : "";
    for (const std::string_view channel : of_hands.back().angles.channels) {
      names.push_back(fmt::format("{}{}_deg", side, channel));
    }
  }
  const bool has_times = HasTimes(text);
  std::string table = CsvLine(names);
  int rows = 0;
  for (std::size_t k = 0; k < text.other_cells.size(); ++k) {
    const bool is_empty =
        std::ranges::all_of(of_hands, [k](const AnglesOfBones& hand) { return hand.is_lost[k]; });
    if (is_empty && has_times) continue;
    std::vector<std::string> cells = text.other_cells[k];
    for (const AnglesOfBones& of : of_hands) {
      for (const double angle : of.angles.angle_deg.row(static_cast<Eigen::Index>(k))) {
        cells.push_back(std::isfinite(angle) ? fmt::format("{:.6g}", angle + 0.0) : "");  // no -0
      }
    }
    table += CsvLine(cells);
    if (++rows == kRowsBeforeRemarks) table += remarks;
  }
  return table;
}

}  // namespace

std::string RemarkOf(const PlacedHand& hand, const KeypointColumns& columns) {
  const auto percent = [&hand](std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(hand.is_lost.size());
  };
  const std::string_view side = hand.is_left ? "left" : "right";
  const bool is_mirrored = !columns.hand.empty() && columns.hand != side;
  return fmt::format(
      "keypoints of a {} hand{}, {}{} [{}]: {:.0f} mm from the wrist to the tip of the middle "
      "finger; lengths of bones within {:.2g} %; {:.2g} % of the frames lost, {:.2g} % implausible",
      side,
      is_mirrored ? fmt::format(" (by its name a {} one: the axes are mirrored)", columns.hand)
                  : "",
      columns.skeleton, columns.is_named ? "" : " (assumed)", hand.unit, 1e3 * hand.length_m,
      100.0 * hand.bone_spread, percent(hand.lost), percent(hand.implausible));
}

CsvReader::Source AnglesOfKeypoints(const std::string& name, CsvReader::Source source) {
  std::string head = BytesOf(source, kHeadBytes);
  std::string bytes;  // the whole text, once it is known to have hands
  for (const Quaternions quaternions : {Quaternions::kTaken, Quaternions::kLeft}) {
    KeypointLayout layout = LayoutOfHead(name, head, quaternions);
    if (layout.has_several) throw UserError({.place = name, .problem = layout.problem});
    if (layout.hands.empty()) break;
    if (bytes.empty()) bytes = head + BytesOf(source);
    CsvReader reader(name, TextSource(bytes), ProblemHandling::kRepair);
    const KeypointText text = ReadText(reader, layout.hands);
    if (!AreHands(text, layout.hands)) continue;  // at most once more: points in four values
    try {
      if (layout.hands.front().is_of_pair) NameSides(text, layout.hands);
      return WithHead(TextOfAngles(text, layout.hands), nullptr);
    } catch (const UserError& error) {
      throw UserError({.place = name, .problem = error.what()});
    }
  }
  // No hand, or so many numbers of another kind.
  if (!bytes.empty()) return WithHead(std::move(bytes), nullptr);
  return WithHead(std::move(head), std::move(source));
}

}  // namespace gauntlet::sim
