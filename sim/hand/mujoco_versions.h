#pragma once

// What differs between the MuJoCo that results refer to, 2.2.2, and those that GAUNTLET_MUJOCO
// names instead: all differences of their interfaces that concern Gauntlet. sim/hand/ only.

#include <mujoco/mujoco.h>

#include <cstddef>
#include <cstring>
#include <string>

namespace gauntlet::sim {

/// A tendon's row of the matrix of moment arms; without columns where the row has all of them.
struct TendonRow {
  const mjtNum* arm_m;
  const int* dof;
  int count;
};

#if mjVERSION_HEADER == 222

/// The engine of the published results. It knows no part of MJCF that came later (newer_mjcf.h).
inline constexpr bool kIsReference = true;
/// With it the volume of a mesh that is not convex counts once.
inline constexpr const char* kExactMeshes = "<compiler exactmeshinertia=\"true\"/>";
/// The engine's model is its arrays and no more, so that parts can be cut out of a compiled one.
/// Later ones also hold trees, bounding volumes and sparse matrices that name these parts.
inline constexpr bool kModelsCanBeCut = true;

inline void MulMatVec3(mjtNum* result, const mjtNum* matrix, const mjtNum* vector) {
  mju_rotVecMat(result, vector, matrix);
}
inline void MulMatTVec3(mjtNum* result, const mjtNum* matrix, const mjtNum* vector) {
  mju_rotVecMatT(result, vector, matrix);
}

inline bool IsActive(const mjModel& model, int equality) { return model.eq_active[equality] != 0; }

inline TendonRow RowOf(const mjModel& model, const mjData& data, int tendon) {
  if (!mj_isSparse(&model)) {
    return {data.ten_J + static_cast<std::size_t>(tendon) * model.nv, nullptr, model.nv};
  }
  const int begin = data.ten_J_rowadr[tendon];
  return {data.ten_J + begin, data.ten_J_colind + begin, data.ten_J_rownnz[tendon]};
}

inline int ActuatorCount(const mjModel& model) { return model.nu; }
inline void LeaveOutActuators(mjModel& model) { model.nu = model.na = 0; }

/// False if the engine cannot take the name, or has no memory.
inline bool AddText(mjVFS& files, const std::string& name, const std::string& text) {
  if (mj_makeEmptyFileVFS(&files, name.c_str(), static_cast<int>(text.size())) != 0) return false;
  std::memcpy(files.filedata[0], text.data(), text.size());
  return true;
}

#else  // 3.17 and 4.0

inline constexpr bool kIsReference = false;
inline constexpr const char* kExactMeshes = "inertia=\"exact\" of its <mesh>";
inline constexpr bool kModelsCanBeCut = false;

inline void MulMatVec3(mjtNum* result, const mjtNum* matrix, const mjtNum* vector) {
  mju_mulMatVec3(result, matrix, vector);
}
inline void MulMatTVec3(mjtNum* result, const mjtNum* matrix, const mjtNum* vector) {
  mju_mulMatTVec3(result, matrix, vector);
}

inline bool IsActive(const mjModel& model, int equality) { return model.eq_active0[equality]; }

inline TendonRow RowOf(const mjModel& model, const mjData& data, int tendon) {
  const int begin = model.ten_J_rowadr[tendon];
  return {data.ten_J + begin, model.ten_J_colind + begin, model.ten_J_rownnz[tendon]};
}

/// `nu` counts controls, of which an actuator can have several, or none.
inline int ActuatorCount(const mjModel& model) { return static_cast<int>(model.nactuator); }
inline void LeaveOutActuators(mjModel& model) { model.nactuator = model.nu = model.na = 0; }

inline bool AddText(mjVFS& files, const std::string& name, const std::string& text) {
  return mj_addBufferVFS(&files, name.c_str(), text.data(), static_cast<int>(text.size())) == 0;
}

#endif

}  // namespace gauntlet::sim
