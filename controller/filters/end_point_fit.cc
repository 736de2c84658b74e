#include "controller/filters/end_point_fit.h"

#include "controller/assert.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void SumRows(const double* rows, int row_count, int newest,
                                 const double* weights, double* sum, int channel_count) {
  for (int i = 0; i < channel_count; ++i) sum[i] = 0.0;
  int index = newest;
  for (int age = 0; age < row_count; ++age) {
    const double* row = rows + std::ptrdiff_t{index} * channel_count;
    const double weight = weights[age];
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) sum[i] += weight * row[i];
    index = index == 0 ? row_count - 1 : index - 1;
  }
}

}  // namespace

void WeightedSum(const SampleWindow& window, const Eigen::ArrayXd& weights, double* sum) noexcept {
  GAUNTLET_ASSERT(weights.size() == window.length());
  SumRows(window.rows(), window.length(), window.newest(), weights.data(), sum,
          window.channel_count());
}

}  // namespace gauntlet::controller
