#pragma once

namespace gauntlet::sim {

struct Twice {
  int b = 0;
};

}  // namespace gauntlet::sim
