#pragma once

namespace gauntlet::sim {

struct Twice {
  int a = 0;
};

}  // namespace gauntlet::sim
