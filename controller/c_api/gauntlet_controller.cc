#include "controller/c_api/gauntlet_controller.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string_view>

#include "controller/constant_settings.h"
#include "controller/controller.h"

namespace gc = gauntlet::controller;

struct gauntlet_controller {
  gc::Timing timing;
  gc::Controller controller;
};

namespace {

/// As much of it as there is room for, in one line.
void Write(std::string_view problem, char* error, std::size_t error_size) {
  if (error == nullptr || error_size == 0) return;
  const std::size_t length = std::min(problem.size(), error_size - 1);
  std::transform(problem.begin(), problem.begin() + static_cast<std::ptrdiff_t>(length), error,
                 [](char c) { return static_cast<unsigned char>(c) < ' ' ? ' ' : c; });
  error[length] = '\0';
}

gauntlet_result Step(gauntlet_controller* self, const double* counts, std::size_t channel_count,
                     std::optional<std::int64_t> frame_number, std::int32_t* motor_counts,
                     std::size_t motor_count) {
  const bool fresh = counts != nullptr;
  const bool missing = !fresh && channel_count > 0;
  if (self == nullptr || motor_counts == nullptr || missing) return GAUNTLET_NULL_POINTER;
  if (fresh && channel_count != gauntlet_controller_channel_count(self)) {
    return GAUNTLET_WRONG_LENGTH;
  }
  if (motor_count != gauntlet_controller_motor_count(self)) return GAUNTLET_WRONG_LENGTH;
  const gc::Command command =
      fresh ? self->controller.Step({.counts = {counts, channel_count}, .number = frame_number})
            : self->controller.Step();
  std::ranges::copy(command.motor_counts, motor_counts);
  return command.event ? GAUNTLET_EVENT : GAUNTLET_OK;
}

}  // namespace

gauntlet_controller* gauntlet_controller_create(const char* settings, size_t settings_length,
                                                char* error, size_t error_size) {
  Write("", error, error_size);
  if (settings == nullptr) {
    Write("settings: are missing", error, error_size);
    return nullptr;
  }
  try {
    const gc::RobotConfig robot = gc::RobotFromText({settings, settings_length});
    return new gauntlet_controller{.timing = robot.timing, .controller = gc::Controller(robot)};
  } catch (const std::bad_alloc&) {
    Write("settings: need more memory than there is", error, error_size);
  } catch (const std::exception& problem) {
    Write(problem.what(), error, error_size);
  }
  return nullptr;
}

void gauntlet_controller_destroy(gauntlet_controller* controller) { delete controller; }

size_t gauntlet_controller_channel_count(const gauntlet_controller* controller) {
  return controller != nullptr ? static_cast<size_t>(controller->controller.channel_count()) : 0;
}

size_t gauntlet_controller_motor_count(const gauntlet_controller* controller) {
  return controller != nullptr ? static_cast<size_t>(controller->controller.motor_count()) : 0;
}

size_t gauntlet_controller_joint_count(const gauntlet_controller* controller) {
  return controller != nullptr ? static_cast<size_t>(controller->controller.joint_count()) : 0;
}

double gauntlet_controller_tick_rate_hz(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->timing.tick_rate_hz : 0.0;
}

int gauntlet_controller_ticks_per_sample(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->timing.ticks_per_sample : 0;
}

gauntlet_result gauntlet_controller_step(gauntlet_controller* controller, const double* counts,
                                         size_t channel_count, int32_t* motor_counts,
                                         size_t motor_count) {
  return Step(controller, counts, channel_count, std::nullopt, motor_counts, motor_count);
}

gauntlet_result gauntlet_controller_step_frame(gauntlet_controller* controller,
                                               int64_t frame_number, const double* counts,
                                               size_t channel_count, int32_t* motor_counts,
                                               size_t motor_count) {
  return Step(controller, counts, channel_count, frame_number, motor_counts, motor_count);
}

gauntlet_result gauntlet_controller_take_joint_angles(gauntlet_controller* controller,
                                                      const double* angle_rad, size_t joint_count) {
  if (controller == nullptr || angle_rad == nullptr) return GAUNTLET_NULL_POINTER;
  if (joint_count != gauntlet_controller_joint_count(controller)) return GAUNTLET_WRONG_LENGTH;
  controller->controller.TakeJointAngles(std::span(angle_rad, joint_count));
  return GAUNTLET_OK;
}

gauntlet_result gauntlet_controller_reset(gauntlet_controller* controller,
                                          const int32_t* motor_counts, size_t motor_count) {
  if (controller == nullptr) return GAUNTLET_NULL_POINTER;
  if (motor_counts == nullptr) {
    if (motor_count > 0) return GAUNTLET_NULL_POINTER;
    controller->controller.Reset();
    return GAUNTLET_OK;
  }
  if (motor_count != gauntlet_controller_motor_count(controller)) return GAUNTLET_WRONG_LENGTH;
  controller->controller.Reset(std::span(motor_counts, motor_count));
  return GAUNTLET_OK;
}
