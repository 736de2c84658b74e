#pragma once

#include <string>

#include "sim/fit/retarget/retargeting.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

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
