#include "sim/hand/camera_view.h"

#include <algorithm>

namespace gauntlet::sim {
namespace {

constexpr const char* kHandCamera = "hand";
constexpr const char* kFingersName = "fingers";
constexpr const char* kCloseUp = "close_up";

}  // namespace

CameraView CameraViewOf(const std::string& name) {
  if (name == kFingersName) return {.camera = kHandCamera, .framed = Framed::kFingers};
  if (name == kCloseUp) return {.camera = kHandCamera, .framed = Framed::kFinger};
  return {.camera = name};
}

std::vector<std::string> CameraViewNames(std::vector<std::string> cameras) {
  if (std::ranges::find(cameras, kHandCamera) != cameras.end()) {
    cameras.insert(cameras.end(), {kFingersName, kCloseUp});
  }
  return cameras;
}

}  // namespace gauntlet::sim
