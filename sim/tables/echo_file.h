#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sim/tables/message_file.h"

namespace gauntlet::sim {

/// True for the beginning of what `rostopic echo` and `ros2 topic echo` print: messages in YAML,
/// each before a line `---`.
bool IsEcho(std::string_view head);

/// Opens a text of `rostopic echo` or `ros2 topic echo` as a file with one topic, which has no
/// times but those in the headers of its messages. A last message without a line `---` behind it
/// is not read.
/// Errors: UserError without a place for a message that is no YAML or has shortened lists.
std::unique_ptr<MessageFile> OpenEcho(const std::filesystem::path& file);

}  // namespace gauntlet::sim
