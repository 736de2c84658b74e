#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "sim/show/video/drawing_library.h"
#include "tests/video/test_files.h"

namespace gauntlet::sim {
namespace {

TEST(PngFile, KeepsPixelsAndTransparency) {
  const TemporaryFolder folder;
  Image image(3, 2);
  image.pixels = {0xffff0000u, 0xff00ff00u, 0xff0000ffu, 0x00000000u, 0xffffffffu, 0x80800000u};
  WritePng(image, folder.path() / "a.png");

  const Image read = ReadPng(folder.path() / "a.png");
  ASSERT_EQ(read.width_px, 3);
  ASSERT_EQ(read.height_px, 2);
  EXPECT_EQ(read.pixels, image.pixels);
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
