#pragma once

#include <string>
#include <string_view>

#include "sim/tables/table.h"

namespace gauntlet::sim {

/// True for the beginning of a storage or motion file of OpenSim or SIMM (.sto, .mot): it has a
/// line `endheader`.
bool IsStorage(std::string_view head);

/// The table below the header of such a file. `inDegrees`, or the sentence `Angles are in degrees.`
/// of older versions, is the unit of its angles; columns that only name a joint end with it:
/// `index_mcp_rad`. Cells of vectors and quaternions (`DataType=Vec3`) become a column for each
/// number: `torso_imu_w` .. `_z`. A number of rows other than that of the header is a remark.
///
/// Source: OpenSim documentation, Motion (.mot) Files and Storage (.sto) Files.
/// Errors: UserError `name:line: ..` for a header that cannot be read, and for a file without rows.
Table TableOfStorage(const std::string& name, std::string_view text);

}  // namespace gauntlet::sim
