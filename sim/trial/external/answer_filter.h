#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Makes filters that give one row of a table after the other, whatever their input: what another
/// program made of the same samples. A value that is missing is the last one that was not, at first
/// the input. Behind the last row its values stay.
///
/// `answers`: samples x channels, in the unit of the filter's input; `channel_names`: of its
/// columns. The filters keep the table.
std::shared_ptr<const controller::FilterMaker> MakerOfAnswers(
    Signal answers, std::vector<std::string> channel_names);

}  // namespace gauntlet::sim
