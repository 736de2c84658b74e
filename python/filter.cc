#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/filters/filter_config.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "sim/base/error.h"
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

controller::FilterConfig ReadFilter(const std::string& text) {
  controller::FilterConfig config;
  sim::ReadAll(sim::ParseYaml(kFilterPlace, text), {.file = kFilterPlace}, config);
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

/// Returns the output and the number of values that were held.
std::pair<py::array, std::size_t> Filter(const py::object& array, const std::string& settings,
                                         const std::optional<double>& rate_hz,
                                         const py::object& out) {
  const controller::FilterConfig config = ReadFilter(settings);
  const Rows given = RowsOf(array, kFilterPlace);
  py::array_t<double> output = OutputOf(given, out);
  const Rows input = WithoutOverlap(given, output);
  const std::size_t width = ShapeOf(input).second;
  const auto channels = static_cast<int>(width);
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
  constexpr double kAnyRateHz = 1000.0;
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

}  // namespace

void BindFilter(py::module_& module) {
  module.def("filter", &Filter, py::arg("array"), py::arg("settings"), py::arg("rate_hz"),
             py::arg("out"));
  module.def("filter_kinds", [] {
    std::vector<std::string> names;
    for (const auto& kind : controller::FilterKinds()) names.emplace_back(kind.name);
    return names;
  });
}

}  // namespace gauntlet::python
