#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/fit/retarget/fingertip_motion.h"

namespace gauntlet::sim {

/// Columns of a recording as they are in the file, by name.
struct MotionTable {
  std::string file;
  std::vector<std::string> columns;  // those that were read
  std::vector<std::string> ignored;  // all others but time and sample numbers
  std::vector<double> time_s;        // rises strictly
  Eigen::MatrixXd values;            // rows x columns; NaN is missing
};

/// Reads the columns of which `is_wanted` is true. Times are from columns of time (TimeByName), or
/// from the rate of `format` where that is above 0.
/// Errors: UserError with file, row and column, if there are no names or no times, or if a time is
/// missing or does not rise.
MotionTable LoadMotionTable(const std::filesystem::path& file, const FingertipFormat& format,
                            const std::function<bool(std::string_view column)>& is_wanted);

}  // namespace gauntlet::sim
