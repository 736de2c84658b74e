#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/table.h"

namespace gauntlet::sim {

/// The header of a file of marker positions (.trc).
struct TrcHeader {
  std::vector<std::string> markers = {};
  std::string unit = {};                  // m, cm or mm, or as the file has it; empty: none
  std::optional<std::int64_t> rows = {};  // as the file says; none: it does not
  /// Instead of the header: empty lines, and in its last one the names of the columns with tabs
  /// between them: `Frame#`, `Time` [s], and `MARKER_x_mm` .. `MARKER_z_mm` of each marker.
  std::string names = {};
  std::size_t bytes = 0;  // of the header, without the end of its last line
};

/// True for the beginning of such a file.
bool IsTrc(std::string_view head);

/// Source: OpenSim documentation, Marker (.trc) Files.
/// Errors: UserError `name:line: ..` if there are not three components below each name of a marker.
TrcHeader ReadTrcHeader(const std::string& name, std::string_view text);

/// The table of such a file. An empty cell is a missing value. The names of the markers are a
/// remark, and so is a number of rows other than that of the header.
/// Errors: as of ReadTrcHeader(), and for a file without rows.
Table TableOfTrc(const std::string& name, std::string_view text);

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
