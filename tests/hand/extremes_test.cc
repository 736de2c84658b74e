// Whatever a person sets: refused with a reason, or a hand that moves on. All pairs of the ends of
// the ranges of hand.servo.* and hand.cable.*.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <optional>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

/// Puts one setting, the n-th, to the lower or the upper end of its range.
class EndOfRange : public controller::SettingsVisitor {
 public:
  EndOfRange(int setting, bool upper) : setting_(setting), upper_(upper) {}
  int seen() const { return seen_; }
  const std::string& text() const { return text_; }

  void Number(const controller::Setting& setting, double& value) override {
    if (seen_++ == setting_) Put(setting, value = upper_ ? setting.max : setting.min);
  }
  void Integer(const controller::Setting& setting, int& value) override {
    if (seen_++ != setting_) return;
    value = static_cast<int>(upper_ ? setting.max : setting.min);
    Put(setting, value);
  }
  void Flag(const controller::Setting& setting, bool& value) override {
    if (seen_++ == setting_) Put(setting, value = upper_);
  }
  void Choice(const controller::Setting&, std::span<const std::string_view>,
              std::size_t&) override {}
  void Text(const controller::Setting&, std::string&) override {}
  void Path(const controller::Setting&, std::string&) override {}
  void Numbers(const controller::Setting&, std::vector<double>&) override {}
  void Texts(const controller::Setting&, std::vector<std::string>&) override {}
  void Group(const controller::Setting&,
             const std::function<void(controller::SettingsVisitor&)>&) override {}
  void List(const controller::Setting&, const controller::SettingList&) override {}
  void Map(const controller::Setting&, const controller::SettingMap&) override {}

 private:
  void Put(const controller::Setting& setting, double value) {
    text_ = fmt::format("{}={} ", setting.key, value);
  }
  int setting_;
  bool upper_;
  int seen_ = 0;
  std::string text_;
};

/// Servos' settings first, those of all motors alike, then the cables'; gives what was set.
std::string PutToEnd(HandConfig& config, int setting, bool upper) {
  EndOfRange end(setting, upper);
  config.servo.Visit(end);
  config.cable.Visit(end);
  EndOfRange again(setting, upper);
  config.arm_servo.Visit(again);
  return end.text();
}

int CountSettings() {
  HandConfig config;
  EndOfRange none(-1, false);
  config.servo.Visit(none);
  config.cable.Visit(none);
  return none.seen();
}

/// What is wrong with a hand of these settings; empty if it is refused with a reason, or goes on.
std::string Problem(const HandConfig& config, int& refused) {
  std::optional<Hand> hand;
  std::string reason;
  try {
    hand.emplace(MakeModel(config));
  } catch (const UserError& error) {
    reason = error.what();
  } catch (const controller::SettingError& error) {
    reason = error.what();
  }
  if (!hand) {
    ++refused;
    const bool named =
        reason.find("servo") != std::string::npos || reason.find("cable") != std::string::npos;
    return named ? "" : "refused as: " + reason;
  }
  const controller::TendonTransmission& map = hand->hand_model().transmission();
  RandomStream random(11, "extremes");
  for (int sample = 0; sample < 120; ++sample) {
    if (sample % 40 == 0) hand->SetCommand(CountsFor(map, RandomPosture(map, random)));
    hand->Step();
  }
  if (!hand->health().ok) return hand->health().problem;
  for (double angle_rad : JointAngles(*hand)) {
    if (!(std::abs(angle_rad) < 10.0)) return "a joint has gone round";
  }
  return "";
}

class ExtremesOfTheHand : public ::testing::TestWithParam<int> {};

TEST_P(ExtremesOfTheHand, AreRefusedWithAReasonOrMoveOn) {
  const int settings = CountSettings();
  int refused = 0;
  int tried = 0;
  for (int first = GetParam(); first < settings; first += 4) {
    for (int second = first + 1; second < settings; ++second) {
      for (int ends = 0; ends < 4; ++ends) {
        HandConfig config;
        const std::string set =
            PutToEnd(config, first, (ends & 1) != 0) + PutToEnd(config, second, (ends & 2) != 0);
        EXPECT_EQ(Problem(config, refused), "") << set;
        ++tried;
      }
    }
  }
  EXPECT_LT(refused, tried / 2);
}
INSTANTIATE_TEST_SUITE_P(Quarters, ExtremesOfTheHand, ::testing::Range(0, 4));

TEST(HandSettings, FourAtOnceThatOnceDiverged) {
  for (double pretension_mm : {0.6, 5.0}) {
    HandConfig config;
    config.cable.stiffness_scale = 9.99;
    config.cable.capstan_friction = 0.5;
    config.cable.pretension_mm = pretension_mm;
    config.servo.numbers().damping_ms = 0.0;
    int refused = 0;
    EXPECT_EQ(Problem(config, refused), "");
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
