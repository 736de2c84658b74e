#include "sim/study/repeats.h"

#include <fmt/format.h>

#include <algorithm>

namespace gauntlet::sim {

Repeats::Repeats(const Study& study, int seeds)
    : study_(study), count_(study.repetitions.size()), is_drawn_(count_, false) {
  const int count = static_cast<int>(count_);
  // A link has other random numbers for each seed.
  const bool has_links = study.scenario.link && study.scenario.link->exist();
  alike_ = seeds > count && !has_links;
  for (int i = 0; i < count && i + count < seeds; ++i) {
    const GloveFacts& first = study.repetitions[i];
    const GloveFacts next = FactsOf(*GloveOfSeed(study, study.scenario.seed + count + i));
    alike_ = alike_ && next.signal_hash == first.signal_hash;
    is_drawn_[i] = next.motion_hash != first.motion_hash;
  }
}

std::string Repeats::MotionOf(std::size_t seed_index) const {
  const std::size_t repetition = seed_index % count_;
  if (is_drawn_[repetition] && seed_index >= count_) {
    return fmt::format("of seed number {}", seed_index);
  }
  return study_.repetitions[repetition].motion_hash;
}

std::vector<int> Repeats::MotionNumbers(std::size_t seeds) const {
  std::vector<std::string> motions;
  std::vector<int> numbers;
  for (std::size_t i = 0; i < seeds; ++i) {
    const std::string motion = MotionOf(i);
    const auto known = std::ranges::find(motions, motion);
    numbers.push_back(static_cast<int>(known - motions.begin()));
    if (known == motions.end()) motions.push_back(motion);
  }
  return numbers;
}

}  // namespace gauntlet::sim
