#include <pybind11/pybind11.h>

#include <exception>

#include "python/bindings.h"

/// The compiled part of gauntlet_controller: no simulation, and nothing of MuJoCo.
PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace gauntlet::python;
  CheckNumpy();
  py::register_exception_translator([](std::exception_ptr error) { SetPythonError(error); });
  module.attr("__version__") = GAUNTLET_VERSION;
  BindFilter(module);
  BindController(module);
}
