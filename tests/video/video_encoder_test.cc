#include "sim/show/video/video_encoder.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "sim/base/error.h"
#include "tests/video/test_files.h"
#include "tests/video/video_reader.h"

namespace gauntlet::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

VideoFormat SmallFormat() {
  VideoFormat format;
  format.width_px = 64;
  format.height_px = 48;
  return format;
}

/// Left half and right half in two colours.
Image ColouredHalves(const VideoFormat& format, std::uint32_t left, std::uint32_t right) {
  Image image(format.width_px, format.height_px);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      image.Row(y)[x] = 0xff000000u | (x < image.width_px / 2 ? left : right);
    }
  }
  return image;
}

Image Halves(const VideoFormat& format, std::uint32_t left_grey, std::uint32_t right_grey) {
  return ColouredHalves(format, 0x010101u * left_grey, 0x010101u * right_grey);
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const RunError& error) {
    return error.what();
  }
  return "no error";
}

/// A video as its owner makes it; `add` adds the frames.
void Encode(const std::filesystem::path& target, const VideoFormat& format,
            const std::function<void(VideoEncoder&)>& add) {
  OutputFile file(target);
  const auto encoder = OpenVideo(file, format);
  add(*encoder);
  encoder->Finish();
  file.Commit();
}

void AddNothing(VideoEncoder&) {}

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(VideoEncoder, WritesWebM) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.container = ContainerOf("a.webm");
  Encode(folder.path() / "a.webm", format, [&](VideoEncoder& encoder) {
    for (std::uint32_t i = 0; i < 20; ++i) encoder.Add(Halves(format, 40, 200));
  });
  const VideoContent content = ReadVideo(folder.path() / "a.webm");
  EXPECT_EQ(content.codec, "vp9");
  EXPECT_EQ(content.pixel_format, "yuv420p");
  EXPECT_EQ(content.frames, 20);
  for (const auto& [left, right] : content.brightness) {
    EXPECT_NEAR(left, 16.0 + 219.0 * 40.0 / 255.0, 2.0);
    EXPECT_NEAR(right, 16.0 + 219.0 * 200.0 / 255.0, 2.0);
  }
}

TEST(VideoEncoder, WritesAGif) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.container = ContainerOf("a.gif");
  format.frames_per_s = 20;
  Encode(folder.path() / "a.gif", format, [&](VideoEncoder& encoder) {
    for (int i = 0; i < 20; ++i) encoder.Add(Halves(format, 12 * i, 255 - 12 * i));
  });
  const VideoContent content = ReadVideo(folder.path() / "a.gif");
  EXPECT_EQ(content.codec, "gif");
  EXPECT_EQ(content.width_px, 64);
  EXPECT_EQ(content.height_px, 48);
  EXPECT_EQ(content.frames, 20);
  EXPECT_EQ(Bytes(folder.path() / "a.gif").substr(0, 6), "GIF89a");

  format.frames_per_s = 60;
  EXPECT_THROW(Encode(folder.path() / "b.gif", format, AddNothing), UserError);
}

TEST(VideoEncoder, AGifHasNoDitherAndTheColoursOfItsSamples) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.container = Container::kGif;
  format.frames_per_s = 10;
  Image first = ColouredHalves(format, 0xeef1f5, 0xd58dc2);
  Image second = ColouredHalves(format, 0xeef1f5, 0x172333);
  format.samples = {first, second};
  Encode(folder.path() / "a.gif", format, [&](VideoEncoder& encoder) {
    for (int i = 0; i < 3; ++i) encoder.Add(i == 1 ? second : first);
  });
  EXPECT_EQ(ReadVideo(folder.path() / "a.gif").colours, (std::vector<std::size_t>{2, 2, 2}));

  // More colours than a palette has: neighbours share one.
  Image ramp(format.width_px, format.height_px);
  for (std::uint32_t i = 0; i < ramp.pixels.size(); ++i) {
    ramp.pixels[i] = 0xff000000u | (i * 5u & 0xffu) << 16 | (i / 12u & 0xffu) << 8 | 0x80u;
  }
  format.samples = {};
  Encode(folder.path() / "b.gif", format, [&](VideoEncoder& encoder) { encoder.Add(ramp); });
  const std::vector<std::size_t> colours = ReadVideo(folder.path() / "b.gif").colours;
  ASSERT_EQ(colours.size(), 1u);
  EXPECT_GT(colours[0], 200u);
  EXPECT_LE(colours[0], 255u);
}

TEST(VideoEncoder, WritesWhatAPlayerExpects) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.frames_per_s = 25;
  Encode(folder.path() / "a.mp4", format, [&](VideoEncoder& encoder) {
    for (int i = 0; i < 61; ++i) encoder.Add(Halves(format, 40, 200));
  });

  const VideoContent content = ReadVideo(folder.path() / "a.mp4");
  EXPECT_EQ(content.codec, "h264");
  EXPECT_EQ(content.pixel_format, "yuv420p");
  EXPECT_EQ(content.color_space, "bt709");
  EXPECT_EQ(content.width_px, 64);
  EXPECT_EQ(content.height_px, 48);
  EXPECT_EQ(content.frames_per_s, 25.0);
  EXPECT_EQ(content.frames, 61);
  EXPECT_TRUE(content.times_are_even);
}

// Video range: 16 is black and 235 white, so grey g becomes 16 + 219 g / 255.
TEST(VideoEncoder, KeepsBrightnessAndOrderOfFrames) {
  const TemporaryFolder folder;
  const VideoFormat format = SmallFormat();
  Encode(folder.path() / "a.mp4", format, [&](VideoEncoder& encoder) {
    for (int i = 0; i < 40; ++i) encoder.Add(Halves(format, 5 * i, 255 - 5 * i));
  });

  const VideoContent content = ReadVideo(folder.path() / "a.mp4");
  ASSERT_EQ(content.frames, 40);
  for (int i = 0; i < 40; ++i) {
    EXPECT_NEAR(content.brightness[i][0], 16.0 + 219.0 * (5 * i) / 255.0, 2.0) << i;
    EXPECT_NEAR(content.brightness[i][1], 16.0 + 219.0 * (255 - 5 * i) / 255.0, 2.0) << i;
  }
}

TEST(VideoEncoder, PutsTheIndexInFront) {
  const TemporaryFolder folder;
  const VideoFormat format = SmallFormat();
  Encode(folder.path() / "a.mp4", format, [&](VideoEncoder& encoder) {
    for (int i = 0; i < 5; ++i) encoder.Add(Halves(format, 0, 255));
  });
  const auto boxes = BoxesOf(folder.path() / "a.mp4");
  const auto index = std::find(boxes.begin(), boxes.end(), "moov");
  const auto data = std::find(boxes.begin(), boxes.end(), "mdat");
  ASSERT_NE(index, boxes.end());
  ASSERT_NE(data, boxes.end());
  EXPECT_LT(index, data);
}

TEST(VideoEncoder, GivesTheSameBytesForTheSameFrames) {
  const TemporaryFolder folder;
  const VideoFormat format = SmallFormat();
  for (const char* name : {"a.mp4", "b.mp4"}) {
    Encode(folder.path() / name, format, [&](VideoEncoder& encoder) {
      for (int i = 0; i < 20; ++i) encoder.Add(Halves(format, 7 * i, 3 * i));
    });
  }
  EXPECT_EQ(Bytes(folder.path() / "a.mp4"), Bytes(folder.path() / "b.mp4"));
}

TEST(VideoEncoder, LeavesNothingWithoutFinish) {
  const TemporaryFolder folder;
  const VideoFormat format = SmallFormat();
  {
    const OutputFile file(folder.path() / "a.mp4");
    const auto encoder = OpenVideo(file, format);
    for (int i = 0; i < 100; ++i) encoder->Add(Halves(format, 0, 255));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.mp4"));
  }
  EXPECT_TRUE(folder.IsEmpty());
}

TEST(VideoEncoder, NamesAMissingEncoderBeforeItWrites) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.encoder = "no_such_encoder";
  EXPECT_THAT(MessageOf([&] { Encode(folder.path() / "a.mp4", format, AddNothing); }),
              AllOf(HasSubstr("a.mp4"), HasSubstr("no encoder no_such_encoder")));
  EXPECT_TRUE(folder.IsEmpty());
}

TEST(VideoEncoder, NamesAMissingFolder) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "missing" / "a.mp4";
  EXPECT_THAT(MessageOf([&] { Encode(target, SmallFormat(), AddNothing); }),
              AllOf(HasSubstr(target.string()), HasSubstr("No such file or directory")));
}

TEST(VideoEncoder, NamesATargetThatIsAFolder) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "a.mp4";
  std::filesystem::create_directories(target / "full");
  const VideoFormat format = SmallFormat();
  EXPECT_THAT(MessageOf([&] {
                Encode(target, format,
                       [&](VideoEncoder& encoder) { encoder.Add(Halves(format, 0, 255)); });
              }),
              HasSubstr(target.string()));
  EXPECT_TRUE(std::filesystem::is_directory(target));
}

TEST(VideoEncoder, RefusesWhatH264CannotHave) {
  const TemporaryFolder folder;
  VideoFormat format = SmallFormat();
  format.width_px = 63;
  EXPECT_THROW(Encode(folder.path() / "a.mp4", format, AddNothing), UserError);
  format = SmallFormat();
  format.frames_per_s = 0;
  EXPECT_THROW(Encode(folder.path() / "a.mp4", format, AddNothing), UserError);
  EXPECT_TRUE(folder.IsEmpty());
}

/// A file may not grow beyond `bytes` while this lives: what a full disk does, without a disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit = {bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_limit_ = {};
  void (*old_handler_)(int) = nullptr;
};

std::string MessageOfFullDisk(const std::filesystem::path& target, rlim_t bytes) {
  const VideoFormat format = SmallFormat();
  const FileSizeLimit limit(bytes);
  return MessageOf([&] {
    Encode(target, format, [&](VideoEncoder& encoder) {
      std::uint32_t noise = 1;
      for (int frame = 0; frame < 200; ++frame) {
        Image image(format.width_px, format.height_px);
        for (auto& pixel : image.pixels) pixel = noise = noise * 1664525u + 1013904223u;
        encoder.Add(image);
      }
    });
  });
}

TEST(VideoEncoder, TellsOfAFullDiskAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto target = folder.path() / "a.mp4";
  EXPECT_EQ(MessageOfFullDisk(target, RLIM_INFINITY), "no error");
  const auto whole = std::filesystem::file_size(target);
  std::filesystem::remove(target);
  // Nothing fits; the frames do not; the index, written last, does not.
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{100'000}, rlim_t{whole - 1}}) {
    EXPECT_THAT(
        MessageOfFullDisk(target, bytes),
        AllOf(HasSubstr(target.string()), HasSubstr("cannot write"), HasSubstr("too large")));
    EXPECT_TRUE(folder.IsEmpty()) << bytes;
  }
}

}  // namespace
}  // namespace gauntlet::sim
