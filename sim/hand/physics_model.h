#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/hand/drive.h"
#include "sim/hand/engine_types.h"

namespace gauntlet::sim {

/// Model that the engine steps: a compiled model without spools, which the hand turns itself, and
/// without all that no force comes from. That is sites, cameras, lights, sensors, geoms that cannot
/// touch, and cables, unless the engine measures them. A spool is part of the body that carries it.
/// All other bodies and joints have inertias, springs and dampers of the whole model to the last
/// bit: it has been compiled, so that masses which come from geoms are there already.
///
/// Shares its arrays with the whole model, which has to live as long.
/// Errors: UserError for a model in which something else holds on to a spool.
class PhysicsModel {
 public:
  /// Spools are cut out, or stand still in a copy of the whole model: the only way with an engine
  /// whose models cannot be cut (mujoco_versions.h).
  enum class Spools { kCutOut, kStandStill };

  PhysicsModel(const mjModel_& whole, const std::vector<Drive>& drives,
               bool engine_measures_cables);
  PhysicsModel(const mjModel_& whole, const std::vector<Drive>& drives, bool engine_measures_cables,
               Spools spools);
  ~PhysicsModel();

  const mjModel_& model() const { return *model_; }

  // Index here of a part of the whole model; -1 for one that has gone.
  int GeomOf(int whole) const { return geoms_.index_of[whole]; }
  int BodyOf(int whole) const { return bodies_.index_of[whole]; }
  int DofOf(int whole) const { return dofs_.index_of[whole]; }
  int QposOf(int whole) const { return positions_.index_of[whole]; }
  /// All positions here, of those of the whole model.
  void CopyPositions(const double* whole_qpos, double* qpos) const;

 private:
  /// The rows of a kind that stay.
  struct Rows {
    std::vector<int> kept;      // in the whole model
    std::vector<int> index_of;  // per row of the whole model
  };
  static Rows Keep(const std::vector<bool>& kept);

  void Cut(const mjModel_& whole, const std::vector<Drive>& drives, bool tendons);
  void Hold(const mjModel_& whole, const std::vector<Drive>& drives, bool tendons);
  void LeaveOutAids(bool tendons);
  template <class Value>
  void Select(Value*& rows, int columns, const std::vector<int>& kept);
  void SelectRows(std::string_view count_name, const Rows& rows);
  static void Number(int* ids, int count, const Rows& rows);
  void NumberParts(const mjModel_& whole);
  void NumberConstraints(const mjModel_& whole);
  void NumberSignature(int& signature) const;

  std::unique_ptr<mjModel_, void (*)(mjModel_*)> model_;
  std::vector<std::unique_ptr<std::byte[]>> arrays_;  // those that differ from the whole model's
  Rows bodies_, joints_, dofs_, positions_, geoms_;
};

}  // namespace gauntlet::sim
