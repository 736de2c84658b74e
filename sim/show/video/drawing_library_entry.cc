// What drawing_library.cc asks gauntlet_drawing.so for, which is made of this file, cairo_painter,
// libav_encoder and osmesa_context.
#include "sim/show/video/drawing_library.h"

extern "C" const gauntlet::sim::DrawingLibrary* GauntletDrawingLibrary() {
  static constexpr gauntlet::sim::DrawingLibrary kLibrary = {
      .open_context = gauntlet::sim::OpenOsmesaContext,
      .open_encoder = gauntlet::sim::OpenLibavEncoder,
      .open_painter = gauntlet::sim::OpenCairoPainter,
      .encode_png = gauntlet::sim::EncodeCairoPng};
  return &kLibrary;
}
