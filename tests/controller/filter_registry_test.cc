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

/// Notes for which channels it was asked.
class NotingMaker final : public FilterMaker {
 public:
  std::unique_ptr<Filter> Make(const ExternalConfig&, std::span<const std::string> names,
                               double rate_hz) const override {
    seen.assign(names.begin(), names.end());
    return MakeFilter(NoFilterConfig{}, static_cast<int>(names.size()), rate_hz);
  }
  mutable std::vector<std::string> seen;
};

TEST(FilterRegistry, HasAProgramOnlyOfItsCaller) {
  EXPECT_EQ(AllFilterKinds().size(), FilterKinds().size() + 1);
  EXPECT_EQ(AllFilterKinds().back().name, "external");
  ExternalConfig config;
  config.command = "program";
  EXPECT_THAT(ProblemOf({config}, 2), HasSubstr("runs only in the simulator's trials"));
  const NotingMaker maker;
  config.make = &maker;
  const std::vector<std::string> names = {"thumb", "index", "little"};
  EXPECT_EQ(
      MakeFilter({.settings = config, .channels = {"little", "1"}}, names, 100.0)->channel_count(),
      3);
  EXPECT_THAT(maker.seen, testing::ElementsAre("little", "thumb"));
  FilterConfig with_list{.settings = config, .per_channel = {{"timeout_ms", {1.0, 2.0}}}};
  EXPECT_THAT(ProblemOf(with_list, 2), HasSubstr("timeout_ms: is a list, must be one value"));
}

/// The last of a few samples that count up from 0, channel i by i + 1 each.
std::vector<double> LastOf(Filter& filter) {
  std::vector<double> values(static_cast<std::size_t>(filter.channel_count()));
  for (int k = 0; k < 20; ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = k * (static_cast<double>(i) + 1.0);
    }
    filter.Step(values, values);
  }
  return values;
}

TEST(FilterRegistry, FiltersTheNamedChannelsOnly) {
  const std::vector<std::string> names = {"thumb", "index", "little"};
  const FilterConfig config{.settings = ExponentialConfig{.alpha = 0.25},
                            .channels = {"little", "1"}};
  const auto some = MakeFilter(config, names, 1000.0);
  const auto all = MakeFilter(ExponentialConfig{.alpha = 0.25}, 3, 1000.0);
  const std::vector<double> filtered = LastOf(*all);
  EXPECT_THAT(LastOf(*some), testing::ElementsAre(filtered[0], 38.0, filtered[2]));
  // A channel of the sample keeps its place in the filter's own order.
  some->ResetChannel(2);
  std::vector<double> values = {0.0, 0.0, 7.0};
  some->Step(values, values);
  EXPECT_EQ(values[2], 7.0);
  EXPECT_NE(values[0], 0.0);
}

TEST(FilterRegistry, TakesAListOfEveryNumber) {
  const FilterConfig config{.settings = ExponentialConfig{},
                            .channels = {"1", "3"},
                            .per_channel = {{"alpha", {1.0, 0.5}}}};
  const auto half = MakeFilter(ExponentialConfig{.alpha = 0.5}, 3, 1000.0);
  const std::vector<double> halved = LastOf(*half);
  EXPECT_THAT(LastOf(*MakeFilter(config, 3, 1000.0)), testing::ElementsAre(19.0, 38.0, halved[2]));
}

TEST(FilterRegistry, RefusesChannelsAndListsThatDoNotFit) {
  const auto problem = [](std::vector<std::string> channels, std::vector<ChannelValues> lists,
                          FilterSettings settings = MovingAverageConfig{}) {
    return ProblemOf({.settings = std::move(settings),
                      .channels = std::move(channels),
                      .per_channel = std::move(lists)},
                     3);
  };
  EXPECT_THAT(
      problem({"0"}, {}),
      HasSubstr("channels: has 0, must have numbers from 1 to 3 or names of channels (1, 2, 3)"));
  EXPECT_THAT(problem({"4"}, {}), HasSubstr("channels: has 4"));
  EXPECT_THAT(problem({"2", "2"}, {}), HasSubstr("channels: has 2 twice"));
  EXPECT_THAT(problem({}, {{"window", {3.0, 4.0}}}),
              HasSubstr("window: has 2 values, must have 1 for all channels or 3"));
  EXPECT_THAT(problem({}, {{"window", {}}}), HasSubstr("window: has 0 values"));
  EXPECT_THAT(problem({}, {{"window", {3.0, 4.0, 4.5}}}),
              HasSubstr("window: has 4.5, must have whole numbers"));
  EXPECT_THAT(problem({}, {{"window", {3.0, 4.0, 0.0}}}),
              HasSubstr("window: is 0, must be from 1"));
  EXPECT_THAT(problem({}, {{"alpha", {0.1, 0.2, 2.0}}}, ExponentialConfig{}),
              HasSubstr("alpha: is 2, must be"));
}

TEST(FilterRegistry, TakesTheMemoryOfAllPartsOrOfNone) {
  const auto make = [](double last_window) {
    return MakeFilter({.settings = MovingAverageConfig{},
                       .channels = {},
                       .per_channel = {{"window", {3.0, last_window}}}},
                      2, 1000.0);
  };
  const auto filter = make(4.0);
  const auto untouched = make(4.0);
  LastOf(*filter);
  LastOf(*untouched);
  const auto other = MakeFilter(
      {.settings = ExponentialConfig{}, .per_channel = {{"alpha", {0.1, 0.2}}}}, 2, 1000.0);
  EXPECT_FALSE(other->SwapMemory(*filter));
  EXPECT_EQ(LastOf(*filter), LastOf(*untouched));
}

}  // namespace
}  // namespace gauntlet::controller
