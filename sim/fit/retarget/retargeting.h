#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "sim/fit/retarget/fingertip_motion.h"
#include "sim/hand/hand_kinematics.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// Weights and limits of the retargeting.
struct RetargetingConfig {
  // Share of a pinch in the cost of a finger: 0 above `pinch_far_m`, rises to `pinch_most` at
  // `pinch_near_m`. Wuji's retargeting blends so between 40 and 20 mm between tips, up to 0.7: gaps
  // of 25 and 5 mm between pads.
  double pinch_near_m = 0.005;
  double pinch_far_m = 0.025;
  double pinch_most = 0.7;
  double pinch_weight = 200.0;       // of the gap; DexPilot's for a projected pinch
  double direction_length_m = 0.02;  // an angle of the last phalanx counts as so long an arc
  double clearance_m = 0.0005;       // least gap between digits
  double overlap_weight = 1e4;       // of missing clearance: 10 mm of reach cost 0.01 mm of overlap
  double acceleration_weight = 1e-9;  // m^2 s^4/rad^2: fingertips follow up to 6 Hz
  double damping_m2 = 1e-6;           // per rad^2, to the frame before: dex-retargeting's 4e-3
  double most_speed_rad_s = 15.0;     // of any joint
};

/// Angles of a hand whose fingertips do what those of another hand did.
struct RetargetedMotion {
  std::vector<std::string> joints;  // those that move a fingertip of the motion
  Eigen::MatrixXd angle_rad;        // rows x joints; NaN where the motion is missing
  std::array<double, HandKinematics::kFingers> scale = {};  // of the reach of each digit
  double pinch_scale = 1.0;
  /// Per digit the distance from the wanted place of its tip [m], per frame; empty without digit.
  std::array<std::vector<double>, HandKinematics::kFingers> tip_error_m;
  /// Per finger the gap to the thumb in frames with contact in the recording [m].
  std::array<std::vector<double>, HandKinematics::kFingers> pinch_gap_m;
  std::vector<double> overlap_m;         // per frame that is not missing
  std::vector<double> cost_m2;           // likewise
  std::vector<double> share_at_limit;    // of frames, per joint
  double fastest_rad_s = 0.0;            // of all joints
  std::size_t frames_at_most_speed = 0;  // some joint moves as fast as is allowed
  std::size_t frames = 0;                // not missing
};

/// Largest gap that counts as contact, in the recording and in the hand [m].
inline constexpr double kContactGap_m = 0.002;

/// Gap that the hand shall have for a gap of the recording [m]: that of a contact stays, what is
/// beyond it is scaled; at least `clearance_m`.
double WantedGap(double gap_m, double scale, double clearance_m);

/// Finds the joint angles q of `hand` with the least sum over all frames of
///
///     sum over digits   (1 - a_i) (|t_i - b_i - s_i v_i|^2 + L^2 |n_i - u_i|^2)
///     sum over fingers  a_i (|t_i - t_thumb - s p_i|^2 + W (g_i - h_i)^2)
///     sum over pairs of capsules of two digits  O max(c - d, 0)^2
///     S |q''|^2
///
/// within the joints' ranges and the largest speed. Of the hand: t, b tip and base of a digit, n
/// direction of its last phalanx, g gap between the last phalanges of thumb and finger, d gap of
/// two capsules. Of the recording: v from base to tip, u direction of the last phalanx, p from the
/// thumb's tip to the finger's, h gap by WantedGap(). s_i is the ratio of the digits' lengths, s
/// that of their sums. a_i blends from reach to pinch by the gap in the recording; the thumb has
/// the largest of all fingers. c, L, O, S, W: see RetargetingConfig. b_i + s_i v_i is a vector from
/// the wrist to the tip, whose part in the palm is the hand's own.
///
/// First each frame from the frame before, with D |q - q'|^2 for directions that no term decides,
/// the first frame and any after a second without one from many postures; then all frames at once,
/// which adds S; last the speed is limited. Joints that move no recorded digit stay at 0. The same
/// bits each time.
/// Source: dex-retargeting (Qin et al., AnyTeleop, 2023), DexPilot (arXiv:1910.03135) and Wuji's
/// retargeting for the terms; the gap of capsules instead of a distance of tips is ours.
/// Errors: UserError if hand and motion have no fingertip in common, or if no row is complete.
RetargetedMotion Retarget(const FingertipMotion& motion, HandKinematics& hand,
                          const RetargetingConfig& config = {});

/// The recording of a retargeted motion: CSV with `time_s` and angles [deg] by joint. Angles of arm
/// and wrist that the hand has, too, are copied. A row with a missing value has empty cells. The
/// first lines, behind '#', have what was done.
std::string RetargetedCsv(const FingertipMotion& motion, const HandKinematics& hand,
                          const RetargetedMotion& retargeted);

/// Share of frames in which two digits of `hand` interpenetrate by more than 1 mm if it copies the
/// angles of the motion by name; NaN unless the motion has all of its joints.
double CopiedOverlapShare(const FingertipMotion& motion, HandKinematics& hand);

/// Answer, table by digit, doubts. `copied_overlap_share`: see CopiedOverlapShare().
ResultText RetargetedText(const FingertipMotion& motion, const HandKinematics& hand,
                          const RetargetedMotion& retargeted, double copied_overlap_share);
std::string RetargetedJson(const FingertipMotion& motion, const HandKinematics& hand,
                           const RetargetedMotion& retargeted, double copied_overlap_share);

}  // namespace gauntlet::sim
