#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// `gauntlet export --for`: what of a controller becomes lines of another library.
struct LinesRequest {
  std::string folder;      // of run or compare, whose scores the price is from
  std::string controller;  // of its scenario
  std::string library;     // a name of Libraries()
  bool exact = false;      // a filter that it does not have is an error
  std::string channel;     // whose scale and settings the lines have; empty: all
  std::string unit;        // of the signal there; empty: that of the recording's columns, else deg
};

/// Notes as comments at the head of a file, wrapped, each line behind `mark`.
std::string CommentsOf(const std::vector<std::string>& notes, std::string_view mark);

/// The controller's filter as lines of a library, below comments that tell signal, version and
/// differences. Where the library does not have the filter, the closest that it has, tuned for the
/// scenario of the folder, and the price; on a terminal with progress. Errors: UserError for a
/// library that has none, and for several filters; RunError if the search has no answer.
std::string LinesOf(const Scenario& scenario, const LinesRequest& request);

}  // namespace gauntlet::sim
