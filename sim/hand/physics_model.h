#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sim/hand/drive.h"
#include "sim/hand/engine_types.h"

namespace gauntlet::sim {

/// What is left of a compiled model when all goes that no force comes from: sites, cameras, lights,
/// sensors, geoms that cannot touch, and cables, unless the engine measures them. Bodies, joints,
/// their inertias, springs and dampers are those of the whole model to the last bit; it has been
/// compiled, so that masses which come from geoms are there already.
///
/// Shares its arrays with the whole model, which has to live as long.
class PhysicsModel {
 public:
  PhysicsModel(const mjModel_& whole, const std::vector<Drive>& drives,
               bool engine_measures_cables);
  ~PhysicsModel();

  const mjModel_& model() const { return *model_; }
  /// Index of a geom of the whole model; -1 for one that has gone.
  int GeomOf(int whole_geom) const { return geom_of_[whole_geom]; }

 private:
  template <class Number>
  void Select(Number*& rows, int columns, const std::vector<int>& kept);
  void KeepGeoms(const std::vector<bool>& kept);

  std::unique_ptr<mjModel_> model_;
  std::vector<std::unique_ptr<std::byte[]>> arrays_;  // those that differ from the whole model's
  std::vector<int> geom_of_;
};

}  // namespace gauntlet::sim
