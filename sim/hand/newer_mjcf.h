#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/hand/mjcf_element.h"

namespace gauntlet::sim {

/// Treatment of a part of MJCF that the engine's version does not know.
enum class NewerMjcf {
  kDrop,     // changes neither kinematics nor inertia
  kReplace,  // by the value that comes nearest to it
  kRefuse,   // moves, couples or loads bodies
};

/// An element, an attribute or a value that came to MJCF after MuJoCo 2.2.2.
/// Source: change log of MuJoCo 2.2.2 to 3.7 (google-deepmind/mujoco, doc/changelog.rst).
struct NewerMjcfRow {
  std::string_view parent;  // element around it; empty: any
  std::string_view element;
  std::string_view attribute;  // empty: the element itself
  std::string_view value;      // empty: any
  NewerMjcf action = NewerMjcf::kDrop;
  std::string_view reason;  // of kReplace: the value instead
};
std::span<const NewerMjcfRow> NewerMjcfRows();

/// Removes or replaces what the rows name, everywhere below the root, and sets the default of newer
/// versions for limits (autolimits). Adds a sentence to `notes` for each row that changed
/// something. Errors: UserError with place and name for what the rows refuse.
void DropNewerMjcf(MjcfElement& root, std::vector<std::string>& notes);

}  // namespace gauntlet::sim
