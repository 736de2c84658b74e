#pragma once

#include <vector>

namespace gauntlet::controller {

/// The measurement variances of the paper's 18 glove channels [counts^2].
/// Source: Bai, Jiang, Yokoi (arXiv:2103.02750), section 2.4.
inline std::vector<double> PaperMeasurementVariance() {
  return {21.18, 12.52, 10.62, 9.86, 26.94, 10.08, 9.71,  17.58, 6.05,
          9.91,  47.19, 11.04, 7.56, 23.94, 26.82, 28.82, 27.69, 31.49};
}

}  // namespace gauntlet::controller
