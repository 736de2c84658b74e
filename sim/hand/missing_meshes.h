#pragma once

#include <string>
#include <vector>

#include "sim/hand/mjcf_element.h"

namespace gauntlet::sim {

/// Leaves out meshes and pictures whose files are missing, with the geoms and the materials that
/// show them. Possible where no mass comes from such a geom: its body has an <inertial> or
/// cannot move, or its own mass or density is 0. Adds sentences to `notes`. `root`: a
/// whole model, without includes.
/// Returns whether a geom that can touch was left out.
/// Errors: UserError with the place of a geom that gives its body mass.
bool LeaveOutMissingMeshes(MjcfElement& root, std::vector<std::string>& notes);

}  // namespace gauntlet::sim
