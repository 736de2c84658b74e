#include "sim/show/video/png_file.h"

#include <cairo.h>
#include <fmt/format.h>

#include <memory>
#include <string>

#include "sim/base/error.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {
namespace {

cairo_status_t Append(void* closure, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

void WritePng(const Image& image, const std::filesystem::path& target) {
  // Cairo only reads it.
  auto* pixels = reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(image.pixels.data()));
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_ARGB32, image.width_px,
                                          image.height_px, 4 * image.width_px),
      &cairo_surface_destroy);
  std::string content;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), Append, &content);
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(
        fmt::format("{}: cannot write: {}", target.string(), cairo_status_to_string(status)));
  }
  WriteOutputFile(target, content);
}

}  // namespace gauntlet::sim
