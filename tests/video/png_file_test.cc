#include "sim/video/png_file.h"

#include <cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "tests/video/test_files.h"

namespace gauntlet::sim {
namespace {

TEST(PngFile, KeepsPixelsAndTransparency) {
  const TemporaryFolder folder;
  Image image(3, 2);
  image.pixels = {0xffff0000u, 0xff00ff00u, 0xff0000ffu, 0x00000000u, 0xffffffffu, 0x80800000u};
  WritePng(image, folder.path() / "a.png");

  cairo_surface_t* read = cairo_image_surface_create_from_png((folder.path() / "a.png").c_str());
  ASSERT_EQ(cairo_surface_status(read), CAIRO_STATUS_SUCCESS);
  ASSERT_EQ(cairo_image_surface_get_width(read), 3);
  ASSERT_EQ(cairo_image_surface_get_height(read), 2);
  for (int y = 0; y < 2; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(
        cairo_image_surface_get_data(read) + y * cairo_image_surface_get_stride(read));
    for (int x = 0; x < 3; ++x) EXPECT_EQ(row[x], image.Row(y)[x]) << x << " " << y;
  }
  cairo_surface_destroy(read);
}

TEST(PngFile, NamesAMissingFolder) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "missing" / "a.png";
  try {
    WritePng(Image(2, 2), target);
    FAIL() << "no error";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(target.string()));
  }
}

}  // namespace
}  // namespace gauntlet::sim
