#pragma once

#include <cstdint>

namespace gauntlet::sim {

/// A context of OpenGL that draws into memory. Pictures are rows from the bottom, from the place
/// where MuJoCo's renderer draws.
class OffScreenContext {
 public:
  virtual ~OffScreenContext() = default;
  /// For what is drawn next. Errors: RunError.
  virtual void MakeCurrent() = 0;
  virtual void ReadColours(int width_px, int height_px, std::uint32_t* pixels) const = 0;
  virtual void ReadDepths(int width_px, int height_px, float* depths) const = 0;
};

}  // namespace gauntlet::sim
