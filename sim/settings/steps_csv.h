#pragma once

#include <span>
#include <string>
#include <string_view>

#include "controller/sample_guard_config.h"
#include "controller/timing.h"

namespace gauntlet::sim {

/// Name of a state or a reason, as files and Python have it: `too_often`, `out_of_range`.
std::string_view NameOf(controller::GloveStatus status);
std::string_view NameOf(controller::Untrusted reason);
std::string_view NameOf(controller::LoopStatus status);

/// The rows of controller::StepRecorder::CopyTo() as CSV, with a line of `column_names` first. All
/// digits; the state of the glove and the reasons of untrusted values are names. A cell is empty if
/// there is no value, and in a column `untrusted.CHANNEL` if no value was untrusted.
///
/// Shapes: whole rows, each as long as `column_names`.
std::string StepsToCsv(std::span<const std::string> column_names, std::span<const double> rows);

}  // namespace gauntlet::sim
