#include "controller/filters/subnormal.h"

#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void CopyAll(const double* from, double* to, int count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < count; ++i) to[i] = WithoutSubnormal(from[i]);
}

}  // namespace

void CopyWithoutSubnormals(const double* from, double* to, int count) noexcept {
  CopyAll(from, to, count);
}

}  // namespace gauntlet::controller
