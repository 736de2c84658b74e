#pragma once

#include <string>
#include <vector>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// Compares the seeds of a study: do they differ in the motion of the wearer, and in anything at
/// all?
class Repeats {
 public:
  /// Makes one more signal for each repetition that comes twice among so many seeds.
  Repeats(const Study& study, int seeds);

  /// True if every repetition is the same again.
  bool alike() const { return alike_; }
  /// The number of the motion of each of so many seeds; motions are numbered as they come.
  std::vector<int> MotionNumbers(std::size_t seeds) const;

 private:
  std::string MotionOf(std::size_t seed_index) const;

  const Study& study_;
  std::size_t count_;
  bool alike_ = false;
  std::vector<bool> is_drawn_;  // per repetition: another motion for every seed
};

}  // namespace gauntlet::sim
