#include "sim/hand/mujoco_messages.h"

#include <mujoco/mujoco.h>

#include <utility>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

thread_local std::string last_warning;

// The engine calls exit() when an error handler returns, so it must not return.
void ThrowError(const char* message) { throw RunError(std::string("physics engine: ") + message); }

void KeepWarning(const char* message) { last_warning = message; }

}  // namespace

std::string TakeMujocoWarning() { return std::exchange(last_warning, {}); }

void RedirectMujocoMessages() {
  mju_user_error = &ThrowError;
  mju_user_warning = &KeepWarning;
}

}  // namespace gauntlet::sim
