#include "sim/show/video/png_file.h"

#include "sim/base/output_file.h"
#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {

void WritePng(const Image& image, const std::filesystem::path& target) {
  WriteOutputFile(target, LoadDrawingLibrary().encode_png(image));
}

}  // namespace gauntlet::sim
