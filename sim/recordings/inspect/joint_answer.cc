#include "sim/recordings/inspect/joint_answer.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kNone = "-";

void CheckJoints(const std::vector<std::string>& joints, std::size_t columns) {
  const std::vector<std::string> channels = KnownChannelNames();
  for (const std::string& joint : joints) {
    if (joint == kNone) continue;
    if (std::ranges::find(channels, joint) == channels.end()) {
      throw UserError(fmt::format("unknown joint {}{}", Shown(joint), Suggestion(joint, channels)));
    }
    if (std::ranges::count(joints, joint) > 1) throw UserError(joint + " appears twice");
  }
  if (joints.size() != columns) {
    throw UserError(fmt::format("{} joint{} for {} column{}; - for a column without a joint",
                                joints.size(), joints.size() == 1 ? "" : "s", columns,
                                columns == 1 ? "" : "s"));
  }
  if (std::ranges::all_of(joints, [](const std::string& joint) { return joint == kNone; })) {
    throw UserError("no column has a joint");
  }
}

}  // namespace

std::vector<std::size_t> ColumnsToName(const Inspection& inspection) {
  const bool is_open = !inspection.question.empty() && inspection.asks_joints;
  return is_open ? inspection.Sensors() : std::vector<std::size_t>();
}

std::vector<Profile> ProfilesForColumns(const Inspection& inspection) {
  std::vector<Profile> profiles = AllProfiles(std::filesystem::absolute(inspection.file));
  const auto columns = static_cast<double>(ColumnsToName(inspection).size());
  std::erase_if(profiles, [columns](const Profile& profile) {
    const std::vector<double>& width = profile.match.columns;
    return !profile.match.names.empty() || width.empty() || columns < width.front() ||
           columns > width.back();
  });
  return profiles;
}

Inspection WithJoints(Inspection inspection, const std::vector<std::string>& joints) {
  const std::vector<std::size_t> columns = ColumnsToName(inspection);
  CheckJoints(joints, columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    InspectedColumn& column = inspection.columns[columns[i]];
    column.channel = joints[i] == kNone ? "" : joints[i];
    column.basis = JointBasis::kMap;
    column.why = joints[i] == kNone ? "no joint, as answered" : "as answered";
    column.is_dead = column.is_dead && column.channel.empty();  // the map names it, as asked
  }
  inspection.question.clear();
  return inspection;
}

}  // namespace gauntlet::sim
