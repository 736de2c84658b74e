#include <pybind11/pybind11.h>

#include <exception>
#include <string>

#include "python/bindings.h"
#include "python/long_call.h"
#include "sim/base/data_folder.h"
#include "sim/hand/hand_model.h"
#include "sim/trial/external/external_filters.h"

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace gauntlet::python;
  if (const std::string other = gauntlet::sim::HandModel::OtherEngine(); !other.empty()) {
    // It would be called with the structures of this one.
    throw py::import_error("MuJoCo " + other +
                           " is loaded for the whole process (RTLD_GLOBAL); import gauntlet "
                           "before it, or in a process of its own");
  }
  CheckNumpy();
  py::register_exception_translator([](std::exception_ptr error) { SetPythonError(error); });
  gauntlet::sim::NameConsent("allow_programs=True");
  module.attr("__version__") = GAUNTLET_VERSION;
  module.def("set_data_folder",
             [](const std::string& folder) { gauntlet::sim::SetDataFolder(folder); });
  BindFilter(module);
  BindController(module);
  BindStudies(module);
  BindSearches(module);
  BindLogs(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(&EndLongCalls));
}
