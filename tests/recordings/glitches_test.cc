// Which wild values are found, and that those of real motions are not: in the recordings that are
// shipped, and with spikes put into them.
#include "sim/recordings/glitches.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/recording_reader.h"
#include "sim/recordings/table_source.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Places of glitches in values of a joint with a range of 1, as a whole file.
std::vector<std::size_t> Glitches(const std::vector<double>& values, double rate_hz = 100.0,
                                  StretchEnds ends = {true, true}) {
  std::vector<double> time_s;
  for (std::size_t i = 0; i < values.size(); ++i) {
    time_s.push_back(static_cast<double>(i) / rate_hz);
  }
  return FindGlitches(time_s, values, 1.0, ends);
}

TEST(Glitches, AreWildValuesThatComeBack) {
  EXPECT_THAT(Glitches({0, 0, 0.3, 0, 0}), ElementsAre(2));
  EXPECT_THAT(Glitches({0, 0, -0.3, 0, 0}), ElementsAre(2));
  EXPECT_THAT(Glitches({0, 0, 0.9, 0.4, 0, 0}), ElementsAre(2, 3));
  EXPECT_THAT(Glitches({0, 0, 0.9, -0.9, 0, 0}), ElementsAre(2, 3));
  EXPECT_THAT(Glitches({0, 0, 0, 0.9, 0.9, 0.9, 0, 0, 0}), ElementsAre(3, 4, 5));
  EXPECT_THAT(Glitches({0, 0, 0, 0, 0.2, 0.6, 0.4, 0.2, 0, 0}), ElementsAre(4, 5, 6, 7));
  EXPECT_THAT(Glitches({0, 0.9, 0, 0.9, 0}), ElementsAre(1, 3));
  EXPECT_THAT(Glitches({0, 0, 0.2, 0, 0}), ElementsAre(2));
  EXPECT_THAT(Glitches({0, 0, 0.1, 0, 0}), ElementsAre());
  EXPECT_THAT(Glitches({0, 0, 0, 0.9, 0.9, 0.9, 0.9}), ElementsAre());  // a step
}

TEST(Glitches, AreFoundBesideMissingValues) {
  const double nan = std::nan("");
  EXPECT_THAT(Glitches({0, 0, nan, 0.9, nan, 0, 0}), ElementsAre(3));
  EXPECT_THAT(Glitches({nan, nan}), ElementsAre());
}

TEST(Glitches, AreFoundAtTheEndsOfAFileButNotOfAStretchOfIt) {
  EXPECT_THAT(Glitches({0.9, 0, 0, 0, 0}), ElementsAre(0));
  EXPECT_THAT(Glitches({0.9, 0.8, 0, 0, 0}), ElementsAre(0, 1));
  EXPECT_THAT(Glitches({0, 0, 0, 0, 0.9}), ElementsAre(4));
  EXPECT_THAT(Glitches({0, 0, 0, 0.9, 0.8}), ElementsAre(3, 4));
  EXPECT_THAT(Glitches({0.9, 0, 0.2, 0.4, 0.6}), ElementsAre());  // nothing to compare with
  EXPECT_THAT(Glitches({0, 0.9}), ElementsAre());
  EXPECT_THAT(Glitches({0.9, 0, 0, 0, 0.9}, 100.0, {false, false}), ElementsAre());
}

TEST(Glitches, AreNotWhatAHandCanDoBetweenTwoRows) {
  EXPECT_THAT(Glitches({0, 0, 0.5, 0, 0}, 50.0), ElementsAre(2));
  EXPECT_THAT(Glitches({0, 0, 0.5, 0, 0}, 20.0), ElementsAre());
  // Opening and closing six times a second by 60 % of the range, with minimum jerk, at the rates of
  // real files.
  for (const double rate_hz : {12.0, 20.0, 25.0, 30.0, 50.0, 60.0, 100.0, 1000.0}) {
    std::vector<double> bursts;
    for (int i = 0; i < static_cast<int>(3 * rate_hz); ++i) {
      const double cycle = std::fmod(i / rate_hz * 6.0, 1.0);
      const double way = cycle < 0.5 ? 2.0 * cycle : 2.0 - 2.0 * cycle;
      bursts.push_back(0.6 * way * way * way * (10.0 - 15.0 * way + 6.0 * way * way));
    }
    EXPECT_THAT(Glitches(bursts, rate_hz), ElementsAre()) << rate_hz;
  }
}

/// A lone movement to and fro by 60 % of the range, as fast as a hand can, in ten seconds of rest.
TEST(Glitches, AreNotALoneMovementOfAHand) {
  for (const double rate_hz : {25.0, 30.0, 50.0, 60.0, 100.0, 200.0, 1000.0}) {
    std::vector<double> values(static_cast<std::size_t>(10.0 * rate_hz), 0.1);
    for (int i = 0; i < static_cast<int>(rate_hz / 6.0); ++i) {
      const double cycle = i / rate_hz * 6.0;
      const double way = cycle < 0.5 ? 2.0 * cycle : 2.0 - 2.0 * cycle;
      values[values.size() / 2 + i] +=
          0.6 * way * way * way * (10.0 - 15.0 * way + 6.0 * way * way);
    }
    EXPECT_THAT(Glitches(values, rate_hz), IsEmpty()) << rate_hz;
  }
}

/// One channel of a recording that is shipped, as it was read.
struct RealMotion {
  std::vector<double> time_s;
  std::vector<double> angle_rad;
  double range_rad = 0.0;
};

/// All its channels.
std::vector<RealMotion> MotionsIn(const std::string& file, RecordingFormat format = {}) {
  const std::string path = SourceDir() + "/scenarios/recordings/" + file;
  format.handling = ProblemHandling::kRepair;
  RecordingReader reader(path, TableSource(path), format);
  std::vector<RealMotion> motions(KnownChannels().size());
  std::vector<double> angles(motions.size());
  double time_s = 0.0;
  while (reader.NextRow(time_s, angles)) {
    for (std::size_t c = 0; c < motions.size(); ++c) {
      motions[c].time_s.push_back(time_s);
      motions[c].angle_rad.push_back(angles[c]);
      motions[c].range_rad = (KnownChannels()[c].max_deg - KnownChannels()[c].min_deg) * kRadPerDeg;
    }
  }
  return motions;
}

std::vector<RealMotion> DoorMotions() {
  std::vector<RealMotion> all;
  for (int i = 1; i <= 25; ++i) {
    for (RealMotion& motion : MotionsIn(fmt::format("door_opening/angles_{:02}.csv", i))) {
      all.push_back(std::move(motion));
    }
  }
  return all;
}

std::vector<std::size_t> GlitchesIn(const RealMotion& motion) {
  return FindGlitches(motion.time_s, motion.angle_rad, motion.range_rad, {true, true});
}

TEST(Glitches, AreFoundInLessThanOneOfTenThousandRealSamples) {
  std::vector<RealMotion> motions = DoorMotions();
  RecordingFormat of_letters;
  of_letters.rate_hz = 50.0;
  of_letters.map = SourceDir() + "/scenarios/recordings/sign_glove/map.csv";
  for (const auto& more : {MotionsIn("door_opening/targets.csv"),
                           MotionsIn("sign_glove/letters_v_h_r.csv", of_letters)}) {
    motions.insert(motions.end(), more.begin(), more.end());
  }
  std::size_t samples = 0;
  std::size_t found = 0;
  for (const RealMotion& motion : motions) {
    for (const double angle : motion.angle_rad) samples += std::isfinite(angle) ? 1 : 0;
    found += GlitchesIn(motion).size();
  }
  EXPECT_GT(samples, 150'000u);
  EXPECT_LT(1e4 * static_cast<double>(found), static_cast<double>(samples)) << found;
}

/// Of how many spikes of this shape [deg] the largest values are found, one in each motion.
double FoundShare(const std::vector<double>& shape_deg) {
  RandomStream random(1, "test spikes");
  int found = 0;
  int all = 0;
  for (RealMotion motion : DoorMotions()) {
    const double range_deg = motion.range_rad * kDegPerRad;
    if (range_deg < 80.0 || range_deg > 135.0) continue;  // of fingers: 20 deg are much of it
    if (std::isnan(motion.angle_rad[50])) continue;       // not recorded
    const std::size_t room = motion.angle_rad.size() - 100 - shape_deg.size();
    const auto first = 50 + static_cast<std::size_t>(random.Uniform() * static_cast<double>(room));
    const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
    for (std::size_t i = 0; i < shape_deg.size(); ++i) {
      motion.angle_rad[first + i] += side * shape_deg[i] * kRadPerDeg;
    }
    const std::vector<std::size_t> places = GlitchesIn(motion);
    const auto is_found = [&places](std::size_t place) {
      return std::ranges::find(places, place) != places.end();
    };
    bool whole = true;
    const double largest_deg = *std::ranges::max_element(shape_deg);
    for (std::size_t i = 0; i < shape_deg.size(); ++i) {
      whole = whole && (shape_deg[i] < largest_deg || is_found(first + i));
    }
    found += whole ? 1 : 0;
    ++all;
  }
  return static_cast<double>(found) / all;
}

TEST(Glitches, OfTwentyDegreesAreFoundInRealMotionsAlsoWideAndSlowOnes) {
  EXPECT_GT(FoundShare({20}), 0.95);
  EXPECT_GT(FoundShare({20, 20, 20}), 0.8);
  EXPECT_GT(FoundShare({20, 20, 20, 20, 20, 20}), 0.8);
  EXPECT_GT(FoundShare({40}), 0.95);
  EXPECT_GT(FoundShare({14, 42, 30, 12}), 0.9);
}

/// Rest in noise of this deviation, at 100 Hz.
std::vector<double> NoisyRest(double deviation) {
  RandomStream random(1, "noisy rest");
  std::vector<double> values(2000);
  for (double& value : values) value = 0.5 + deviation * BoxMuller(random).first;
  return values;
}

TEST(Glitches, AreNotTheChannelsOwnNoise) {
  EXPECT_THAT(Glitches(NoisyRest(0.06)), IsEmpty());
  std::vector<double> values = NoisyRest(0.02);
  values[1000] = 0.5;
  values[1001] = 0.5 + 0.05;  // within the noise: where the hand was when it began
  values[1002] = 0.5 + 0.9;
  values[1003] = 0.5;
  EXPECT_THAT(Glitches(values), ElementsAre(1002));
}

}  // namespace
}  // namespace gauntlet::sim
