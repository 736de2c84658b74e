#include "controller/filters/filter_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace gauntlet::controller {
namespace {

using testing::HasSubstr;

/// Chooses a kind, as a reader of files would, and writes down the keys.
class KindChooser final : public SettingsVisitor {
 public:
  explicit KindChooser(std::string_view kind) : kind_(kind) {}
  std::vector<std::string> keys;

  void Number(const Setting& setting, double&) override { Note(setting); }
  void Integer(const Setting& setting, int&) override { Note(setting); }
  void Flag(const Setting& setting, bool&) override { Note(setting); }
  void Text(const Setting& setting, std::string&) override { Note(setting); }
  void Path(const Setting& setting, std::string&) override { Note(setting); }
  void Numbers(const Setting& setting, std::vector<double>&) override { Note(setting); }
  void Texts(const Setting& setting, std::vector<std::string>&) override { Note(setting); }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Note(setting);
    if (setting.key != "kind") return;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == kind_) index = i;
    }
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>&) override {
    Note(setting);
  }
  void List(const Setting& setting, const SettingList&) override { Note(setting); }
  void Map(const Setting& setting, const SettingMap&) override { Note(setting); }

 private:
  void Note(const Setting& setting) {
    EXPECT_FALSE(setting.help.empty()) << setting.key;
    keys.emplace_back(setting.key);
  }
  std::string_view kind_;
};

TEST(FilterRegistry, GivesEveryKindOnceWithSummaryAndSettings) {
  std::set<std::string_view> names;
  for (const FilterKind& kind : FilterKinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_FALSE(kind.summary.empty()) << kind.name;
    EXPECT_EQ(kind.defaults.kind(), kind.name);
    EXPECT_EQ(MakeFilter(kind.defaults, 18, 1000.0)->channel_count(), 18) << kind.name;
  }
}

TEST(FilterRegistry, ReadsTheKindBeforeItsSettings) {
  FilterConfig config;
  KindChooser chooser("kalman");
  config.Visit(chooser);
  EXPECT_EQ(config.kind(), "kalman");
  ASSERT_GE(chooser.keys.size(), 4u);
  EXPECT_EQ(chooser.keys[0], "kind");
  EXPECT_THAT(chooser.keys, testing::IsSupersetOf({"start", "r", "q"}));
}

TEST(FilterRegistry, KeepsSettingsWhenTheKindStaysTheSame) {
  FilterConfig config{MovingAverageConfig{.window = 7}};
  KindChooser chooser("moving_average");
  config.Visit(chooser);
  EXPECT_EQ(std::get<MovingAverageConfig>(config.settings).window, 7);
}

std::string ProblemOf(const FilterConfig& config, int channels) {
  try {
    MakeFilter(config, channels, 1000.0);
  } catch (const SettingError& error) {
    return error.what();
  }
  return "";
}

TEST(FilterRegistry, SaysWhatIsWrongWithASetting) {
  EXPECT_THAT(ProblemOf({MovingAverageConfig{.window = 0}}, 18),
              HasSubstr("window: is 0, must be from 1"));
  EXPECT_THAT(ProblemOf({KalmanConfig{.noise = {.r = {0.0}}}}, 18), HasSubstr("r: is 0"));
  EXPECT_THAT(ProblemOf({KalmanConfig{.noise = {.r = {1.0, 2.0}}}}, 3),
              HasSubstr("r: has 2 values, must have 1 for all channels or 3"));
  EXPECT_THAT(ProblemOf({KalmanConfig{}}, 5), HasSubstr("the paper's for 18 channels"));
  EXPECT_THAT(ProblemOf({KalmanConfig{}}, 0), HasSubstr("channels"));
}

}  // namespace
}  // namespace gauntlet::controller
