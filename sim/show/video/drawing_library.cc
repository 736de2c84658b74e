#include "sim/show/video/drawing_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"

namespace gauntlet::sim {

const DrawingLibrary& LoadDrawingLibrary() {
  static const DrawingLibrary& library = []() -> const DrawingLibrary& {
    // MuJoCo's renderer looks for OSMesa among the names that the whole process has.
    const std::string file = OwnLibrary("gauntlet_drawing.so");
    void* const loaded = dlopen(file.c_str(), RTLD_LAZY | RTLD_GLOBAL);
    if (loaded == nullptr) throw RunError(fmt::format("cannot draw: {}", dlerror()));
    void* const entry = dlsym(loaded, "GauntletDrawingLibrary");
    if (entry == nullptr) throw RunError(fmt::format("cannot draw: {}", dlerror()));
    return *reinterpret_cast<decltype(&GauntletDrawingLibrary)>(entry)();
  }();
  return library;
}

}  // namespace gauntlet::sim
