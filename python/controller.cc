#include "controller/controller.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/same_connections.h"
#include "controller/step_recorder.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "sim/base/error.h"
#include "sim/settings/robot_file.h"
#include "sim/settings/steps_csv.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

using Counts = py::array_t<std::int32_t, py::array::c_style>;

constexpr const char* kControllerPlace = "controller";

template <class Value>
using ValuesOfController = std::span<const Value> (controller::Controller::*)() const noexcept;

/// A controller and what it is connected to. One thread at a time may use it: another gets an
/// error.
class BoundController {
 public:
  explicit BoundController(const controller::RobotConfig& robot)
      : robot_(robot), controller_(robot) {}

  Counts Step(const py::object& sample, const std::optional<std::int64_t>& number,
              const std::optional<double>& elapsed_ms) {
    const auto lock = Lock();
    if (elapsed_ms) controller_.TakeElapsedTime(*elapsed_ms);
    if (sample.is_none()) return Told(controller_.Step(), nullptr);
    const Rows counts = RowsOf(sample, kControllerPlace);
    CheckChannels(counts.ndim() == 1 ? static_cast<std::size_t>(counts.shape(0)) : 0);
    const controller::GloveSample given{.counts = ValuesOf(counts), .number = number};
    return Told(controller_.Step(given), &given);
  }

  /// A controller with the settings of `robot`, which has the same glove, hand and timing.
  std::unique_ptr<BoundController> Prepare(const controller::RobotConfig& robot) const {
    if (!controller::SameConnections(robot, robot_)) {
      throw sim::UserError(
          {.place = kControllerPlace,
           .problem = "has another glove, hand, joint_map or timing than the controller"});
    }
    return std::unique_ptr<BoundController>(
        new BoundController(robot, controller_.Prepare(robot.controller)));
  }
  void Swap(BoundController& next) {
    const auto lock = Lock();
    if (&next == this || !controller_.Swap(next.controller_)) {
      throw sim::UserError({.place = kControllerPlace,
                            .problem = "must be one that prepare() of this controller made"});
    }
    std::swap(robot_.controller, next.robot_.controller);
  }

  /// Keeps the last steps from now on; 0: none.
  void Record(int steps) {
    const auto lock = Lock();
    recorder_.reset();
    if (steps > 0) recorder_ = std::make_unique<controller::StepRecorder>(robot_, steps);
  }
  std::vector<std::string> recorded_columns() {
    const auto lock = Lock();
    return recorder_ ? recorder_->column_names() : std::vector<std::string>();
  }
  /// Kept steps x columns.
  py::array_t<double> RecordedSteps() {
    const auto lock = Lock();
    const std::size_t columns = recorder_ ? recorder_->column_names().size() : 0;
    const std::size_t rows = recorder_ ? recorder_->size() : 0;
    py::array_t<double> steps({rows, columns});
    if (rows > 0) recorder_->CopyTo({steps.mutable_data(), rows * columns});
    return steps;
  }
  std::string RecordedCsv() {
    const py::array_t<double> steps = RecordedSteps();
    return sim::StepsToCsv(recorded_columns(),
                           {steps.data(), static_cast<std::size_t>(steps.size())});
  }

  /// A tick with each sample, and the ticks without one up to the next: a row of counts per tick.
  Counts StepRows(const py::object& samples) {
    const auto lock = Lock();
    const Rows rows = RowsOf(samples, kControllerPlace);
    const auto [count, width] = ShapeOf(rows);
    CheckChannels(rows.ndim() == 2 ? width : 0);
    const auto ticks = static_cast<std::size_t>(robot_.timing.ticks_per_sample);
    const auto motors = static_cast<std::size_t>(controller_.motor_count());
    Counts commands({count * ticks, motors});
    const std::span<const double> from = ValuesOf(rows);
    const std::span<std::int32_t> to(commands.mutable_data(), count * ticks * motors);
    constexpr std::size_t kRows = 20'000;  // between two looks for signals
    for (std::size_t row = 0; row < count;) {
      {
        const py::gil_scoped_release unlocked;
        for (const std::size_t end = std::min(row + kRows, count); row < end; ++row) {
          const controller::GloveSample sample{.counts = from.subspan(row * width, width)};
          controller::Command command = controller_.Step(sample);
          Keep(&sample, command);
          for (std::size_t tick = row * ticks;; ++tick) {
            std::ranges::copy(command.motor_counts, to.subspan(tick * motors, motors).begin());
            if (tick + 1 == (row + 1) * ticks) break;
            command = controller_.Step();
            Keep(nullptr, command);
          }
          last_ = command;
        }
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
    return commands;
  }

  void TakeJointAngles(const py::object& measured_rad) {
    const auto lock = Lock();
    const Rows angles = RowsOf(measured_rad, kControllerPlace);
    CheckCount(angles, controller_.joint_count(), "joints");
    controller_.TakeJointAngles(ValuesOf(angles));
  }

  void Reset(const py::object& motor_counts) {
    const auto lock = Lock();
    last_ = {};
    if (motor_counts.is_none()) return controller_.Reset();
    const Rows counts = RowsOf(motor_counts, kControllerPlace);
    CheckCount(counts, controller_.motor_count(), "motors");
    std::vector<std::int32_t> whole;
    for (const double value : ValuesOf(counts)) {
      if (!(value == std::clamp(std::nearbyint(value), -2147483648.0, 2147483647.0))) {
        throw sim::UserError({.place = kControllerPlace,
                              .key = "motor_counts",
                              .problem = fmt::format("is {}, must be a whole number", value)});
      }
      whole.push_back(static_cast<std::int32_t>(value));
    }
    controller_.Reset(whole);
  }

  void SetChannelActive(const std::string& channel, bool active) {
    const auto lock = Lock();
    controller_.SetChannelActive(ChannelOf(channel), active);
  }
  double SampleAgeMs(const std::string& channel) {
    const auto lock = Lock();
    return controller_.sample_age_ms(ChannelOf(channel));
  }

  template <class Value>
  py::array_t<Value> CopyOf(ValuesOfController<Value> values) {
    const auto lock = Lock();
    const std::span<const Value> all = (controller_.*values)();
    return py::array_t<Value>(static_cast<py::ssize_t>(all.size()), all.data());
  }

  bool event() const { return last_.event; }
  std::string status() const { return std::string(sim::NameOf(last_.glove)); }
  std::string loop_status() const { return std::string(sim::NameOf(last_.loop)); }
  std::int64_t overruns() const { return controller_.overruns(); }
  double measured_tick_rate_hz() const { return controller_.measured_tick_rate_hz(); }
  const controller::RobotConfig& robot() const { return robot_; }

 private:
  std::unique_lock<std::mutex> Lock() {
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) {
      throw sim::RunError("controller: another thread is using it; give each thread its own");
    }
    return lock;
  }

  BoundController(const controller::RobotConfig& robot, controller::Controller prepared)
      : robot_(robot), controller_(std::move(prepared)) {}

  /// For the recorder, if there is one; `sample` may be null.
  void Keep(const controller::GloveSample* sample, const controller::Command& command) noexcept {
    if (!recorder_) return;
    if (sample != nullptr) {
      recorder_->Add(*sample, controller_, command);
    } else {
      recorder_->Add(controller_, command);
    }
  }

  Counts Told(const controller::Command& command, const controller::GloveSample* sample) {
    Keep(sample, command);
    last_ = command;
    return Counts(static_cast<py::ssize_t>(command.motor_counts.size()),
                  command.motor_counts.data());
  }

  /// `width`: 0 for another number of dimensions.
  void CheckChannels(std::size_t width) const {
    if (width == static_cast<std::size_t>(controller_.channel_count())) return;
    throw sim::UserError(
        {.place = kControllerPlace,
         .key = "sample",
         .problem = fmt::format("must have {} channels: one value for each in step(), a row for "
                                "each sample in steps()",
                                controller_.channel_count())});
  }

  static void CheckCount(const Rows& values, int count, const char* noun) {
    if (values.ndim() == 1 && values.size() == count) return;
    throw sim::UserError(
        {.place = kControllerPlace,
         .problem = fmt::format("must be {} values, one for each of the {}", count, noun)});
  }

  int ChannelOf(const std::string& name) const {
    const auto& names = robot_.glove.channel_names;
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    throw sim::UserError(
        {.place = kControllerPlace, .key = name, .problem = "is not a channel of this controller"});
  }

  controller::RobotConfig robot_;
  controller::Controller controller_;
  controller::Command last_;
  std::unique_ptr<controller::StepRecorder> recorder_;
  std::mutex mutex_;
};

}  // namespace

void BindController(py::module_& module) {
  module.def(
      "problems_of_robot",
      [](const std::string& file, const std::optional<std::string>& text) {
        return sim::ProblemsOfRobot(file, text);
      },
      py::arg("file"), py::arg("text"));
  using Controller = controller::Controller;
  py::class_<BoundController> bound(module, "Controller");
  bound
      .def(py::init([](const std::string& file, const std::optional<std::string>& text) {
             return std::make_unique<BoundController>(text ? sim::ParseRobot(file, *text)
                                                           : sim::LoadRobot(file));
           }),
           py::arg("file"), py::arg("text"))
      .def("step", &BoundController::Step, py::arg("sample"), py::arg("number"),
           py::arg("elapsed_ms"))
      .def(
          "prepare",
          [](const BoundController& self, const std::string& file,
             const std::optional<std::string>& text) {
            return self.Prepare(text ? sim::ParseRobot(file, *text) : sim::LoadRobot(file));
          },
          py::arg("file"), py::arg("text"))
      .def("swap", &BoundController::Swap, py::arg("prepared"))
      .def("record", &BoundController::Record, py::arg("steps"))
      .def_property_readonly("recorded_columns", &BoundController::recorded_columns)
      .def("recorded_steps", &BoundController::RecordedSteps)
      .def("recorded_csv", &BoundController::RecordedCsv)
      .def("steps", &BoundController::StepRows, py::arg("samples"))
      .def("take_joint_angles", &BoundController::TakeJointAngles, py::arg("measured_rad"))
      .def("reset", &BoundController::Reset, py::arg("motor_counts"))
      .def("set_channel_active", &BoundController::SetChannelActive, py::arg("channel"),
           py::arg("active"))
      .def("sample_age_ms", &BoundController::SampleAgeMs, py::arg("channel"))
      .def_property_readonly("event", &BoundController::event)
      .def_property_readonly("status", &BoundController::status)
      .def_property_readonly("loop_status", &BoundController::loop_status)
      .def_property_readonly("overruns", &BoundController::overruns)
      .def_property_readonly("measured_tick_rate_hz", &BoundController::measured_tick_rate_hz);
  const auto add = [&bound](const char* name, auto value_of) {
    bound.def_property_readonly(
        name, [value_of](const BoundController& self) { return value_of(self.robot()); });
  };
  add("channel_names", [](const auto& robot) { return robot.glove.channel_names; });
  add("joint_names", [](const auto& robot) { return robot.hand.joint_names; });
  add("motor_names", [](const auto& robot) { return robot.hand.motor_names; });
  add("tick_rate_hz", [](const auto& robot) { return robot.timing.tick_rate_hz; });
  add("ticks_per_sample", [](const auto& robot) { return robot.timing.ticks_per_sample; });
  add("event_period_ms", [](const auto& robot) { return robot.timing.event_period_ms; });
  const auto add_values = [&bound]<class Value>(const char* name,
                                                ValuesOfController<Value> values) {
    bound.def_property_readonly(name,
                                [values](BoundController& self) { return self.CopyOf(values); });
  };
  add_values("linearised_angle_rad", &Controller::linearised_angle_rad);
  add_values("filtered_angle_rad", &Controller::filtered_angle_rad);
  add_values("predicted_angle_rad", &Controller::predicted_angle_rad);
  add_values("target_angle_rad", &Controller::target_angle_rad);
  add_values("untrusted_samples", &Controller::untrusted_samples);
}

}  // namespace gauntlet::python
