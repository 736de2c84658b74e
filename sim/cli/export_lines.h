#pragma once

#include <string>

#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// `gauntlet export --for`: what of a controller becomes lines of another library.
struct LinesRequest {
  std::string folder;      // of run or compare, whose scores the price is from
  std::string controller;  // of its scenario
  std::string library;     // a name of Libraries()
  std::string channel;     // whose scale and settings the lines have; empty: all
  std::string unit;        // of the signal there; empty: counts of a glove that was recorded in
                           // counts, else deg
};

/// The controller's filter as lines of a library, below comments that tell signal, version and
/// differences. Errors: UserError for a filter that the library does not have, with the best of
/// the folder that it has and its price, and the libraries that have it; for several filters.
std::string LinesOf(const Scenario& scenario, const LinesRequest& request);

}  // namespace gauntlet::sim
