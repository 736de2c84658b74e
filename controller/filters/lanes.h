#pragma once

#include <cstring>

#include "controller/assert.h"
#include "controller/filters/subnormal.h"

/// For what has to be compiled into the function that is made for a kind of processor.
#define GAUNTLET_INLINE inline __attribute__((always_inline))

namespace gauntlet::controller {

/// Four channels side by side, as GCC and clang have them for every processor: one whose registers
/// are narrower takes several.
using Lanes = double __attribute__((vector_size(32)));
inline constexpr int kLanes = 4;

/// Whether that is worth its code: a processor of a robot's microcontroller has no such registers.
#if defined(__x86_64__) || defined(__aarch64__)
inline constexpr bool kLanesPay = true;
#else
inline constexpr bool kLanesPay = false;
#endif

GAUNTLET_INLINE void LoadLanes(const double* from, Lanes& lanes) noexcept {
  std::memcpy(&lanes, from, sizeof lanes);
}
GAUNTLET_INLINE void StoreLanes(const Lanes& lanes, double* to) noexcept {
  std::memcpy(to, &lanes, sizeof lanes);
}
/// See WithoutSubnormal().
GAUNTLET_INLINE void DropSubnormals(Lanes& lanes) noexcept {
  lanes = (lanes > -kLeastValue) & (lanes < kLeastValue) ? Lanes{} : lanes;
}

/// Steps channels through samples that follow each other, with what they need for it in registers:
/// it does not go through memory, which takes a third of the time of a short filter and half of
/// that of a straight line.
///
/// `Filter` is the state of four channels: Load(memory, first channel), Step(lanes), which turns a
/// sample into what is given, and Store(memory, first channel). kCount of them are stepped side by
/// side. The last may reach back into channels of the one before, which both step to the same bits.
///
/// Shapes: rows of `stride` values, of which `channels` count from `first` on, 4 (kCount - 1) + 1
/// to 4 kCount and at least 4. `input` and `output` may be the same memory.
template <int kCount, class Filter, class Memory>
GAUNTLET_INLINE void StepRows(const Memory& memory, int first, int channels, const double* input,
                              double* output, int stride, int samples) noexcept {
  GAUNTLET_ASSERT(kLanes <= channels);
  GAUNTLET_ASSERT(kLanes * (kCount - 1) < channels && channels <= kLanes * kCount);
  GAUNTLET_ASSERT(0 <= first && first + channels <= stride);
  int begin[kCount];
  for (int i = 0; i < kCount; ++i) begin[i] = first + i * kLanes;
  begin[kCount - 1] = first + channels - kLanes;
  Filter filters[kCount];
  for (int i = 0; i < kCount; ++i) filters[i].Load(memory, begin[i]);
  for (; samples > 0; --samples, input += stride, output += stride) {
    Lanes last;
    LoadLanes(input + begin[kCount - 1], last);  // before its neighbour overwrites a part of it
    for (int i = 0; i + 1 < kCount; ++i) {
      Lanes lanes;
      LoadLanes(input + begin[i], lanes);
      filters[i].Step(lanes);
      StoreLanes(lanes, output + begin[i]);
    }
    filters[kCount - 1].Step(last);
    StoreLanes(last, output + begin[kCount - 1]);
  }
  for (int i = 0; i < kCount; ++i) filters[i].Store(memory, begin[i]);
}

/// Calls step<kCount>(first, count) for parts of `channels`, which are four or more: each a
/// multiple of four or a little less, and no more than registers hold.
template <class Step>
GAUNTLET_INLINE void ForParts(int channels, const Step& step) noexcept {
  GAUNTLET_ASSERT(channels >= kLanes);
  constexpr int kMost = 5 * kLanes;
  const int parts = (channels + kMost - 1) / kMost;
  for (int part = 0; part < parts; ++part) {
    const int first = part * channels / parts;
    const int count = (part + 1) * channels / parts - first;
    switch ((count + kLanes - 1) / kLanes) {
      case 1:
        step.template operator()<1>(first, count);
        break;
      case 2:
        step.template operator()<2>(first, count);
        break;
      case 3:
        step.template operator()<3>(first, count);
        break;
      case 4:
        step.template operator()<4>(first, count);
        break;
      default:
        step.template operator()<5>(first, count);
        break;
    }
  }
}

}  // namespace gauntlet::controller
