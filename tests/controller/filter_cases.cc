#include "tests/controller/filter_cases.h"

namespace gauntlet::controller {
namespace {

/// Leaves of settings with one value per channel only the value of one channel.
class ChannelPicker final : public SettingsVisitor {
 public:
  ChannelPicker(int channel, int channel_count)
      : channel_(static_cast<std::size_t>(channel)),
        channel_count_(static_cast<std::size_t>(channel_count)) {}

  void Number(const Setting&, double&) override {}
  void Integer(const Setting&, int&) override {}
  void Flag(const Setting&, bool&) override {}
  void Text(const Setting&, std::string&) override {}
  void Path(const Setting&, std::string&) override {}
  void Texts(const Setting&, std::vector<std::string>&) override {}
  void Choice(const Setting&, std::span<const std::string_view>, std::size_t&) override {}
  void Group(const Setting&, const std::function<void(SettingsVisitor&)>& visit) override {
    visit(*this);
  }
  void List(const Setting&, const SettingList&) override {}
  void Map(const Setting&, const SettingMap&) override {}
  void Numbers(const Setting&, std::vector<double>& value) override {
    if (value.size() == channel_count_) value = {value[channel_]};
  }

 private:
  std::size_t channel_;
  std::size_t channel_count_;
};

}  // namespace

std::vector<FilterCase> FilterCases() {
  std::vector<FilterCase> cases;
  for (const FilterKind& kind : FilterKinds()) {
    cases.push_back({std::string(kind.name), kind.defaults});
  }
  const auto add = [&cases](const char* name, FilterSettings settings) {
    cases.push_back({name, {std::move(settings)}});
  };
  add("moving_average_of_one", MovingAverageConfig{.window = 1});
  add("kalman_tuned", KalmanConfig{.noise = {.q = {1e-4}}});
  add("kalman_white_acceleration",
      KalmanConfig{.noise = {.q = {1e5}, .process_noise = ProcessNoise::kWhite}});
  add("kalman_three_states", KalmanConfig{.noise = {.q = {1e-6}}, .states = 3});
  return cases;
}

FilterConfig ForOneChannel(FilterConfig config, int channel, int channel_count) {
  ChannelPicker picker(channel, channel_count);
  config.Visit(picker);
  return config;
}

}  // namespace gauntlet::controller
