#pragma once

#include <filesystem>
#include <memory>

#include "sim/tables/message_file.h"

namespace gauntlet::sim {

/// Opens a bag of ROS 2 in a SQLite file (.db3). It is only read, and no file is written beside
/// it. Source: ros2/rosbag2, rosbag2_storage_sqlite3.
/// Errors: UserError without a place for a damaged file, a database of another kind, and for a
/// file with messages in a log beside it (-wal), as of a recorder that was killed.
std::unique_ptr<MessageFile> OpenRosbag(const std::filesystem::path& file);

}  // namespace gauntlet::sim
