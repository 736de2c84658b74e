#include "controller/c_api/gauntlet_controller.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/controller.h"
#include "controller/number.h"
#include "controller/robot_text.h"
#include "controller/same_connections.h"

namespace gc = gauntlet::controller;

struct gauntlet_controller {
  gc::RobotConfig robot;  // its names and clocks; a swap does not change these
  gc::Controller controller;
  gauntlet_glove_status glove_status = GAUNTLET_GLOVE_GOOD;
  gauntlet_loop_status loop_status = GAUNTLET_LOOP_IN_TIME;
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
  self->glove_status = static_cast<gauntlet_glove_status>(command.glove);
  self->loop_status = static_cast<gauntlet_loop_status>(command.loop);
  return command.event ? GAUNTLET_EVENT : GAUNTLET_OK;
}

static_assert(static_cast<int>(gc::GloveStatus::kGood) == GAUNTLET_GLOVE_GOOD &&
              static_cast<int>(gc::GloveStatus::kHeld) == GAUNTLET_GLOVE_HELD &&
              static_cast<int>(gc::GloveStatus::kTooOften) == GAUNTLET_GLOVE_TOO_OFTEN &&
              static_cast<int>(gc::GloveStatus::kLost) == GAUNTLET_GLOVE_LOST);
static_assert(static_cast<int>(gc::LoopStatus::kInTime) == GAUNTLET_LOOP_IN_TIME &&
              static_cast<int>(gc::LoopStatus::kOverrun) == GAUNTLET_LOOP_OVERRUN &&
              static_cast<int>(gc::LoopStatus::kWrongRate) == GAUNTLET_LOOP_WRONG_RATE);
static_assert(static_cast<int>(gc::Untrusted::kMissing) == GAUNTLET_UNTRUSTED_MISSING &&
              static_cast<int>(gc::Untrusted::kStale) == GAUNTLET_UNTRUSTED_STALE &&
              gc::kUntrustedKinds == GAUNTLET_UNTRUSTED_STALE + 1);

/// Controller that `make` builds from the settings; null, with the error in one line, if it throws.
template <class Make>
gauntlet_controller* Made(const char* settings, std::size_t settings_length, char* error,
                          std::size_t error_size, const Make& make) {
  Write("", error, error_size);
  if (settings == nullptr) {
    Write("settings: are missing", error, error_size);
    return nullptr;
  }
  try {
    return make(gc::RobotFromText({settings, settings_length}));
  } catch (const std::bad_alloc&) {
    Write("settings: need more memory than there is", error, error_size);
  } catch (const std::exception& problem) {
    Write(problem.what(), error, error_size);
  }
  return nullptr;
}

const char* NameOf(const std::vector<std::string>& names, std::size_t index) {
  return index < names.size() ? names[index].c_str() : nullptr;
}

/// Copies what is known of each channel or joint.
template <class Value>
gauntlet_result Copy(std::span<const Value> values, Value* to, std::size_t count) {
  if (to == nullptr) return GAUNTLET_NULL_POINTER;
  if (count != values.size()) return GAUNTLET_WRONG_LENGTH;
  std::ranges::copy(values, to);
  return GAUNTLET_OK;
}

}  // namespace

const char* gauntlet_controller_version() { return GAUNTLET_CONTROLLER_VERSION; }

gauntlet_controller* gauntlet_controller_create(const char* settings, size_t settings_length,
                                                char* error, size_t error_size) {
  return Made(settings, settings_length, error, error_size, [](const gc::RobotConfig& robot) {
    return new gauntlet_controller{.robot = robot, .controller = gc::Controller(robot)};
  });
}

size_t gauntlet_controller_validate(const char* settings, size_t settings_length, char* problems,
                                    size_t problems_size) {
  std::vector<std::string> lines;
  try {
    lines =
        gc::ProblemsOfText(settings == nullptr ? "" : std::string_view(settings, settings_length));
  } catch (const std::exception& problem) {
    lines = {problem.what()};
  }
  std::size_t written = 0;
  const auto has_room = [&](std::size_t length) {
    return problems != nullptr && written + length < problems_size;
  };
  for (const std::string& line : lines) {
    if (!has_room(line.size() + 1)) break;
    Write(line, problems + written, line.size() + 1);
    written += line.size();
    problems[written++] = '\n';
  }
  if (has_room(0)) problems[written] = '\0';
  return lines.size();
}

gauntlet_controller* gauntlet_controller_prepare(const gauntlet_controller* controller,
                                                 const char* settings, size_t settings_length,
                                                 char* error, size_t error_size) {
  return Made(settings, settings_length, error, error_size, [&](const gc::RobotConfig& robot) {
    if (controller == nullptr) throw gc::SettingError("controller", "is missing");
    if (!gc::SameConnections(robot, controller->robot)) {
      throw gc::SettingError("settings",
                             "have another glove, hand, joint_map or timing than the controller");
    }
    return new gauntlet_controller{.robot = robot,
                                   .controller = controller->controller.Prepare(robot.controller)};
  });
}

gauntlet_result gauntlet_controller_swap(gauntlet_controller* controller,
                                         gauntlet_controller* prepared) {
  if (controller == nullptr || prepared == nullptr) return GAUNTLET_NULL_POINTER;
  if (!controller->controller.Swap(prepared->controller)) return GAUNTLET_NOT_PREPARED;
  return GAUNTLET_OK;
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
  return controller != nullptr ? controller->robot.timing.tick_rate_hz : 0.0;
}

int gauntlet_controller_ticks_per_sample(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->robot.timing.ticks_per_sample : 0;
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

double gauntlet_controller_event_period_ms(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->robot.timing.event_period_ms : 0.0;
}

const char* gauntlet_controller_channel_name(const gauntlet_controller* controller,
                                             size_t channel) {
  return controller != nullptr ? NameOf(controller->robot.glove.channel_names, channel) : nullptr;
}

const char* gauntlet_controller_joint_name(const gauntlet_controller* controller, size_t joint) {
  return controller != nullptr ? NameOf(controller->robot.hand.joint_names, joint) : nullptr;
}

const char* gauntlet_controller_motor_name(const gauntlet_controller* controller, size_t motor) {
  return controller != nullptr ? NameOf(controller->robot.hand.motor_names, motor) : nullptr;
}

gauntlet_glove_status gauntlet_controller_glove_status(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->glove_status : GAUNTLET_GLOVE_LOST;
}

gauntlet_result gauntlet_controller_untrusted_samples(const gauntlet_controller* controller,
                                                      gauntlet_untrusted reason,
                                                      int64_t* sample_counts,
                                                      size_t channel_count) {
  if (controller == nullptr) return GAUNTLET_NULL_POINTER;
  const int index = reason;
  if (index < GAUNTLET_UNTRUSTED_ALL || index >= gc::kUntrustedKinds) return GAUNTLET_OUT_OF_RANGE;
  const gc::Controller& from = controller->controller;
  return Copy(index == GAUNTLET_UNTRUSTED_ALL
                  ? from.untrusted_samples()
                  : from.untrusted_samples(static_cast<gc::Untrusted>(index)),
              sample_counts, channel_count);
}

gauntlet_result gauntlet_controller_sample_age_ms(const gauntlet_controller* controller,
                                                  double* age_ms, size_t channel_count) {
  if (controller == nullptr || age_ms == nullptr) return GAUNTLET_NULL_POINTER;
  if (channel_count != gauntlet_controller_channel_count(controller)) return GAUNTLET_WRONG_LENGTH;
  for (size_t i = 0; i < channel_count; ++i) {
    age_ms[i] = controller->controller.sample_age_ms(static_cast<int>(i));
  }
  return GAUNTLET_OK;
}

gauntlet_result gauntlet_controller_failed_plans(const gauntlet_controller* controller,
                                                 int64_t* frame_counts, size_t joint_count) {
  if (controller == nullptr || frame_counts == nullptr) return GAUNTLET_NULL_POINTER;
  if (joint_count != gauntlet_controller_joint_count(controller)) return GAUNTLET_WRONG_LENGTH;
  const std::span<const std::int64_t> failed = controller->controller.failed_plans();
  if (failed.empty()) {
    std::fill_n(frame_counts, joint_count, 0);
    return GAUNTLET_OK;
  }
  return Copy(failed, frame_counts, joint_count);
}

gauntlet_result gauntlet_controller_angles(const gauntlet_controller* controller,
                                           gauntlet_angle kind, double* angle_rad, size_t count) {
  if (controller == nullptr) return GAUNTLET_NULL_POINTER;
  const gc::Controller& from = controller->controller;
  switch (kind) {
    case GAUNTLET_ANGLE_LINEARISED:
      return Copy(from.linearised_angle_rad(), angle_rad, count);
    case GAUNTLET_ANGLE_FILTERED:
      return Copy(from.filtered_angle_rad(), angle_rad, count);
    case GAUNTLET_ANGLE_PREDICTED:
      return Copy(from.predicted_angle_rad(), angle_rad, count);
    case GAUNTLET_ANGLE_TARGET:
      return Copy(from.target_angle_rad(), angle_rad, count);
  }
  return GAUNTLET_OUT_OF_RANGE;
}

gauntlet_result gauntlet_controller_take_elapsed_ms(gauntlet_controller* controller,
                                                    double elapsed_ms) {
  if (controller == nullptr) return GAUNTLET_NULL_POINTER;
  controller->controller.TakeElapsedTime(elapsed_ms);
  return GAUNTLET_OK;
}

gauntlet_loop_status gauntlet_controller_loop_status(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->loop_status : GAUNTLET_LOOP_IN_TIME;
}

int64_t gauntlet_controller_overruns(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->controller.overruns() : 0;
}

double gauntlet_controller_measured_tick_rate_hz(const gauntlet_controller* controller) {
  return controller != nullptr ? controller->controller.measured_tick_rate_hz() : gc::kNaN;
}

gauntlet_result gauntlet_controller_set_channel_active(gauntlet_controller* controller,
                                                       size_t channel, int active) {
  if (controller == nullptr) return GAUNTLET_NULL_POINTER;
  if (channel >= gauntlet_controller_channel_count(controller)) return GAUNTLET_OUT_OF_RANGE;
  controller->controller.SetChannelActive(static_cast<int>(channel), active != 0);
  return GAUNTLET_OK;
}

int gauntlet_controller_channel_active(const gauntlet_controller* controller, size_t channel) {
  if (channel >= gauntlet_controller_channel_count(controller)) return 0;
  return controller->controller.channel_active(static_cast<int>(channel)) ? 1 : 0;
}
