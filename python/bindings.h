#pragma once

#include <pybind11/pybind11.h>

#include <exception>

namespace gauntlet::python {

/// Sets the exception of Python for one of Gauntlet; throws others again.
void SetPythonError(const std::exception_ptr& error);

/// Raises ImportError if this build would misread the arrays of the numpy that is there: pybind11
/// before 2.12 takes the sizes of numpy 2 from where numpy 1 had them, and gives wrong values.
void CheckNumpy();

void BindFilter(pybind11::module_& module);
void BindController(pybind11::module_& module);
void BindStudies(pybind11::module_& module);
void BindSearches(pybind11::module_& module);
void BindLogs(pybind11::module_& module);

}  // namespace gauntlet::python
