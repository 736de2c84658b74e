#pragma once

#include <string>
#include <vector>

namespace gauntlet::sim {

/// Part of a hand in motion that fills the picture.
enum class Framed {
  kWhatMoves,
  kFingers,  // what hangs on the palm
  kFinger,   // that of the joint whose curves are drawn
};

/// From which camera of the model a hand is shown, and what of it.
struct CameraView {
  std::string camera;  // empty: a view of the whole model
  Framed framed = Framed::kWhatMoves;
};

/// A view by its name: `fingers` and `close_up` are seen by the camera `hand`, all others by the
/// camera of that name.
CameraView CameraViewOf(const std::string& name);

/// The views that a hand with these cameras has.
std::vector<std::string> CameraViewNames(std::vector<std::string> cameras);

}  // namespace gauntlet::sim
