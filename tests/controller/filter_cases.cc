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
  add("kalman_acceleration_input", KalmanConfig{.noise = {.q = {1e-4}}, .acceleration_window = 41});
  add("kalman_steady_three_states", KalmanSteadyConfig{.noise = {.q = {1e-6}}, .states = 3});
  add("kalman_adaptive_white",
      KalmanAdaptiveConfig{.noise = {.q = {1e5}, .process_noise = ProcessNoise::kWhite}});
  add("kalman_dense_tuned", KalmanDenseConfig{.q = {1e-4}});
  add("fixed_lag_tuned", FixedLagConfig{.noise = {.q = {1e-4}}, .lag = 25});
  add("fixed_lag_of_none", FixedLagConfig{.lag = 0});
  add("median_of_an_even_count", MedianConfig{.window = 8});
  add("hampel_of_an_even_count", HampelConfig{.window = 6});
  add("hampel_of_one", HampelConfig{.window = 1});
  for (int order = 1; order <= 8; ++order) {
    add(("butterworth_" + std::to_string(order)).c_str(), ButterworthConfig{.order = order});
  }
  add("savitzky_golay_cubic", SavitzkyGolayConfig{.window = 40, .order = 3});
  add("one_euro_tuned", OneEuroConfig{.beta = 0.01});
  add("one_euro_from_raw",
      OneEuroConfig{.beta = 0.01, .speed_from = OneEuroConfig::SpeedFrom::kRaw});
  add("jerk_limit_slow",
      JerkLimitConfig{
          .max_velocity_per_s = 3e3, .max_acceleration_per_s2 = 5e4, .max_jerk_per_s3 = 2e6});
  const auto add_by_channel = [&cases](const char* name, FilterSettings settings, const char* key,
                                       double first, double step) {
    std::vector<double> values;
    for (int i = 0; i < 18; ++i) values.push_back(first + step * i);
    cases.push_back({name, {std::move(settings), {}, {{key, std::move(values)}}}});
  };
  add_by_channel("exponential_by_channel", ExponentialConfig{}, "alpha", 0.05, 0.03);
  add_by_channel("moving_average_by_channel", MovingAverageConfig{}, "window", 1.0, 3.0);
  add_by_channel("one_euro_by_channel", OneEuroConfig{}, "min_cutoff_hz", 0.5, 0.5);
  add_by_channel("kalman_by_channel", KalmanConfig{.noise = {.q = {1e-4}}}, "acceleration_window",
                 3.0, 2.0);
  return cases;
}

FilterConfig ForOneChannel(FilterConfig config, int channel, int channel_count) {
  ChannelPicker picker(channel, channel_count);
  config.Visit(picker);
  return config;
}

}  // namespace gauntlet::controller
