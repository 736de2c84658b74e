#pragma once

#include "sim/hand/engine_types.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// Object, its support and the palm in the model.
struct GraspParts {
  int object_body = -1;
  int palm_body = -1;
  int skin_geom = -1;  // the surface that the hand touches
  int foot_geom = -1;  // the one that the support touches
  int support_mocap = -1;
  int qpos = -1;  // of the object: position and quaternion
  double radius_m = 0.0;
  double half_height_m = 0.0;
  double support_half_height_m = 0.0;

  bool exists() const { return object_body >= 0; }
};

/// Finds the object and gives it the size, mass and friction of the settings.
/// Errors: UserError for a model without its parts.
GraspParts MakeObject(mjModel_& model, const ObjectConfig& config);

/// Upright in front of the palm of the posture in `data`, between thumb and fingers, with the
/// support under it. Wants a posture with the thumb up and the fingers 30 deg above the horizontal:
/// a hand holds a cylinder obliquely, from the base of the thumb to the knuckle of the index
/// finger. Fingers that close on one across the palm tilt it by as much, as they pull it below the
/// thumb.
void PlaceObject(const GraspParts& grasp, mjData_& data);

/// Forces on the object [N].
struct ObjectForces {
  double grip_n = 0.0;     // sum of the normal forces between it and the hand
  double carried_n = 0.0;  // size of the sum of all forces of the hand on it
  double support_n = 0.0;  // sum of the normal forces between it and the support
};
ObjectForces ForcesOnObject(const mjModel_& model, const GraspParts& grasp,
                            const mjData_& data) noexcept;

}  // namespace gauntlet::sim
