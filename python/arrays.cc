#include "python/arrays.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/base/error.h"

namespace gauntlet::python {

namespace py = pybind11;

namespace {

bool IsMasked(const py::object& array) {
  return py::hasattr(array, "mask") &&
         py::module_::import("numpy.ma").attr("isMaskedArray")(array).cast<bool>();
}

}  // namespace

Rows RowsOf(const py::object& array, const std::string& place) {
  const py::array any = py::array::ensure(array);
  if (!any) {
    PyErr_Clear();
    throw sim::UserError({.place = place, .problem = "is no array"});
  }
  const char kind = any.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw sim::UserError({.place = place,
                          .problem = fmt::format("is an array of {}, must be of real numbers",
                                                 std::string(py::str(any.dtype())))});
  }
  if (any.ndim() < 1 || any.ndim() > 2) {
    throw sim::UserError(
        {.place = place,
         .problem = fmt::format(
             "has {} dimensions, must have 1 (samples) or 2 (samples x channels)", any.ndim())});
  }
  if (any.ndim() == 2 && any.shape(1) == 0) {
    throw sim::UserError({.place = place, .problem = "has no channels"});
  }
  // What is masked is missing; numpy would take what stands below the mask.
  Rows rows =
      Rows::ensure(IsMasked(array) ? array.attr("astype")("float64").attr("filled")(std::nan(""))
                                   : any.attr("astype")("float64", "C", "unsafe", false, false));
  if (!rows) throw py::error_already_set();
  return rows;
}

std::pair<std::size_t, std::size_t> ShapeOf(const py::array& rows) {
  return {static_cast<std::size_t>(rows.shape(0)),
          rows.ndim() == 2 ? static_cast<std::size_t>(rows.shape(1)) : 1};
}

std::span<const double> ValuesOf(const Rows& rows) {
  return {rows.data(), static_cast<std::size_t>(rows.size())};
}

}  // namespace gauntlet::python
