#pragma once

// The physics engine's model and state, for headers that others include: what they hold is known in
// hand/ and video/ only, which include <mujoco/mujoco.h>.
struct mjModel_;
struct mjData_;
