#pragma once

#include <pybind11/pybind11.h>

namespace gauntlet::python {

void BindFilter(pybind11::module_& module);
void BindController(pybind11::module_& module);
void BindStudies(pybind11::module_& module);
void BindSearches(pybind11::module_& module);
void BindLogs(pybind11::module_& module);

}  // namespace gauntlet::python
