#include "sim/fit/audit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/tables/mcap_writer.h"
#include "tests/calibrate/simulated_log.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using namespace simulated_log;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRate_hz = 30.0;

/// A follower of the second order behind a dead time: another model than a pure shift.
Values SecondOrder(const Values& target, double dead_s, double frequency_hz) {
  const double omega = 2.0 * kPi * frequency_hz;
  constexpr double kDamping = 0.8;
  const auto dead = static_cast<std::size_t>(dead_s * kFine_hz);
  double angle = target.front(), speed = 0.0;
  Values answer;
  for (std::size_t n = 0; n < target.size(); ++n) {
    const double to = target[n < dead ? 0 : n - dead];
    speed += (omega * omega * (to - angle) - 2.0 * kDamping * omega * speed) / kFine_hz;
    angle += speed / kFine_hz;
    answer.push_back(angle);
  }
  return answer;
}

/// Command and angle of a part in one episode.
struct Pair {
  Values command, angle;
};

class AuditTest : public testing::Test {
 protected:
  /// A motion and the answer to it, in rows of 30 Hz.
  Pair Follow(double seconds, double dead_s = 0.06, double frequency_hz = 6.0, double noise = 0.1,
              double rate_hz = kRate_hz) {
    Values target = Reaches(seconds, random_);
    target.resize(static_cast<std::size_t>(seconds * kFine_hz));
    return {
        Thinned(target, rate_hz),
        Measured(Thinned(SecondOrder(target, dead_s, frequency_hz), rate_hz), noise, 0.0, random_)};
  }

  /// Writes parts x episodes; names are p0, p1, ...
  std::filesystem::path Write(const std::vector<std::vector<Pair>>& parts,
                              double rate_hz = kRate_hz) {
    const std::filesystem::path file = folder_.path() / "log.csv";
    std::ofstream out(file);
    out << "episode_index,t_s";
    for (const char* end : {"_command_deg", "_deg"}) {
      for (std::size_t i = 0; i < parts.size(); ++i) out << ",p" << i << end;
    }
    out << "\n";
    for (std::size_t e = 0; e < parts.front().size(); ++e) {
      std::size_t rows = parts.front()[e].command.size();
      for (const auto& part : parts) rows = std::min(rows, part[e].command.size());
      for (std::size_t n = 0; n < rows; ++n) {
        out << fmt::format("{},{:.9g}", e, static_cast<double>(n) / rate_hz);
        for (const auto& part : parts) out << fmt::format(",{:.10g}", part[e].command[n]);
        for (const auto& part : parts) out << fmt::format(",{:.10g}", part[e].angle[n]);
        out << "\n";
      }
    }
    return file;
  }

  std::vector<Pair> Episodes(int count, double seconds, double dead_s = 0.06) {
    std::vector<Pair> episodes;
    for (int e = 0; e < count; ++e) episodes.push_back(Follow(seconds, dead_s));
    return episodes;
  }

  static std::vector<std::string> KeysOf(const std::vector<AuditFault>& faults) {
    std::vector<std::string> keys;
    for (const AuditFault& fault : faults) keys.push_back(fault.key);
    return keys;
  }

  std::mt19937 random_{11};
  test::TemporaryDirectory folder_;
};

TEST_F(AuditTest, NamesTheKindOfCommands) {
  std::vector<std::vector<Pair>> parts(9);
  for (int e = 0; e < 6; ++e) {
    std::vector<Pair> pairs;
    for (int i = 0; i < 10; ++i) pairs.push_back(Follow(12.0));
    parts[0].push_back(pairs[0]);
    parts[1].push_back({pairs[1].angle, pairs[1].angle});
    parts[2].push_back({Later(pairs[2].angle, 1), pairs[2].angle});
    parts[3].push_back({Changes(pairs[3].command, 0), pairs[3].angle});
    parts[4].push_back({Scaled(Changes(pairs[4].command, 0), kRate_hz, 0.0), pairs[4].angle});
    parts[5].push_back({pairs[5].command, Scaled(pairs[0].angle, 1.0, 5.0)});
    parts[6].push_back({pairs[6].command, pairs[9].angle});
    parts[7].push_back({pairs[7].command, Scaled(pairs[7].angle, -1.0, 0.0)});
    parts[8].push_back({Values(pairs[8].command.size(), 3.0), pairs[8].angle});
  }
  const Audit audit = AuditLog(Write(parts), {});
  std::vector<std::string> kinds;
  for (const AuditedPart& part : audit.parts) kinds.push_back(part.kind);
  EXPECT_THAT(kinds, ElementsAre("target", "copy", "next_row", "steps", "velocity", "other_part",
                                 "unrelated", "opposite", "command_still"));
  for (const AuditedPart& part : audit.parts) {
    EXPECT_EQ(std::isfinite(part.delay_ms.value), part.is_target()) << part.name;
  }
  EXPECT_THAT(audit.parts[5].kind_text, HasSubstr("follows the command of p0"));
  EXPECT_THAT(VerdictOf(audit).Text(), HasSubstr("Fix first: "));
}

TEST_F(AuditTest, RefusesCopiesAsTargets) {
  std::vector<Pair> copies = Episodes(4, 8.0);
  for (Pair& pair : copies) pair.command = pair.angle;
  const Audit audit = AuditLog(Write({copies}), {});
  EXPECT_EQ(VerdictOf(audit).recommended, "unusable");
  EXPECT_THAT(VerdictOf(audit).Text(), HasSubstr("copies of the angles"));
  // In some episodes alone.
  std::vector<Pair> some = Episodes(12, 8.0);
  for (const std::size_t e : {2U, 5U, 7U}) some[e].command = some[e].angle;
  const Audit mixed = AuditLog(Write({some}), {});
  EXPECT_EQ(mixed.parts[0].kind, "mixed");
  EXPECT_THAT(mixed.parts[0].kind_text, HasSubstr("in 3 of 12 episodes (2, 5, 7)"));
}

/// Where a person takes over, the recorder writes the angle as the command. Rows at rest, in which
/// a target equals its angle, are none of these.
TEST_F(AuditTest, SeesCopiesInSomeRowsOfAnEpisode) {
  Pair taken_over = Follow(24.0);
  for (std::size_t n = 369; n < taken_over.command.size(); ++n) {
    taken_over.command[n] = taken_over.angle[n];
  }
  const AuditedPart part = AuditLog(Write({{taken_over}}), {}).parts[0];
  EXPECT_EQ(part.kind, "mixed");
  EXPECT_THAT(part.kind_text,
              testing::MatchesRegex("its commands are copies of its angles in [4-6]. % of the "
                                    "moving rows, from 12.[34] s on"));
  std::vector<Pair> episodes = Episodes(10, 8.0);
  for (const std::size_t e : {2U, 7U}) {
    for (std::size_t n = 60; n < 180; ++n) episodes[e].command[n] = episodes[e].angle[n + 1];
  }
  const AuditedPart some = AuditLog(Write({episodes}), {}).parts[0];
  EXPECT_EQ(some.kind, "mixed");
  EXPECT_THAT(some.kind_text, HasSubstr("of the moving rows in 2 of 10 episodes (2, 7)"));
  // Long rests at the target, in whole counts.
  std::vector<Pair> rests(6);
  for (Pair& pair : rests) {
    Values target = Reaches(12.0, random_);
    target.resize(12000);
    for (std::size_t n = 4000; n < 9000; ++n) target[n] = target[4000];
    pair = {Rounded(Thinned(target, kRate_hz), 1.0),
            Rounded(Thinned(SecondOrder(target, 0.06, 6.0), kRate_hz), 1.0)};
  }
  EXPECT_EQ(AuditLog(Write({rests}), {}).parts[0].kind, "target");
}

/// Levels of steps are no rounding, and a part at rest is no copy of its command.
TEST_F(AuditTest, TakesStepsAndRestForTargets) {
  Pair steps, rest;
  std::normal_distribution<double> gauss(0.0, 0.04);
  Values target;
  for (int n = 0; n < 60000; ++n) target.push_back((n / 2000) % 2 == 0 ? 20.0 : 90.0);
  steps.command = Thinned(target, 20.0);
  steps.angle = Rounded(Thinned(SecondOrder(target, 0.02, 4.0), 20.0), 1.0);
  for (std::size_t n = 0; n < steps.command.size(); ++n) {
    rest.command.push_back(0.088 * std::round((10.0 + gauss(random_)) / 0.088));
    rest.angle.push_back(0.088 * std::round((10.0 + gauss(random_)) / 0.088));
  }
  const Audit audit = AuditLog(Write({{steps}, {rest}}, 20.0), {});
  EXPECT_EQ(audit.parts[0].kind, "target");
  EXPECT_GT(audit.parts[0].delay_ms.value, 30.0);
  EXPECT_LT(audit.parts[0].delay_ms.value, 130.0);
  EXPECT_EQ(audit.parts[1].kind, "unrelated");
  // Rests that are as long as a stretch: the answer to a step may lie in the next one.
  Values rare;
  for (int n = 0; n < 150000; ++n) rare.push_back((n / 7300) % 2 == 0 ? 20.0 : 120.0);
  const Pair slow{Thinned(rare, 20.0), Rounded(Thinned(SecondOrder(rare, 0.1, 1.5), 20.0), 1.0)};
  const AuditedPart part = AuditLog(Write({{slow}}, 20.0), {}).parts[0];
  EXPECT_EQ(part.kind, "target");
  EXPECT_THAT(KeysOf(part.faults), testing::Not(testing::Contains("odd")));
}

TEST_F(AuditTest, FindsOneFaultPerPart) {
  std::vector<std::vector<Pair>> parts(7);
  for (int e = 0; e < 24; ++e) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Pair pair = Follow(8.0, p == 2 ? 0.03 + 0.05 * e / 24.0 : 0.06);
      if (p == 1 && (e == 3 || e == 7 || e == 9 || e == 12)) {
        pair.angle = Scaled(pair.angle, 1.0, 17.0);
      }
      if (p == 3 && e == 7) std::fill_n(pair.angle.begin() + 60, 60, pair.angle[60]);
      if (p == 4) {
        for (double& value : pair.command) value = std::clamp(value, -100.0, 15.0);
      }
      if (p == 5) {
        for (Values* values : {&pair.command, &pair.angle}) {
          for (double& value : *values) value -= 360.0 * std::floor(value / 360.0);
        }
      }
      if (p == 6) pair.angle = Scaled(pair.angle, 0.5, 0.0);
      parts[p].push_back(std::move(pair));
    }
  }
  const Audit audit = AuditLog(Write(parts), {});
  std::vector<std::string> faults;
  for (const AuditedPart& part : audit.parts) {
    EXPECT_EQ(part.kind, "target") << part.name;
    faults.push_back(fmt::format("{}", fmt::join(KeysOf(part.faults), " ")));
  }
  EXPECT_THAT(faults, ElementsAre("", "offset", "delay_varies", "stands_still", "clipped", "wraps",
                                  "gain"));
  EXPECT_EQ(audit.parts[1].faults[0].text, "is 17.0 deg off in 4 of 24 episodes (3, 7, 9, 12)");
  EXPECT_THAT(audit.parts[2].faults[0].text, HasSubstr("drifts from"));
  EXPECT_THAT(audit.parts[2].faults[0].text, HasSubstr("over the data set"));
  EXPECT_THAT(audit.parts[3].faults[0].text, HasSubstr("up to 2.0 s"));
  EXPECT_THAT(audit.parts[3].faults[0].text, HasSubstr("in 1 of 24 episodes (7)"));
  EXPECT_THAT(audit.parts[4].faults[0].text, HasSubstr("clipped at 15 deg"));
  EXPECT_NEAR(audit.parts[6].gain.value, 0.5, 0.02);
  EXPECT_NEAR(audit.parts[1].offset, 0.0, 0.1);  // of most episodes
  EXPECT_NEAR(audit.parts[1].episodes[7].offset, 17.0, 0.1);
  EXPECT_TRUE(audit.faults.empty());
  const std::string text = TextOf(AuditText(audit, false), TerminalStyle());
  EXPECT_LE(std::ranges::count(text, '\n'), 25);
}

/// Episodes that are not as the others. Wrong: a mean over those that can be fitted.
TEST_F(AuditTest, NamesEpisodesThatAreNotAsTheOthers) {
  std::vector<std::vector<Pair>> parts(5);
  for (int e = 0; e < 20; ++e) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Pair pair = Follow(8.0);
      const bool is_odd = e == 4 || e == 9 || e == 17;
      if (is_odd && p == 0) pair.angle.assign(pair.angle.size(), 3.0);
      if (is_odd && p == 1) pair.angle = Scaled(pair.angle, -1.0, 0.0);
      if (is_odd && p == 2) pair.command.assign(pair.command.size(), 0.0);
      if (is_odd && p == 3) pair.angle = Later(pair.angle, 10);
      if (e == 9 && p == 4) pair.command = pair.angle;
      parts[p].push_back(std::move(pair));
    }
  }
  const Audit audit = AuditLog(Write(parts), {});
  const std::string three = " in 3 of 20 episodes (4, 9, 17)";
  const std::vector<std::string> wanted = {
      "does not move with its command" + three, "moves against its command" + three,
      "moves without its command" + three, "is ahead of its command" + three,
      "has copies of its angle as commands in 1 of 20 episodes (9)"};
  for (std::size_t p = 0; p < parts.size(); ++p) {
    EXPECT_EQ(audit.parts[p].kind, "target") << p;
    std::vector<std::string> texts;
    for (const AuditFault& fault : audit.parts[p].faults) texts.push_back(fault.text);
    EXPECT_THAT(texts, testing::Contains(wanted[p])) << p;
  }
  EXPECT_EQ(VerdictOf(audit).recommended, "fix");
}

TEST_F(AuditTest, NamesDeadSensorsAndWhatAllAnglesDo) {
  std::vector<Pair> dead = Episodes(4, 10.0), sound = Episodes(4, 10.0);
  for (Pair& pair : dead) pair.angle.assign(pair.angle.size(), 1.0);
  const Audit audit = AuditLog(Write({dead, sound}), {});
  EXPECT_EQ(audit.parts[0].kind, "angle_still");
  EXPECT_EQ(VerdictOf(audit).recommended, "fix");
  std::vector<Pair> one = Episodes(2, 20.0), other = Episodes(2, 20.0);
  for (auto* const part : {&one, &other}) {
    Values& angle = (*part)[1].angle;
    std::fill(angle.begin() + 300, angle.begin() + 400, angle[300]);
  }
  const Audit frozen = AuditLog(Write({one, other}), {});
  EXPECT_THAT(KeysOf(frozen.faults), ElementsAre("frozen"));
  EXPECT_THAT(VerdictOf(frozen).Text(),
              HasSubstr("Fix first: all angles stand still for 3.3 s from 10.0 s of episode 1"));
}

/// In one log without episodes, too.
TEST_F(AuditTest, SaysFromWhenOnALogChanges) {
  Pair slips = Follow(120.0), jumps = Follow(60.0, 0.03);
  for (std::size_t n = slips.angle.size() / 2; n < slips.angle.size(); ++n) slips.angle[n] += 12.0;
  const Pair later = Follow(60.0, 0.15);
  jumps.command.insert(jumps.command.end(), later.command.begin(), later.command.end());
  jumps.angle.insert(jumps.angle.end(), later.angle.begin(), later.angle.end());
  const Audit audit = AuditLog(Write({{slips}, {jumps}}), {});
  ASSERT_EQ(audit.parts[0].faults.size(), 1U);
  EXPECT_EQ(audit.parts[0].faults[0].text, "is 12.0 deg off from 60 to 120 s");
  // Values are of the stretch with the largest error, and say which that is.
  const AuditedEpisode& worst = audit.parts[0].episodes[0];
  EXPECT_NEAR(worst.offset, 12.0, 0.1);
  EXPECT_GE(worst.from_s, 59.0);
  EXPECT_NEAR(worst.to_s - worst.from_s, 10.0, 0.1);
  EXPECT_THAT(AuditJson(audit), HasSubstr("\"from_s\": "));
  ASSERT_EQ(audit.parts[1].faults.size(), 1U);
  EXPECT_THAT(audit.parts[1].faults[0].text, testing::MatchesRegex(".*jumps from .* ms at 60 s"));
}

/// Motions of few seconds are alike by chance.
TEST_F(AuditTest, AsksForMoreOfAShortLog) {
  int believed = 0;
  for (int i = 0; i < 40; ++i) {
    const Audit audit = AuditLog(Write({{{Follow(4.0).command, Follow(4.0).angle}}}), {});
    believed += audit.parts[0].kind == "unrelated" ? 0 : 1;
  }
  EXPECT_LE(believed, 8);
}

TEST_F(AuditTest, HasNoFaultInSoundData) {
  for (int repetition = 0; repetition < 10; ++repetition) {
    const Audit audit =
        AuditLog(Write({Episodes(6, 12.0), Episodes(6, 12.0, 0.15), Episodes(6, 12.0, 0.3)}), {});
    EXPECT_EQ(VerdictOf(audit).recommended, "fit") << VerdictOf(audit).Text();
  }
}

TEST_F(AuditTest, UsesShortEpisodesTogether) {
  const Audit audit = AuditLog(Write({Episodes(20, 2.0)}), {});
  EXPECT_EQ(audit.parts[0].kind, "target");
  EXPECT_EQ(audit.episodes.size(), 20U);
  const double whole = AuditLog(Write({Episodes(4, 60.0)}), {}).parts[0].delay_ms.value;
  EXPECT_NEAR(audit.parts[0].delay_ms.value, whole, 4.0);
}

/// The truth is the delay of very long logs of the same model, which the interval's log is no part
/// of. Wrong: an interval that does not see how the delay differs between motions.
TEST_F(AuditTest, IntervalsHoldTheDelayOfOtherLogs) {
  int inside = 0, all = 0;
  for (const auto& [dead_s, frequency_hz] : {std::pair(0.02, 8.0), {0.12, 3.0}, {0.3, 1.5}}) {
    for (const double noise : {0.02, 0.5}) {
      std::vector<Pair> longest = {Follow(900.0, dead_s, frequency_hz, 0.02)};
      const double truth = AuditLog(Write({longest}), {}).parts[0].delay_ms.value;
      for (const auto& [episodes, seconds] : {std::pair(1, 30.0), {6, 12.0}, {12, 3.0}}) {
        std::vector<std::vector<Pair>> parts(20);
        for (auto& part : parts) {
          for (int e = 0; e < episodes; ++e) {
            part.push_back(Follow(seconds, dead_s, frequency_hz, noise));
          }
        }
        for (const AuditedPart& part : AuditLog(Write(parts), {}).parts) {
          ++all;
          inside += part.delay_ms.low <= truth && truth <= part.delay_ms.high ? 1 : 0;
          EXPECT_LT(part.delay_ms.high - part.delay_ms.low, 0.5 * truth + 20.0);
        }
      }
    }
  }
  EXPECT_GE(inside, 0.93 * all) << inside << " of " << all;
}

TEST_F(AuditTest, SeesRowsOfTheWholeDataSet) {
  // Angles that are read at every third row.
  std::vector<Pair> held = Episodes(4, 12.0);
  for (Pair& pair : held) {
    for (std::size_t n = 0; n < pair.angle.size(); ++n) pair.angle[n] = pair.angle[n - n % 3];
  }
  const Audit audit = AuditLog(Write({held}), {});
  ASSERT_THAT(KeysOf(audit.faults), ElementsAre("state_is_held"));
  EXPECT_THAT(audit.faults[0].text, HasSubstr("every 3 rows only (10 Hz)"));
  EXPECT_THAT(audit.faults[0].text, HasSubstr("0 to 67 ms older"));
  // Rows that repeat the row before.
  std::vector<Pair> repeated = Episodes(4, 12.0);
  for (Pair& pair : repeated) {
    for (std::size_t n = 20; n < pair.angle.size(); n += 20) {
      pair.angle[n] = pair.angle[n - 1];
      pair.command[n] = pair.command[n - 1];
    }
  }
  EXPECT_THAT(KeysOf(AuditLog(Write({repeated}), {}).faults), ElementsAre("repeated_rows"));
}

/// Grippers in metres beside joints in degrees. Wrong: a floor of 1 deg for them, or no unit at
/// all.
TEST_F(AuditTest, JudgesEachPartInItsOwnUnit) {
  std::vector<Pair> wrist = Episodes(4, 12.0), grip = Episodes(4, 12.0);
  for (Pair& pair : grip) {
    pair.command = Scaled(pair.command, 5e-4, 0.04);
    pair.angle = Scaled(pair.angle, 5e-4, 0.046);
  }
  const std::filesystem::path file = Write({wrist, grip});
  const auto with_names = [&](const std::string& wrist_unit, const std::string& of_grip) {
    std::ifstream in(file);
    const std::filesystem::path named = folder_.path() / "named.csv";
    std::ofstream out(named);
    std::string line;
    std::getline(in, line);
    out << fmt::format("episode_index,t_s,wrist_command{0},{1},wrist{0},{2}\n", wrist_unit,
                       "gripper_command" + of_grip, "gripper" + of_grip);
    out << in.rdbuf();
    return named;
  };
  const Audit by_name = AuditLog(with_names("_deg", "_m"), {});
  EXPECT_EQ(by_name.unit, "deg");
  EXPECT_EQ(by_name.unit_note, "");
  EXPECT_EQ(by_name.parts[0].unit, "deg");
  EXPECT_EQ(by_name.parts[1].unit, "m");
  EXPECT_NEAR(by_name.parts[1].offset, 0.006, 1e-4);
  EXPECT_THAT(VerdictOf(by_name).Text(), HasSubstr("is 0.006 m off"));
  EXPECT_THAT(TextOf(AuditText(by_name, false), TerminalStyle()), HasSubstr("0.006 m"));
  EXPECT_THAT(AuditJson(by_name), HasSubstr("\"offset_m\": 0.00"));
  const Audit said = AuditLog(with_names("", ""), {.unit = "deg"});
  EXPECT_EQ(said.parts[0].unit, "deg");
  EXPECT_EQ(said.parts[1].unit, "units");
  EXPECT_THAT(KeysOf(said.parts[1].faults), ElementsAre("offset"));
}

/// Each once, with its count. Wrong: to hide rows, episodes or copies behind a missing value.
TEST_F(AuditTest, CountsWhatIsMissing) {
  std::vector<Pair> wrist = Episodes(4, 10.0), thumb = Episodes(4, 10.0);
  for (const std::size_t n : {20U, 21U, 90U}) wrist[1].angle[n] = thumb[2].command[n] = kNaN;
  wrist[3].angle[5] = kNaN;
  for (Values* const values :
       {&wrist[2].command, &wrist[2].angle, &thumb[2].command, &thumb[2].angle}) {
    values->resize(8);
  }
  const Audit audit = AuditLog(Write({wrist, thumb}), {});
  std::vector<std::string> texts;
  for (const AuditFault& fault : audit.faults) texts.push_back(fault.text);
  EXPECT_THAT(texts, ElementsAre("4 of 908 rows have no value of p0",
                                 "1 episode has fewer than 10 rows and is left out (2)"));
  const std::filesystem::path chunk = folder_.path() / "set" / "data" / "chunk-000";
  std::filesystem::create_directories(chunk);
  std::filesystem::create_directory(folder_.path() / "set" / "meta");
  std::filesystem::copy(SourceDir() + "/tests/recordings/parquet/snappy.parquet",
                        chunk / "file-000.parquet");
  const std::filesystem::path map = folder_.path() / "map.csv";
  std::ofstream(map) << "column,channel,joint,unit\n1,command,a,deg\n2,angle,a,deg\n"
                        "timestamp,time,,s\n";
  for (const auto& [info, text] :
       {std::pair("\"total_episodes\": 5",
                  "meta/info.json names 5 episodes, 3 are missing (2, 3, 4)"),
        {"\"total_episodes\": 2, \"total_frames\": 90",
         "meta/info.json names 90 rows, 30 are missing"}}) {
    std::ofstream(folder_.path() / "set" / "meta" / "info.json")
        << fmt::format("{{{}, \"features\": {{}}}}", info);
    const Audit set = AuditLog(folder_.path() / "set", {.map = map.string()});
    ASSERT_EQ(set.faults.size(), 1U);
    EXPECT_EQ(set.faults[0].text, text);
  }
  for (Pair& pair : wrist) pair.command = pair.angle;
  wrist[0].command[7] = kNaN;
  EXPECT_EQ(AuditLog(Write({wrist}), {}).parts[0].kind, "copy");
}

/// Commands and states of ROS, each with its own clock and order of joints.
TEST_F(AuditTest, PairsTwoTopics) {
  const Pair thumb = Follow(30.0, 0.06, 6.0, 0.1, 100.0),
             index = Follow(30.0, 0.1, 6.0, 0.1, 100.0);
  const std::filesystem::path file = folder_.path() / "bag.mcap";
  std::ofstream out(file, std::ios::binary);
  McapWriter mcap([&](std::string_view bytes) { out << bytes; });
  const std::string definition =
      "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
      "float64[] effort\n";
  const auto commands = mcap.AddTopic("/joint_commands", "sensor_msgs/msg/JointState", definition);
  const auto states = mcap.AddTopic("/joint_states", "sensor_msgs/msg/JointState", definition);
  const auto add = [&](std::uint16_t topic, std::int64_t ns, const std::vector<std::string>& names,
                       const std::vector<double>& values_deg) {
    std::vector<double> values_rad;
    for (const double value : values_deg) values_rad.push_back(value * kRadPerDeg);
    CdrWriter message;
    message.Time(ns);
    message.Text("");
    message.Texts(names);
    message.Numbers(values_rad);
    message.Numbers({});
    message.Numbers({});
    mcap.AddMessage(topic, ns, message.message());
  };
  constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
  for (std::size_t n = 0; n < thumb.command.size(); ++n) {
    const auto ns = kStart_ns + static_cast<std::int64_t>(n) * 10'000'000;
    if (n % 2 == 0) {  // at half the rate, 3 ms behind the states
      add(commands, ns + 3'000'000, {"index", "thumb"}, {index.command[n], thumb.command[n]});
    }
    add(states, ns, {"thumb", "index", "wrist"}, {thumb.angle[n], index.angle[n], 0.0});
  }
  mcap.Finish();
  out.close();
  const Audit audit = AuditLog(file, {});
  ASSERT_EQ(audit.parts.size(), 2U);
  EXPECT_EQ(audit.unit, "deg");
  EXPECT_THAT(audit.ignored, ElementsAre("wrist"));
  const double thumb_ms = AuditLog(Write({{thumb}}, 100.0), {}).parts[0].delay_ms.value;
  const double index_ms = AuditLog(Write({{index}}, 100.0), {}).parts[0].delay_ms.value;
  EXPECT_EQ(audit.parts[0].name, "thumb");
  EXPECT_NEAR(audit.parts[0].delay_ms.value, thumb_ms - 3.0, 1.0);
  EXPECT_NEAR(audit.parts[1].delay_ms.value, index_ms - 3.0, 1.0);
  const Audit given = AuditLog(file, {.command = "/joint_commands", .state = "/joint_states"});
  EXPECT_EQ(given.parts[0].delay_ms.value, audit.parts[0].delay_ms.value);
  EXPECT_THROW(AuditLog(file, {.command = "/joint_states"}), UserError);
  EXPECT_THROW(AuditLog(Write({{thumb}}, 100.0), {.command = "/a", .state = ""}), UserError);
}

/// A plan of several points says no command of each time. Wrong: to say so without a way out.
TEST_F(AuditTest, SaysWhatToRecordInPlaceOfTrajectories) {
  const std::filesystem::path file = folder_.path() / "bag.mcap";
  std::ofstream out(file, std::ios::binary);
  McapWriter mcap([&](std::string_view bytes) { out << bytes; });
  const auto commands = mcap.AddTopic(
      "/arm/joint_trajectory", "trajectory_msgs/msg/JointTrajectory",
      "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points\n");
  const auto states = mcap.AddTopic("/joint_states", "sensor_msgs/msg/JointState",
                                    "std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                                    "float64[] velocity\nfloat64[] effort\n");
  for (std::int64_t n = 0; n < 400; ++n) {
    const double angle = std::sin(0.05 * static_cast<double>(n));
    CdrWriter state;
    state.Time(n * 10'000'000);
    state.Text("");
    state.Texts({"wrist"});
    for (const std::vector<double>& values : {std::vector{angle}, {}, {}}) state.Numbers(values);
    mcap.AddMessage(states, n * 10'000'000, state.message());
    if (n % 10 != 0) continue;
    CdrWriter plan;
    plan.Time(n * 10'000'000);
    plan.Text("");
    plan.Texts({"wrist"});
    std::string bytes(plan.message());
    const auto put = [&](auto number) {
      while ((bytes.size() - 4) % sizeof number != 0) bytes += '\0';
      bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    put(std::uint32_t{2});  // points
    for (const double ahead : {0.0, 0.2}) {
      put(std::uint32_t{1});
      put(angle + ahead);
      for (int i = 0; i < 5; ++i) put(std::uint32_t{0});  // empty lists, and the time
    }
    mcap.AddMessage(commands, n * 10'000'000, bytes);
  }
  mcap.Finish();
  out.close();
  try {
    AuditLog(file, {.command = "/arm/joint_trajectory", .state = "/joint_states"});
    ADD_FAILURE();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is a plan: record"));
  }
}

}  // namespace
}  // namespace gauntlet::sim
