#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/filters/filter_config.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "sim/base/error.h"
#include "sim/settings/libraries/like_filter.h"
#include "sim/settings/yaml_reader.h"
#include "sim/trial/held_filter.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

constexpr const char* kFilterPlace = "filter";

/// The array for the output: the caller's, or a new one of the shape of `input`.
/// Errors: UserError for one that cannot take the result as it is.
py::array_t<double> OutputOf(const Rows& input, const py::object& out) {
  if (out.is_none()) {
    return py::array_t<double>(
        std::vector<py::ssize_t>(input.shape(), input.shape() + input.ndim()));
  }
  const auto fail = [](const std::string& problem) {
    throw sim::UserError({.place = kFilterPlace, .key = "out", .problem = problem});
  };
  if (!py::isinstance<py::array>(out)) fail("is no array");
  const auto array = py::reinterpret_borrow<py::array>(out);
  if (!py::isinstance<py::array_t<double, py::array::c_style>>(out)) {
    fail("must be an array of float64 whose rows are contiguous");
  }
  if (!array.writeable()) fail("is read-only");
  if (!std::equal(array.shape(), array.shape() + array.ndim(), input.shape(),
                  input.shape() + input.ndim())) {
    fail(fmt::format("has the shape {}, must have that of the input, {}",
                     std::string(py::str(out.attr("shape"))),
                     std::string(py::str(input.attr("shape")))));
  }
  return py::reinterpret_borrow<py::array_t<double>>(out);
}

/// Input and output are the same memory, or do not overlap.
Rows WithoutOverlap(const Rows& input, const py::array_t<double>& output) {
  const double* begin = output.data();
  const bool is_same = input.data() == begin;
  const bool is_apart =
      input.data() + input.size() <= begin || begin + output.size() <= input.data();
  return is_same || is_apart ? input : Rows(input.attr("copy")());
}

constexpr double kAnyRateHz = 1000.0;

/// Errors: UserError for settings that there are not, or of another library that need a rate.
controller::FilterConfig ReadFilter(const std::string& text, const std::optional<double>& rate_hz) {
  const sim::YamlSource source{.file = kFilterPlace};
  sim::YamlNode root = sim::ParseYaml(kFilterPlace, text);
  const auto like = sim::ExtractLikeFilter(root, "", source);
  controller::FilterConfig config;
  sim::ReadAll(root, source, config);
  if (!like) return config;
  if (!rate_hz && like->settings->DependsOnRate()) {
    throw sim::UserError({.place = kFilterPlace,
                          .key = "rate_hz",
                          .problem = "is needed: the settings are for a loop of another rate"});
  }
  config.settings = like->At(rate_hz.value_or(kAnyRateHz), "", source);
  return config;
}

/// Errors: UserError for settings that do not fit the channels or the rate.
sim::HeldFilter MakeHeldFilter(const controller::FilterConfig& config, int channels,
                               double rate_hz) {
  try {
    return {config, channels, rate_hz};
  } catch (const controller::SettingError& error) {
    throw sim::AtPlace(kFilterPlace, error);
  }
}

/// Errors: UserError for a rate that is no rate, or lacking where the filter needs one.
void CheckRate(const controller::FilterConfig& config, int channels,
               const std::optional<double>& rate_hz) {
  if (!rate_hz && sim::DependsOnRate(config, channels)) {
    throw sim::UserError(
        {.place = kFilterPlace,
         .key = "rate_hz",
         .problem = fmt::format("is needed: {} depends on the sampling rate", config.kind())});
  }
  if (rate_hz && !(*rate_hz > 0.0 && std::isfinite(*rate_hz))) {
    throw sim::UserError({.place = kFilterPlace,
                          .key = "rate_hz",
                          .problem = fmt::format("is {}, must be a number above 0", *rate_hz)});
  }
}

/// Returns the output and the number of values that were held.
std::pair<py::array, std::size_t> Filter(const py::object& array, const std::string& settings,
                                         const std::optional<double>& rate_hz,
                                         const py::object& out) {
  const controller::FilterConfig config = ReadFilter(settings, rate_hz);
  const Rows given = RowsOf(array, kFilterPlace);
  py::array_t<double> output = OutputOf(given, out);
  const Rows input = WithoutOverlap(given, output);
  const std::size_t width = ShapeOf(input).second;
  const auto channels = static_cast<int>(width);
  CheckRate(config, channels, rate_hz);
  sim::HeldFilter filter = MakeHeldFilter(config, channels, rate_hz.value_or(kAnyRateHz));
  const std::span<const double> from = ValuesOf(input);
  const std::span<double> to(output.mutable_data(), from.size());
  constexpr std::size_t kValues = std::size_t{1} << 20;  // between two looks for signals
  const std::size_t step = std::max(kValues / width, std::size_t{1}) * width;
  for (std::size_t at = 0; at < from.size(); at += step) {
    const std::size_t count = std::min(step, from.size() - at);
    {
      const py::gil_scoped_release unlocked;
      filter.StepRows(from.subspan(at, count), to.subspan(at, count));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return {std::move(output), filter.held()};
}

/// The times of samples beside those that a filter assumes: one each 1 / rate.
class SampleClock {
 public:
  explicit SampleClock(double rate_hz) : rate_hz_(rate_hz) {}

  /// Errors: UserError for a sample at another time.
  void Accept(double time_s) {
    if (!std::isfinite(time_s)) Fail(fmt::format("is {}, must be a time in seconds", time_s));
    if (count_ == 0) first_s_ = time_s;
    const double interval = (time_s - last_s_) * rate_hz_;
    if (count_ > 0 && !(interval > kShortest && interval < kLongest)) {
      Fail(
          fmt::format("is {:.6g} s after the last sample, must be {:.6g} s (rate_hz is {:g}): the "
                      "filter takes samples at equal times; resample, or reset() after a gap",
                      time_s - last_s_, 1.0 / rate_hz_, rate_hz_));
    }
    const double mean = (time_s - first_s_) * rate_hz_ / static_cast<double>(count_);
    if (count_ >= kEnough && !(std::abs(mean - 1.0) < kMostDrift)) {
      Fail(fmt::format("comes at {:.4g} Hz in the mean, rate_hz is {:g}", rate_hz_ / mean,
                       rate_hz_));
    }
    last_s_ = time_s;
    ++count_;
  }

 private:
  // A sample that is late by half an interval or more is another one.
  static constexpr double kShortest = 0.5;
  static constexpr double kLongest = 1.5;
  static constexpr std::int64_t kEnough = 50;  // samples for a mean
  static constexpr double kMostDrift = 0.05;

  [[noreturn]] static void Fail(const std::string& problem) {
    throw sim::UserError({.place = kFilterPlace, .key = "t", .problem = problem});
  }

  double rate_hz_;
  double first_s_ = 0.0;
  double last_s_ = 0.0;
  std::int64_t count_ = 0;
};

/// A filter that takes sample by sample. It begins with the first sample, which tells the number of
/// channels. Guarded by the GIL.
class StepFilter {
 public:
  StepFilter(const std::string& settings, const std::optional<double>& rate_hz)
      : config_(ReadFilter(settings, rate_hz)), rate_hz_(rate_hz) {
    CheckRate(config_, 1, rate_hz_);
  }

  void Reset() {
    filter_.reset();
    clock_.reset();
  }
  std::size_t held() const { return filter_ ? filter_->held() : 0; }

  /// `sample`: a number, or numbers in one dimension. Returns the same kind.
  py::object Step(PyObject* sample, PyObject* time, PyObject* out) {
    const py::detail::npy_api& numpy = py::detail::npy_api::get();
    if (!numpy.PyArray_Check_(sample) && !PySequence_Check(sample)) {
      if (out != nullptr) Fail("out", "is for an array, not for a single number");
      const double value = PyFloat_AsDouble(sample);
      if (value == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
      Begin(1, true);
      CheckTime(time);
      double filtered = 0.0;
      filter_->Step({&value, 1}, {&filtered, 1});
      return py::float_(filtered);
    }
    py::object held;  // a copy in doubles, if the sample is anything else
    const double* from = DoublesOf(sample);
    if (from == nullptr) {
      held = RowsOf(py::reinterpret_borrow<py::object>(sample), kFilterPlace);
      sample = held.ptr();
      from = DoublesOf(sample);
      if (from == nullptr) Fail("", "has 2 dimensions, must be a sample: a number or 1 dimension");
    }
    const auto width = static_cast<std::size_t>(SizeOf(sample));
    Begin(width, false);
    py::object result;
    if (out == nullptr) {
      Py_ssize_t shape = SizeOf(sample);
      result = py::reinterpret_steal<py::object>(numpy.PyArray_NewFromDescr_(
          numpy.PyArray_Type_, double_.inc_ref().ptr(), 1, &shape, nullptr, nullptr, 0, nullptr));
      if (!result) throw py::error_already_set();
      out = result.ptr();
    } else {
      result = py::reinterpret_borrow<py::object>(out);
      if (DoublesOf(out) == nullptr || SizeOf(out) != SizeOf(sample) ||
          !py::reinterpret_borrow<py::array>(out).writeable()) {
        Fail("out", fmt::format("must be a writeable array of {} float64", width));
      }
    }
    auto* const to = static_cast<double*>(static_cast<void*>(Proxy(out)->data));
    if (to != from && to < from + width && from < to + width) Fail("out", "overlaps the sample");
    CheckTime(time);
    filter_->Step({from, width}, {to, width});
    return result;
  }

 private:
  [[noreturn]] static void Fail(const std::string& key, const std::string& problem) {
    throw sim::UserError({.place = kFilterPlace, .key = key, .problem = problem});
  }
  static const py::detail::PyArray_Proxy* Proxy(PyObject* array) {
    return py::detail::array_proxy(array);
  }
  static Py_ssize_t SizeOf(PyObject* array) { return Proxy(array)->dimensions[0]; }
  /// Null if it is not an array of doubles in one dimension without gaps, or of a class made of
  /// arrays, as masked ones.
  static const double* DoublesOf(PyObject* object) {
    const py::detail::npy_api& numpy = py::detail::npy_api::get();
    if (Py_TYPE(object) != numpy.PyArray_Type_) return nullptr;
    const py::detail::PyArray_Proxy* array = Proxy(object);
    constexpr int kPlain =
        py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
    const py::detail::PyArrayDescr_Proxy* type = py::detail::array_descriptor_proxy(array->descr);
    const bool is_native = type->byteorder == '=' || type->byteorder == '|';
    if (array->nd != 1 || (array->flags & kPlain) != kPlain || !is_native ||
        type->type_num != py::detail::npy_api::NPY_DOUBLE_) {
      return nullptr;
    }
    return static_cast<const double*>(static_cast<const void*>(array->data));
  }

  void Begin(std::size_t channels, bool is_number) {
    if (filter_) {
      if (channels == channels_ && is_number == is_number_) return;
      const auto words = [](std::size_t count, bool number) {
        return number ? std::string("a number") : fmt::format("an array of {}", count);
      };
      Fail("", fmt::format("the sample is {}, must be {} as the first one; or reset()",
                           words(channels, is_number), words(channels_, is_number_)));
    }
    if (channels == 0) Fail("", "has no channels");
    CheckRate(config_, static_cast<int>(channels), rate_hz_);
    filter_.emplace(
        MakeHeldFilter(config_, static_cast<int>(channels), rate_hz_.value_or(kAnyRateHz)));
    channels_ = channels;
    is_number_ = is_number;
  }

  void CheckTime(PyObject* time) {
    if (time == nullptr) return;
    const double time_s = PyFloat_AsDouble(time);
    if (time_s == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (!rate_hz_) Fail("rate_hz", "is needed to check t");
    if (!clock_) clock_.emplace(*rate_hz_);
    clock_->Accept(time_s);
  }

  const controller::FilterConfig config_;
  const std::optional<double> rate_hz_;
  const py::dtype double_ = py::dtype::of<double>();
  std::optional<sim::HeldFilter> filter_;
  std::size_t channels_ = 0;
  bool is_number_ = false;
  std::optional<SampleClock> clock_;
};

using SharedStepFilter = std::shared_ptr<StepFilter>;

/// step(x, t=None, out=None) without what pybind11 does at each call, which takes longer than a
/// filter does.
PyObject* StepOf(PyObject* self, PyObject* const* arguments, Py_ssize_t count, PyObject* names) {
  constexpr std::array<const char*, 3> kNames = {"x", "t", "out"};
  std::array<PyObject*, 3> given = {};
  const Py_ssize_t named = names == nullptr ? 0 : PyTuple_GET_SIZE(names);
  if (count > std::ssize(given)) {
    PyErr_SetString(PyExc_TypeError, "step() takes x, t and out");
    return nullptr;
  }
  std::copy_n(arguments, count, given.begin());
  for (Py_ssize_t i = 0; i < named; ++i) {
    PyObject* const name = PyTuple_GET_ITEM(names, i);
    const auto known = std::ranges::find_if(kNames, [name](const char* each) {
      return PyUnicode_CompareWithASCIIString(name, each) == 0;
    });
    if (known == kNames.end() || given[static_cast<std::size_t>(known - kNames.begin())]) {
      PyErr_Format(PyExc_TypeError, "step() got an unexpected or repeated argument '%U'", name);
      return nullptr;
    }
    given[static_cast<std::size_t>(known - kNames.begin())] = arguments[count + i];
  }
  if (given[0] == nullptr) {
    PyErr_SetString(PyExc_TypeError, "step() needs a sample");
    return nullptr;
  }
  for (const std::size_t i : {1U, 2U}) {
    if (given[i] == Py_None) given[i] = nullptr;
  }
  try {
    auto* const filter = static_cast<SharedStepFilter*>(PyCapsule_GetPointer(self, nullptr));
    return (*filter)->Step(given[0], given[1], given[2]).release().ptr();
  } catch (py::error_already_set& raised) {
    raised.restore();
  } catch (...) {
    SetPythonError(std::current_exception());
  }
  return nullptr;
}

py::object BoundStep(const SharedStepFilter& filter) {
  static PyMethodDef definition = {
      "step",
      // Python's type for functions with any kind of arguments.
      reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&StepOf)),  // NOLINT
      METH_FASTCALL | METH_KEYWORDS, nullptr};
  const py::capsule self(new SharedStepFilter(filter),
                         [](void* held) { delete static_cast<SharedStepFilter*>(held); });
  PyObject* const function = PyCFunction_New(&definition, self.ptr());
  if (function == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(function);
}

}  // namespace

void BindFilter(py::module_& module) {
  py::class_<StepFilter, SharedStepFilter>(module, "Filter")
      .def(py::init<const std::string&, const std::optional<double>&>(), py::arg("settings"),
           py::arg("rate_hz"))
      .def("bound_step", &BoundStep)
      .def("reset", &StepFilter::Reset)
      .def_property_readonly("held", &StepFilter::held);
  module.def("filter", &Filter, py::arg("array"), py::arg("settings"), py::arg("rate_hz"),
             py::arg("out"));
  module.def("filter_kinds", [] {
    std::vector<std::string> names;
    for (const auto& kind : controller::FilterKinds()) names.emplace_back(kind.name);
    return names;
  });
}

}  // namespace gauntlet::python
