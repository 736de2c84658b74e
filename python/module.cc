#include <pybind11/pybind11.h>

#include <exception>
#include <string>

#include "controller/settings.h"
#include "python/bindings.h"
#include "python/long_call.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/hand/hand_model.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

/// Raises an exception of gauntlet._errors.
void Raise(const char* name, const py::tuple& arguments) {
  const py::object type = py::module_::import("gauntlet._errors").attr(name);
  PyErr_SetObject(type.ptr(), type(*arguments).ptr());
}

}  // namespace

void SetPythonError(const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const sim::UserError& mistake) {
    Raise("SettingError", py::make_tuple(mistake.place(), mistake.key(), mistake.problem()));
  } catch (const controller::SettingError& mistake) {
    Raise("SettingError", py::make_tuple("", mistake.key(), mistake.problem()));
  } catch (const sim::RunError& failure) {
    Raise("RunError", py::make_tuple(std::string(failure.what())));
  } catch (const sim::Cancelled& cancelled) {
    PyErr_SetString(PyExc_KeyboardInterrupt, cancelled.kept.c_str());
  }
}

}  // namespace gauntlet::python

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace gauntlet::python;
  if (const std::string other = gauntlet::sim::HandModel::OtherEngine(); !other.empty()) {
    // It would be called with the structures of this one.
    throw py::import_error("MuJoCo " + other +
                           " is loaded for the whole process (RTLD_GLOBAL); import gauntlet "
                           "before it, or in a process of its own");
  }
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
