#pragma once

#include <stdexcept>
#include <string>

namespace gauntlet::sim {

/// The user's mistake: one line with place, field, value and allowed range. Exit code 2.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The run failed although the input was right: a full disk, a diverged simulation. Exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Long work was stopped on request (Ctrl-C).
struct Cancelled {
  std::string kept = {};  // what of it was not in vain, for the user; may be empty
};

}  // namespace gauntlet::sim
