#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sim/base/csv_line.h"
#include "sim/base/json.h"
#include "sim/base/quantile.h"
#include "sim/base/signal.h"
#include "sim/fit/retarget/retargeting.h"

namespace gauntlet::sim {
namespace {

constexpr double kDeepOverlap_m = 0.001;

std::string NameOfFile(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

double ShareAbove(const std::vector<double>& values, double limit) {
  return static_cast<double>(std::ranges::count_if(values, [=](double v) { return v > limit; })) /
         static_cast<double>(values.size());
}

/// Pinches of the recording: all, and those kept.
struct Pinches {
  std::size_t count = 0;
  std::size_t kept = 0;
};
Pinches PinchesOf(const std::vector<double>& gap_m) {
  return {.count = gap_m.size(),
          .kept = static_cast<std::size_t>(
              std::ranges::count_if(gap_m, [](double gap) { return gap <= kContactGap_m; }))};
}
Pinches AllPinches(const RetargetedMotion& retargeted) {
  Pinches all;
  for (const std::vector<double>& gaps : retargeted.pinch_gap_m) {
    const Pinches pinches = PinchesOf(gaps);
    all.count += pinches.count;
    all.kept += pinches.kept;
  }
  return all;
}

std::vector<double> AllTipErrors(const RetargetedMotion& retargeted) {
  std::vector<double> all;
  for (const std::vector<double>& errors : retargeted.tip_error_m) {
    all.insert(all.end(), errors.begin(), errors.end());
  }
  return all;
}

ResultCell Millimetres(double value_m) {
  if (!std::isfinite(value_m)) return {{value_m}, "-"};
  return {{1e3 * value_m}, fmt::format("{:.1f}", 1e3 * value_m)};
}

ResultTable DigitTable(const RetargetedMotion& retargeted) {
  ResultTable table{.columns = {{"digit", "digit"},
                                {"scale", "scale"},
                                {"tip_error_median_mm", "error, median", "mm"},
                                {"tip_error_95_mm", "error, 95 %", "mm"},
                                {"contacts", "contacts", "frames"},
                                {"contacts_kept", "kept", "frames"},
                                {"gap_95_mm", "gap, 95 %", "mm"}}};
  for (int digit = 0; digit < HandKinematics::kFingers; ++digit) {
    const std::vector<double>& errors = retargeted.tip_error_m[digit];
    if (errors.empty()) continue;
    const std::vector<double>& gaps = retargeted.pinch_gap_m[digit];
    const Pinches pinches = PinchesOf(gaps);
    const bool is_thumb = digit == HandKinematics::kThumb;
    const auto count = [&](std::size_t number) {
      return is_thumb ? ResultCell({std::monostate()}, "")
                      : ResultCell(static_cast<std::int64_t>(number));
    };
    table.rows.push_back(
        {ResultCell(std::string(HandKinematics::kFingerNames[digit])),
         {{retargeted.scale[digit]}, fmt::format("{:.2f}", retargeted.scale[digit])},
         Millimetres(Quantile(errors, 0.5)),
         Millimetres(Quantile(errors, 0.95)),
         count(pinches.count),
         count(pinches.kept),
         is_thumb ? ResultCell({std::monostate()}, "") : Millimetres(Quantile(gaps, 0.95))});
  }
  return table;
}

std::string PinchText(const RetargetedMotion& retargeted) {
  const Pinches pinches = AllPinches(retargeted);
  if (pinches.count == 0) return "The recording has no contact of thumb and finger.";
  return fmt::format(
      "Kept contacts of thumb and finger: {} of {} ({:.1f} %).", pinches.kept, pinches.count,
      100.0 * static_cast<double>(pinches.kept) / static_cast<double>(pinches.count));
}

std::string OverlapText(const HandKinematics& hand, const RetargetedMotion& retargeted,
                        double copied_overlap_share) {
  if (!hand.has_capsules()) {
    return "Interpenetration is not avoided: the hand has no capsules that can touch.";
  }
  std::string text =
      fmt::format("Digits interpenetrate by more than 1 mm in {:.1f} % of the frames",
                  100.0 * ShareAbove(retargeted.overlap_m, kDeepOverlap_m));
  if (std::isfinite(copied_overlap_share)) {
    text += fmt::format(" (copied angles: {:.1f} %)", 100.0 * copied_overlap_share);
  }
  return text + ".";
}

std::string LimitText(const RetargetedMotion& retargeted) {
  constexpr double kOften = 0.1;
  std::vector<std::string> joints;
  for (std::size_t i = 0; i < retargeted.joints.size(); ++i) {
    const double share = retargeted.share_at_limit[i];
    if (share < kOften) continue;
    joints.push_back(fmt::format("{} {:.0f} %", retargeted.joints[i], 100.0 * share));
  }
  if (joints.empty()) return "";
  return fmt::format("At a limit of the range in 10 % of the frames or more: {}.", Listed(joints));
}

std::string SpeedText(const RetargetedMotion& retargeted) {
  std::string text =
      fmt::format("Fastest joint: {:.0f} deg/s.", retargeted.fastest_rad_s * kDegPerRad);
  if (retargeted.frames_at_most_speed > 0) {
    text +=
        fmt::format(" This is the limit; it binds in {} frames.", retargeted.frames_at_most_speed);
  }
  return text;
}

}  // namespace

std::string RetargetedCsv(const FingertipMotion& motion, const HandKinematics& hand,
                          const RetargetedMotion& retargeted) {
  std::string csv = fmt::format(
      "# Made by gauntlet retarget: joint angles [deg] of {} whose fingertips do what those of {} "
      "did in {}.\n# {} {}\n",
      NameOfFile(hand.file()), NameOfFile(motion.hand), NameOfFile(motion.file),
      PinchText(retargeted), OverlapText(hand, retargeted, kNaN));
  std::vector<std::string> cells = {"time_s"};
  cells.insert(cells.end(), retargeted.joints.begin(), retargeted.joints.end());
  cells.insert(cells.end(), motion.other_joints.begin(), motion.other_joints.end());
  csv += CsvLine(cells);
  const auto angle_text = [](double rad) {
    return std::isfinite(rad) ? fmt::format("{:.4f}", rad * kDegPerRad + 0.0) : "";
  };
  for (std::size_t k = 0; k < motion.time_s.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    cells = {NumberOrNothing(motion.time_s[k])};
    for (const double angle : retargeted.angle_rad.row(row)) cells.push_back(angle_text(angle));
    for (Eigen::Index i = 0; i < motion.other_angle_rad.cols(); ++i) {
      cells.push_back(angle_text(motion.other_angle_rad(row, i)));
    }
    csv += CsvLine(cells);
  }
  return csv;
}

double CopiedOverlapShare(const FingertipMotion& motion, HandKinematics& hand) {
  std::vector<Eigen::Index> places;
  for (const HandJoint& joint : hand.joints()) {
    const auto found = std::ranges::find(motion.joints, joint.name);
    if (found == motion.joints.end() || !hand.has_capsules()) return kNaN;
    places.push_back(found - motion.joints.begin());
  }
  std::vector<double> overlap_m;
  std::vector<double> angles(places.size());
  for (Eigen::Index row = 0; row < motion.angle_rad.rows(); ++row) {
    if (motion.is_missing[static_cast<std::size_t>(row)]) continue;
    for (std::size_t i = 0; i < places.size(); ++i) angles[i] = motion.angle_rad(row, places[i]);
    hand.SetAngles(angles);
    overlap_m.push_back(hand.Overlap());
  }
  return ShareAbove(overlap_m, kDeepOverlap_m);
}

ResultText RetargetedText(const FingertipMotion& motion, const HandKinematics& hand,
                          const RetargetedMotion& retargeted, double copied_overlap_share) {
  const std::vector<double> errors = AllTipErrors(retargeted);
  ResultText text = {fmt::format("{}: {} frames; from {} to {}", NameOfFile(motion.file),
                                 retargeted.frames, NameOfFile(motion.hand),
                                 NameOfFile(hand.file()))};
  text.emplace_back(fmt::format("Fingertips are {:.1f} mm from the scaled recording (median; 95 %: "
                                "{:.1f} mm). ",
                                1e3 * Quantile(errors, 0.5), 1e3 * Quantile(errors, 0.95)) +
                    PinchText(retargeted) + " " +
                    OverlapText(hand, retargeted, copied_overlap_share));
  text.emplace_back(DigitTable(retargeted));
  text.emplace_back(
      "Error: of the fingertip. Contacts: frames of the recording in which thumb and finger touch. "
      "Gap: between them in these frames.");
  AddLine(SpeedText(retargeted), text);
  AddLine(LimitText(retargeted), text);
  const auto missing = std::ranges::count(motion.is_missing, true);
  if (missing > 0) {
    AddLine(fmt::format("Left empty: {} frames with a missing value.", missing), text);
  }
  return text;
}

std::string RetargetedJson(const FingertipMotion& motion, const HandKinematics& hand,
                           const RetargetedMotion& retargeted, double copied_overlap_share) {
  ResultTable joints{.columns = {{"joint"}, {"share_at_limit"}}};
  for (std::size_t i = 0; i < retargeted.joints.size(); ++i) {
    joints.rows.push_back(
        {ResultCell(retargeted.joints[i]), ResultCell(retargeted.share_at_limit[i])});
  }
  const double overlap_share =
      hand.has_capsules() ? ShareAbove(retargeted.overlap_m, kDeepOverlap_m) : kNaN;
  const Json json = {{"recording", motion.file},
                     {"from", motion.hand},
                     {"hand", hand.file()},
                     {"frames", retargeted.frames},
                     {"frames_missing", std::ranges::count(motion.is_missing, true)},
                     {"overlap_share", overlap_share},
                     {"copied_overlap_share", copied_overlap_share},
                     {"fastest_deg_s", retargeted.fastest_rad_s * kDegPerRad},
                     {"frames_at_speed_limit", retargeted.frames_at_most_speed},
                     {"digits", JsonOf(DigitTable(retargeted))},
                     {"joints", JsonOf(joints)}};
  return json.dump(2) + "\n";
}

}  // namespace gauntlet::sim
