#include "sim/show/video/comparison_video.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <utility>

#include "sim/base/error.h"
#include "sim/show/video/comparison_picture.h"
#include "tests/video/hand_picture.h"
#include "tests/video/small_comparison.h"
#include "tests/video/test_files.h"
#include "tests/video/video_reader.h"

namespace gauntlet::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const UserError& error) {
    return std::string("UserError: ") + error.what();
  } catch (const RunError& error) {
    return std::string("RunError: ") + error.what();
  }
  return "no error";
}

TEST(ComparisonVideo, HoldsEveryFrameOfTheMotion) {
  const TemporaryFolder folder;
  const SmallComparison comparison;
  int calls = 0;
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4",
                       [&](int done, int all) {
                         EXPECT_EQ(done, ++calls);
                         EXPECT_EQ(all, 15);
                         return true;
                       });
  EXPECT_EQ(calls, 15);
  const VideoContent content = ReadVideo(folder.path() / "a.mp4");
  EXPECT_EQ(content.codec, "h264");
  EXPECT_EQ(content.pixel_format, "yuv420p");
  EXPECT_EQ(content.width_px, 480);
  EXPECT_EQ(content.height_px, 270);
  EXPECT_EQ(content.frames, 15);
  EXPECT_TRUE(content.times_are_even);
  for (const auto& [left, right] : content.brightness) {
    EXPECT_GT(left, 100.0);  // light pages
    EXPECT_GT(right, 100.0);
  }
}

TEST(ComparisonVideo, DoesNotDependOnTheNumberOfProcesses) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  for (int jobs : {1, 2, 4}) {
    comparison.input.jobs = jobs;
    WriteComparisonVideo(comparison.input, TheHand(),
                         folder.path() / (std::to_string(jobs) + ".mp4"));
  }
  EXPECT_EQ(Bytes(folder.path() / "1.mp4"), Bytes(folder.path() / "2.mp4"));
  EXPECT_EQ(Bytes(folder.path() / "1.mp4"), Bytes(folder.path() / "4.mp4"));
}

/// The processes that this one has started and not yet seen the end of.
std::vector<int> Children() {
  std::vector<int> children;
  std::ifstream list("/proc/self/task/" + std::to_string(getpid()) + "/children");
  for (int child = 0; list >> child;) children.push_back(child);
  return children;
}

// Mesa walks through the scenes of all contexts of a process without a lock.
TEST(ComparisonVideo, DrawsWithOneThreadInEachProcess) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.jobs = 3;
  std::vector<int> with_one_thread;
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4", [&](int done, int) {
    if (done != 8) return true;  // all of them have drawn
    for (const int child : Children()) {
      const std::filesystem::directory_iterator threads("/proc/" + std::to_string(child) + "/task");
      if (std::distance(begin(threads), end(threads)) == kOneThread) {
        with_one_thread.push_back(child);
      }
    }
    return true;
  });
  EXPECT_EQ(with_one_thread.size(), 3u);  // the one that encodes has several
  EXPECT_TRUE(Children().empty());
}

TEST(ComparisonVideo, AProcessThatDiesIsOneErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  const SmallComparison comparison;
  for (const int which : {0, 1}) {  // one that encodes, one that draws
    EXPECT_THAT(MessageOf([&] {
                  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4",
                                       [&](int done, int) {
                                         if (done == 3) kill(Children()[which], SIGSYS);
                                         return true;
                                       });
                }),
                StartsWith(std::string("RunError: video: the process that ") +
                           (which == 0 ? "encodes" : "draws") + " was ended by signal 31"));
    EXPECT_TRUE(folder.IsEmpty());
    EXPECT_TRUE(Children().empty());
  }
}

TEST(ComparisonVideo, StopsOnRequestAndLeavesNothing) {
  const TemporaryFolder folder;
  const SmallComparison comparison;
  EXPECT_THROW(WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4",
                                    [](int done, int) { return done < 3; }),
               Cancelled);
  EXPECT_TRUE(folder.IsEmpty());
}

TEST(ComparisonVideo, NamesWhatIsWrongAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto message_of = [&](const std::function<void(VideoInput&)>& spoil, const char* name) {
    SmallComparison comparison;
    spoil(comparison.input);
    return MessageOf(
        [&] { WriteComparisonVideo(comparison.input, TheHand(), folder.path() / name); });
  };
  EXPECT_THAT(message_of([](VideoInput&) {}, "missing/a.mp4"),
              AllOf(StartsWith("RunError: "), HasSubstr("missing/a.mp4")));
  EXPECT_THAT(message_of([](VideoInput& input) { input.camera = "hnd"; }, "a.mp4"),
              AllOf(StartsWith("UserError: "), HasSubstr("did you mean hand?")));
  EXPECT_THAT(message_of([](VideoInput& input) { input.panes.resize(9, input.panes[0]); }, "a.mp4"),
              AllOf(StartsWith("UserError: "), HasSubstr("9 controllers")));
  EXPECT_THAT(message_of([](VideoInput& input) { input.joint = 18; }, "a.mp4"),
              AllOf(StartsWith("RunError: "), HasSubstr("joint 18")));
  EXPECT_TRUE(folder.IsEmpty());
}

TEST(ComparisonVideo, AStoppedTrialStandsStillToTheEnd) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  const Signal stopped = comparison.input.panes[1].hand_angle_rad->topRows(100);
  comparison.input.panes[1] = {
      .title = "stopped", .hand_angle_rad = &stopped, .spool_angle_rad = &stopped};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4");
  EXPECT_EQ(ReadVideo(folder.path() / "a.mp4").frames, 15);

  const ComparisonPicture picture(comparison.input);
  EXPECT_EQ(picture.SampleOf(0, 14), 466);
  EXPECT_EQ(picture.SampleOf(1, 14), 99);
}

TEST(ComparisonVideo, QuestionAndVerdictStandBeforeAndAfterTheMotion) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.question = "Which one follows?";
  comparison.input.verdict = {
      .columns = {"error"},
      .rows = {{.controller = "all", .cells = {{.value = "0", .detail = ""}}}},
      .remark = "One run."};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4");
  EXPECT_EQ(ReadVideo(folder.path() / "a.mp4").frames, 45 + 15 + 75);
}

// The part that is shown again takes four times its time at a quarter of the speed.
TEST(ComparisonVideo, ThePartThatDecidesIsShownAgainSlowly) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.question = "Which one follows?";
  comparison.input.again = Excerpt{.from_s = 0.2, .to_s = 0.4, .speed = 0.25};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4");
  EXPECT_EQ(ReadVideo(folder.path() / "a.mp4").frames, 45 + 15 + 24);
  const auto stretches = StretchesOf(true, 1000.0, 500, 30, comparison.input.again);
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_DOUBLE_EQ(stretches[0].video_s, 1.5);
  EXPECT_DOUBLE_EQ(stretches[1].video_s, 2.0);
  EXPECT_DOUBLE_EQ(stretches[1].to_s, 0.4);
}

/// As ` title begin end` in frames of 30 a second.
std::string ChaptersIn(const std::filesystem::path& file) {
  std::string text;
  for (const auto& [title, begin_s, end_s] : ReadVideo(file).chapters) {
    text += fmt::format(" {} {:g} {:g}", title, std::round(1e3 * 30.0 * begin_s) / 1e3,
                        std::round(1e3 * 30.0 * end_s) / 1e3);
  }
  return text;
}

TEST(ComparisonVideo, NamedPartsOfTheMotionAreChapters) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.parts = {{"slow", 0, 200}, {"fast", 300, 500}};
  for (const char* name : {"a.mp4", "a.webm"}) {
    WriteComparisonVideo(comparison.input, TheHand(), folder.path() / name);
    EXPECT_EQ(ChaptersIn(folder.path() / name), " slow 0 6 unlabelled 6 9 fast 9 15") << name;
  }
  // Those of an excerpt, from its own beginning.
  comparison.input.excerpt = {.from_s = 0.4, .speed = 0.5};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "b.webm");
  EXPECT_EQ(ChaptersIn(folder.path() / "b.webm"), " fast 0 6");
  comparison.input.excerpt = {.from_s = 0.2, .to_s = 0.3};  // has none of them
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "c.webm");
  EXPECT_EQ(ChaptersIn(folder.path() / "c.webm"), "");
  comparison.input.excerpt = {};
  // A GIF has none, and is a GIF all the same.
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "b.gif");
  EXPECT_EQ(ChaptersIn(folder.path() / "b.gif"), "");
}

TEST(ComparisonVideo, ChaptersBeginBehindTheQuestion) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.question = "Which one follows?";
  comparison.input.parts = {{"slow", 200, 300}};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.mp4");
  EXPECT_EQ(ChaptersIn(folder.path() / "a.mp4"),
            " question 0 45 unlabelled 45 51 slow 51 54 unlabelled 54 60");
}

TEST(ComparisonVideo, AnExcerptInSlowMotionHasItsFrames) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.excerpt = {.from_s = 0.1, .to_s = 0.3, .speed = 0.5};
  WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "a.webm");
  const VideoContent content = ReadVideo(folder.path() / "a.webm");
  EXPECT_EQ(content.codec, "vp9");
  EXPECT_EQ(content.frames, 12);  // 0.2 s, twice as long, at 30 a second
  comparison.input.excerpt = {.from_s = 0.5};
  EXPECT_THAT(MessageOf([&] {
                WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "b.mp4");
              }),
              StartsWith("UserError: video: nothing to show from 0.5 s on"));
}

/// How many pixels of a part of a picture are of the wearer's colour, strong or pale.
int WearersPixels(const Image& image, int left, int right) {
  int count = 0;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = left; x < right; ++x) {
      const std::uint32_t pixel = image.Row(y)[x];
      const int red = pixel >> 16 & 255, green = pixel >> 8 & 255, blue = pixel & 255;
      count += red > green + 40 && blue > green + 20 && red > blue + 20;
    }
  }
  return count;
}

TEST(ComparisonVideo, OnlyAHandThatDoesNotFollowHasTheWearersBehindIt) {
  const TemporaryFolder folder;
  const SmallComparison comparison;
  WriteComparisonPng(comparison.input, TheHand(), 0.25, folder.path() / "a.png");
  const Image frame = ReadPng(folder.path() / "a.png");
  ASSERT_EQ(frame.width_px, 480);
  EXPECT_GT(WearersPixels(frame, 240, 480), 4 * WearersPixels(frame, 0, 240));
  EXPECT_THAT(MessageOf([&] {
                WriteComparisonPng(comparison.input, TheHand(), 0.6, folder.path() / "b.png");
              }),
              StartsWith("UserError: --frame 0.6: must be from 0 to 0.4"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.png"));
}

/// How many pixels of the left part of a picture, where an overlay has its hands, are of the colour
/// of the second one.
int SecondHandsPixels(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < 2 * image.width_px / 5; ++x) {
      const std::uint32_t pixel = image.Row(y)[x];
      const int red = pixel >> 16 & 255, green = pixel >> 8 & 255, blue = pixel & 255;
      count += green > red + 60 && green > blue + 15;
    }
  }
  return count;
}

TEST(ComparisonVideo, AnOverlayShowsTheSecondHandWhereItIsElsewhere) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  comparison.input.overlay = true;
  const auto frame = [&](const char* name) {
    WriteComparisonPng(comparison.input, TheHand(), 0.25, folder.path() / name);
    return ReadPng(folder.path() / name);
  };
  const Image both = frame("both.png");
  std::swap(comparison.input.panes[0], comparison.input.panes[1]);
  std::swap(comparison.input.panes[0].series, comparison.input.panes[1].series);
  const Image swapped = frame("swapped.png");
  EXPECT_NE(both.pixels, swapped.pixels);
  comparison.input.panes[1] = comparison.input.panes[0];
  comparison.input.panes[1].series = 2;
  const Image same = frame("same.png");
  EXPECT_GT(SecondHandsPixels(both), 50);
  EXPECT_GT(SecondHandsPixels(both), 4 * SecondHandsPixels(same));
  EXPECT_GT(SecondHandsPixels(swapped), 4 * SecondHandsPixels(same));

  for (const char* name : {"a.mp4", "a.webm", "a.gif"}) {
    WriteComparisonVideo(comparison.input, TheHand(), folder.path() / name);
    EXPECT_EQ(ReadVideo(folder.path() / name).frames, 15) << name;
  }
  comparison.input.panes.pop_back();
  EXPECT_EQ(MessageOf([&] {
              WriteComparisonVideo(comparison.input, TheHand(), folder.path() / "b.mp4");
            }),
            "RunError: video: an overlay is of two hands");
}

/// Mean difference of two pictures, per part of a pixel.
double DifferenceOf(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (const int part : {0, 8, 16}) {
      sum += std::abs(static_cast<int>(a.pixels[i] >> part & 255u) -
                      static_cast<int>(b.pixels[i] >> part & 255u));
    }
  }
  return sum / (3.0 * static_cast<double>(a.pixels.size()));
}

TEST(ComparisonVideo, AFinerLookIsNearerToTheHandsTrueShape) {
  const TemporaryFolder folder;
  SmallComparison comparison;
  const auto frame = [&](const Look& look) {
    comparison.input.look = look;
    WriteComparisonPng(comparison.input, TheHand(), 0.2, folder.path() / "a.png");
    return ReadPng(folder.path() / "a.png");
  };
  const Image fast = frame(kFastLook), good = frame(kGoodLook), best = frame(kBestLook);
  const Image smooth =
      frame({.name = "", .supersampling = 8, .sides = 96, .plain_cables = false, .shadows = false});
  EXPECT_LT(1.3 * DifferenceOf(good, smooth), DifferenceOf(fast, smooth));
  EXPECT_NE(best.pixels, good.pixels);
}

TEST(HandPicture, ShowsThePostureOnTheBackgroundAskedFor) {
  const TemporaryFolder folder;
  std::vector<double> open(kChannels.size(), 0.0), fist = open;
  for (int channel : {4, 5, 6, 7, 8, 9, 10, 11}) fist[channel] = 1.2;
  const auto write = [&](const std::vector<double>& posture, bool transparent, const char* name) {
    WriteHandPng(TheHand(), posture, open,
                 {.camera = "hand", .width_px = 160, .height_px = 120, .transparent = transparent},
                 folder.path() / name);
    return Bytes(folder.path() / name);
  };
  const std::string first = write(open, false, "open.png");
  EXPECT_EQ(first.substr(1, 3), "PNG");
  EXPECT_EQ(first, write(open, false, "again.png"));
  EXPECT_NE(first, write(fist, false, "fist.png"));
  EXPECT_NE(first, write(open, true, "transparent.png"));
}

}  // namespace
}  // namespace gauntlet::sim
