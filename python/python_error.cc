#include <pybind11/pybind11.h>

#include <exception>
#include <string>

#include "controller/settings.h"
#include "python/bindings.h"
#include "sim/base/error.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

/// Raises an exception of the package's _errors.
void Raise(const char* name, const py::tuple& arguments) {
  const py::object type = py::module_::import(GAUNTLET_PYTHON_PACKAGE "._errors").attr(name);
  PyErr_SetObject(type.ptr(), type(*arguments).ptr());
}

}  // namespace

void CheckNumpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const auto version = py::module_::import("numpy").attr("__version__").cast<std::string>();
  if (version.starts_with("0.") || version.starts_with("1.")) return;
  throw py::import_error("this build of " GAUNTLET_PYTHON_PACKAGE
                         " is for numpy 1 (it was made with pybind11 before 2.12), and numpy " +
                         version + " is here; take python3-numpy of the system, or the wheel");
#endif
}

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
