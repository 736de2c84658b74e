#include "sim/recordings/keypoints/keypoint_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/tables/missing.h"
#include "sim/tables/table_layout.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{256} << 10;
constexpr std::size_t kFewestColumns = 60;  // rotations of fingers and thumb

/// Names of the columns of a table, or of the beginning of a text; none if there are too few.
std::vector<std::string> NamesIn(const std::string& name, TableInput beginning) {
  try {
    const CsvReader reader(name, std::move(beginning), ProblemHandling::kRepair);
    if (reader.column_count() < kFewestColumns) return {};
    std::vector<std::string> names = reader.header();
    names.resize(reader.column_count());
    return names;
  } catch (const UserError&) {  // no table: its reader reports it
    return {};
  }
}

/// A table with keypoints, row by row.
struct KeypointRows {
  const Table& table;
  std::vector<std::size_t> others = {};                    // columns that are no keypoints
  std::vector<std::vector<HandPoints>> points = {};        // per hand and row
  std::vector<std::vector<HandRotations>> rotations = {};  // the same; a hand has either
};

KeypointRows RowsOf(const Table& table, const std::vector<KeypointColumns>& hands) {
  constexpr double kLeastConfidence = 0.5;
  KeypointRows rows{.table = table};
  rows.points.resize(hands.size());
  rows.rotations.resize(hands.size());
  std::set<std::size_t> of_hands;
  for (const KeypointColumns& hand : hands) of_hands.insert(hand.all.begin(), hand.all.end());
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (!of_hands.contains(c)) rows.others.push_back(c);
  }
  for (std::size_t row = 0; row < table.rows; ++row) {
    const auto value = [&](std::size_t column) {
      const TableColumn& is = table.columns[column];
      return is.texts.empty() ? is.numbers[row] : NumberOrMissing(is.texts[row]).value_or(kMissing);
    };
    for (std::size_t h = 0; h < hands.size(); ++h) {
      const bool is_doubtful =
          hands[h].confidence && value(*hands[h].confidence) < kLeastConfidence;
      if (hands[h].rotations) {
        HandRotations& rotations = rows.rotations[h].emplace_back();
        rotations.setConstant(kMissing);
        for (int bone = 0; bone < kTurnedBones && !is_doubtful; ++bone) {
          const auto& columns = hands[h].rotations->bone[static_cast<std::size_t>(bone)];
          if (!columns) continue;
          rotations.col(bone) << value((*columns)[0]), value((*columns)[1]), value((*columns)[2]),
              value((*columns)[3]);
        }
        continue;
      }
      HandPoints& points = rows.points[h].emplace_back();
      for (int k = 0; k < kKeypoints; ++k) {
        const auto& position = hands[h].position[static_cast<std::size_t>(k)];
        points.col(k) << value(position[0]), value(position[1]), value(position[2]);
      }
      if (is_doubtful) points.setConstant(kMissing);
    }
  }
  return rows;
}

/// True if a column that is no keypoint rises in every row, by its name a time.
bool HasTimes(const KeypointRows& rows) {
  return std::ranges::any_of(rows.others, [&](std::size_t c) {
    const std::string& name = rows.table.columns[c].name;
    return TimeScaleS(name).has_value() || (MayBeTime(name) && !IsSampleNumber(name));
  });
}

/// True if the numbers are those of hands, where the names do not tell it.
bool AreHands(const KeypointRows& rows, const std::vector<KeypointColumns>& hands) {
  for (std::size_t h = 0; h < hands.size(); ++h) {
    const bool is_hand = hands[h].rotations ? AreUnitQuaternions(rows.rotations[h])
                                            : hands[h].is_named || LooksLikeHand(rows.points[h]);
    if (!is_hand) return false;
  }
  return true;
}

/// Facts about a hand: its angles, lost frames, and remarks. One of two without a side gets it by
/// its shape.
AnglesOfBones AnglesOfHand(const KeypointRows& rows, std::size_t h, KeypointColumns& columns,
                           std::vector<std::string>& remarks) {
  if (columns.rotations) {
    AnglesOfBones bones = AnglesOf(rows.rotations[h], columns);
    remarks.insert(remarks.end(), bones.remarks.begin(), bones.remarks.end());
    return bones;
  }
  const PlacedHand placed = PlaceHand(rows.points[h], columns.unit_m);
  KeypointAngles angles = AnglesOf(placed);
  if (rows.points.size() > 1 && columns.hand.empty()) {
    columns.hand = placed.is_left ? "left" : "right";
  }
  remarks.push_back(RemarkOf(placed, columns));
  remarks.push_back(fmt::format(
      "{}angles from keypoints: the points are {:.2g} mm RMS off a hand with these angles",
      rows.points.size() > 1 ? columns.hand + " hand: " : "", 1e3 * angles.residual_m));
  return {.angles = std::move(angles), .is_lost = placed.is_lost, .remarks = {}};
}

/// A column with these of its rows.
TableColumn Part(const TableColumn& column, const std::vector<std::size_t>& rows) {
  TableColumn part{.name = column.name};
  for (const std::size_t row : rows) {
    if (column.texts.empty()) {
      part.numbers.push_back(column.numbers[row]);
    } else {
      part.texts.push_back(column.texts[row]);
    }
  }
  return part;
}

Table TableOfAngles(const KeypointRows& rows, std::vector<KeypointColumns>& hands) {
  Table table;
  table.is_cut = rows.table.is_cut;
  table.is_tracked = true;
  table.remarks = rows.table.remarks;
  std::vector<AnglesOfBones> of_hands;
  std::vector<std::string> sides;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    try {
      of_hands.push_back(AnglesOfHand(rows, h, hands[h], table.remarks));
      sides.push_back(hands.size() > 1 ? hands[h].hand + "_" : "");
    } catch (const UserError& error) {
      // Of two hands, often one does nothing.
      if (h + 1 == hands.size() && of_hands.empty()) throw;
      table.remarks.push_back(fmt::format("left out: {} hand: {}", hands[h].hand, error.what()));
    }
  }
  if (sides.size() > 1 && sides.front() == sides.back()) {
    throw UserError(fmt::format("has keypoints of two {} hands by their shape; keep those of one",
                                hands.front().hand));
  }
  const bool has_times = HasTimes(rows);
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < rows.table.rows; ++k) {
    const bool is_empty =
        std::ranges::all_of(of_hands, [k](const AnglesOfBones& hand) { return hand.is_lost[k]; });
    if (!is_empty || !has_times) kept.push_back(k);
  }
  table.rows = kept.size();
  for (const std::size_t c : rows.others) {
    table.columns.push_back(Part(rows.table.columns[c], kept));
  }
  for (std::size_t h = 0; h < of_hands.size(); ++h) {
    const KeypointAngles& angles = of_hands[h].angles;
    for (std::size_t c = 0; c < angles.channels.size(); ++c) {
      TableColumn& column = table.columns.emplace_back();
      column.name = fmt::format("{}{}_deg", sides[h], angles.channels[c]);
      for (const std::size_t k : kept) {
        const double angle =
            angles.angle_deg(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c));
        column.numbers.push_back(std::isfinite(angle) ? angle + 0.0 : kMissing);  // no -0
      }
    }
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

TableInput AnglesOfKeypoints(const std::string& name, TableInput input) {
  auto* const source = std::get_if<CsvReader::Source>(&input);
  std::string head;
  if (source != nullptr) head = BytesOf(*source, kHeadBytes);
  const std::vector<std::string> names =
      NamesIn(name, source != nullptr ? TableInput(TextSource(head)) : input);
  std::string text;                    // the whole one, once it is known to have hands
  std::shared_ptr<const Table> table;  // of the input
  for (const Quaternions quaternions : {Quaternions::kTaken, Quaternions::kLeft}) {
    if (names.empty()) break;
    KeypointLayout layout = FindKeypoints(names, quaternions);
    if (layout.has_several) throw UserError({.place = name, .problem = layout.problem});
    if (layout.hands.empty()) break;
    if (!table) table = WholeTable(input);
    // Rows of one and of two hands are a question, before the rows of one width are dropped.
    if (!table) FindTable(name, TextSource(head), ProblemHandling::kRepair);
    if (!table) {
      text = head + WholeTextOf(*source, name);
      table = std::make_shared<const Table>(
          TableOfText({name, TextSource(text), ProblemHandling::kRepair}));
    }
    const KeypointRows rows = RowsOf(*table, layout.hands);
    if (!AreHands(rows, layout.hands)) continue;  // at most once more: points in four values
    try {
      return std::make_shared<const Table>(TableOfAngles(rows, layout.hands));
    } catch (const UserError& error) {
      throw UserError({.place = name, .problem = error.what()});
    }
  }
  // No hand, or so many numbers of another kind.
  if (source == nullptr) return table ? TableInput(table) : input;
  if (!text.empty()) return WithHead(std::move(text), nullptr);
  return WithHead(std::move(head), std::move(*source));
}

}  // namespace gauntlet::sim
