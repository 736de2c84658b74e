#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "sim/base/signal.h"

namespace gauntlet::python {

/// Rows of numbers, as filters and controllers take them.
using Rows = pybind11::array_t<double, pybind11::array::c_style>;

/// The array, or a copy of it in rows of doubles where it is of other numbers or otherwise in
/// memory. One dimension: one channel. Errors: UserError with `place` for what is no array of real
/// numbers with one or two dimensions, or has no columns.
Rows RowsOf(const pybind11::object& array, const std::string& place);

/// Number of rows and of columns.
std::pair<std::size_t, std::size_t> ShapeOf(const pybind11::array& rows);

/// The values in memory. `Mutable` ones are those of an array that the caller may change.
std::span<const double> ValuesOf(const Rows& rows);

/// A signal as array of samples x columns, without a copy; `owner` lives as long as the array,
/// which is read-only.
template <class Scalar>
pybind11::array ViewOf(const sim::SignalOf<Scalar>& signal, std::shared_ptr<const void> owner) {
  namespace py = pybind11;
  const auto rows = static_cast<py::ssize_t>(signal.rows());
  const auto columns = static_cast<py::ssize_t>(signal.cols());
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(Scalar));
  const py::capsule keeper(new std::shared_ptr<const void>(std::move(owner)), [](void* held) {
    delete static_cast<std::shared_ptr<const void>*>(held);
  });
  py::array_t<Scalar> view({rows, columns}, {kSize, kSize * rows}, signal.data(), keeper);
  view.attr("flags").attr("writeable") = false;
  return view;
}

}  // namespace gauntlet::python
