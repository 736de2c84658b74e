// Time per sample of the filters and of the whole controller, beside copying the samples, 18
// two-state filters written the plain way, and one dense filter. See docs/evidence/benchmarks.md.

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/filter_registry.h"
#include "controller/model_predictive/model_predictive.h"
#include "controller/prediction/motion_path.h"
#include "controller/prediction/predictor.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

/// The paper's recording, 94,096 samples, so that copying it is what copying a recording costs; for
/// more channels as many samples as are the same amount of numbers.
int SampleCount(int channels) { return std::max(16, 94096 * 18 / std::max(channels, 18)); }
constexpr double kRateHz = 1000.0;

void CountSamples(benchmark::State& state, int samples) {
  state.SetItemsProcessed(state.iterations() * samples);
  state.counters["ns_per_sample"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * samples * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// The same copy from and to the first-level cache: the least that touching a sample can cost.
void CachedCopyBenchmark(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const int samples = 256;
  const TestSignal input = GloveCounts(samples, n);
  std::vector<double> output(static_cast<std::size_t>(n));
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      std::memcpy(output.data(), input.row(k).data(), output.size() * sizeof(double));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

/// The copy that every filter is held against: the same samples to the same place.
void CopyBenchmark(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n);
  TestSignal output = TestSignal::Zero(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      std::memcpy(output.row(k).data(), input.row(k).data(),
                  static_cast<std::size_t>(n) * sizeof(double));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

FilterConfig WithOneR(FilterConfig config) {
  // Any number of channels: one variance for all.
  std::visit(
      [](auto& settings) {
        if constexpr (requires { settings.noise.r; }) settings.noise.r = {15.0};
        if constexpr (requires { settings.r; }) settings.r = {15.0};
      },
      config.settings);
  return config;
}

void FilterBenchmark(benchmark::State& state, const FilterConfig& config) {
  const int n = static_cast<int>(state.range(0));
  const auto filter = MakeFilter(WithOneR(config), n, kRateHz);
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n);
  TestSignal output = TestSignal::Zero(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      filter->Step(RowOf(input, k), RowOf(output, k));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

/// `fitted` without weights does nothing, so it gets 40.
PredictionConfig WithWeights(PredictionConfig config, bool all_channels) {
  if (auto* fitted = std::get_if<FittedPredictionConfig>(&config.settings)) {
    fitted->order = 40;
    fitted->weights.assign(40, 0.025);
    fitted->tap_means = true;
    if (!all_channels) return config;
    fitted->position_weights.assign(18 * 18, 0.01);
    fitted->slope_weights.assign(18 * 18, 0.01);
  }
  return config;
}

/// On the angles of a moving hand.
void PredictionBenchmark(benchmark::State& state, const PredictionConfig& config) {
  constexpr int n = 18;
  const auto predictor = MakePredictor(config, n, kRateHz);
  if (predictor == nullptr) return state.SkipWithError("is none");
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n) / 500.0;
  TestSignal output = TestSignal::Zero(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      predictor->Step(RowOf(input, k), RowOf(output, k));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

/// What a plan is made for: the same, and in so many events besides.
void PathBenchmark(benchmark::State& state, const PredictionConfig& config) {
  constexpr int n = 18;
  MotionPath path(config, n, kRateHz, static_cast<int>(state.range(0)), 20.0);
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n) / 500.0;
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      path.Step(RowOf(input, k), RowOf(input, k));
      benchmark::DoNotOptimize(path.Row(0).data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

/// Long after the last motion, on zeros: states that only decay would be subnormal numbers.
void RestBenchmark(benchmark::State& state, const FilterConfig& config) {
  constexpr int n = 18;
  const auto filter = MakeFilter(WithOneR(config), n, kRateHz);
  const TestSignal input = GloveCounts(200, n);
  std::vector<double> output(n);
  for (int k = 0; k < 200; ++k) filter->Step(RowOf(input, k), output);
  const std::vector<double> zeros(n, 0.0);
  for (int k = 0; k < 150000; ++k) filter->Step(zeros, output);  // as the test of subnormals
  constexpr int kSamples = 1000;
  for (auto _ : state) {
    for (int k = 0; k < kSamples; ++k) {
      filter->Step(zeros, output);
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, kSamples);
}

#if defined(__x86_64__) && defined(__GNUC__)
/// The two-state filter of 18 channels by hand, for one processor: AVX2, fused multiply-add, one
/// division, the whole covariance at every step. What `kalman` is held against.
class HandKalman {
 public:
  static constexpr int kChannels = 18;

  HandKalman() {
    for (int i = 0; i < kLanes; ++i) p11_[i] = p22_[i] = 1.0;
  }
  __attribute__((target("avx2,fma"), noinline)) void Step(const double* z, double* output) {
    const __m256d q = _mm256_set1_pd(1.0);
    const __m256d r = _mm256_set1_pd(15.0);
    for (int i = 0; i < kLanes; i += 4) {
      const __m256d p12 = _mm256_load_pd(p12_ + i);
      const __m256d p22 = _mm256_load_pd(p22_ + i);
      const __m256d p12_prior = _mm256_add_pd(p12, p22);
      const __m256d p11_prior =
          _mm256_add_pd(_mm256_add_pd(_mm256_add_pd(_mm256_load_pd(p11_ + i), p12), p12_prior), q);
      const __m256d inverse = _mm256_div_pd(_mm256_set1_pd(1.0), _mm256_add_pd(p11_prior, r));
      const __m256d k1 = _mm256_mul_pd(p11_prior, inverse);
      const __m256d k2 = _mm256_mul_pd(p12_prior, inverse);
      const __m256d w = _mm256_load_pd(w_ + i);
      const __m256d x_prior = _mm256_add_pd(_mm256_load_pd(x_ + i), w);
      const bool whole = i + 4 <= kChannels;
      const __m256d measured =
          whole ? _mm256_loadu_pd(z + i) : _mm256_castpd128_pd256(_mm_loadu_pd(z + i));
      const __m256d innovation = _mm256_sub_pd(measured, x_prior);
      const __m256d x = _mm256_fmadd_pd(k1, innovation, x_prior);
      _mm256_store_pd(x_ + i, x);
      _mm256_store_pd(w_ + i, _mm256_fmadd_pd(k2, innovation, w));
      _mm256_store_pd(p11_ + i, _mm256_mul_pd(k1, r));
      _mm256_store_pd(p12_ + i, _mm256_mul_pd(k2, r));
      _mm256_store_pd(p22_ + i, _mm256_fnmadd_pd(k2, p12_prior, _mm256_add_pd(p22, q)));
      if (whole) {
        _mm256_storeu_pd(output + i, x);
      } else {
        _mm_storeu_pd(output + i, _mm256_castpd256_pd128(x));
      }
    }
  }

 private:
  static constexpr int kLanes = 20;  // whole vectors
  alignas(32) double x_[kLanes] = {}, w_[kLanes] = {};
  alignas(32) double p11_[kLanes], p12_[kLanes] = {}, p22_[kLanes];
};

/// Both on the same samples in the first-level cache.
template <class Step>
void CachedKalmanBenchmark(benchmark::State& state, Step step) {
  constexpr int kSamples = 64;
  const TestSignal input = GloveCounts(kSamples, HandKalman::kChannels);
  std::vector<double> output(HandKalman::kChannels);
  for (auto _ : state) {
    for (int k = 0; k < kSamples; ++k) {
      step(RowOf(input, k), std::span<double>(output));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, kSamples);
}

void RegisterCachedKalman() {
  for (const FilterConfig& config :
       {FilterConfig{KalmanConfig{}}, {KalmanAdaptiveConfig{}}, {FixedLagConfig{}}}) {
    const std::string name = std::string(KindName(config.settings)) + "_in_cache";
    benchmark::RegisterBenchmark(name.c_str(), [config](benchmark::State& state) {
      const auto filter = MakeFilter(WithOneR(config), HandKalman::kChannels, kRateHz);
      CachedKalmanBenchmark(state, [&](std::span<const double> input, std::span<double> output) {
        filter->Step(input, output);
      });
    });
  }
  benchmark::RegisterBenchmark("kalman_by_hand_in_cache", [](benchmark::State& state) {
    HandKalman filter;
    CachedKalmanBenchmark(state, [&](std::span<const double> input, std::span<double> output) {
      filter.Step(input.data(), output.data());
    });
  });
}
#else
void RegisterCachedKalman() {}
#endif

/// How one writes it with Eigen: a struct with Matrix2d, the equations as in the paper.
struct PlainKalman {
  Eigen::Matrix2d a = (Eigen::Matrix2d() << 1, 1, 0, 1).finished();
  Eigen::RowVector2d h = {1, 0};
  Eigen::Matrix2d q = Eigen::Matrix2d::Identity();
  double r = 15.0;
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  Eigen::Matrix2d p = Eigen::Matrix2d::Identity();

  double Step(double z) {
    const Eigen::Vector2d x_prior = a * x;
    const Eigen::Matrix2d p_prior = a * p * a.transpose() + q;
    const Eigen::Vector2d gain = p_prior * h.transpose() / ((h * p_prior * h.transpose())(0) + r);
    x = x_prior + gain * (z - h * x_prior);
    p = (Eigen::Matrix2d::Identity() - gain * h) * p_prior;
    return x[0];
  }
};

void PlainEigenBenchmark(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  std::vector<PlainKalman> filters(static_cast<std::size_t>(n));
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n);
  TestSignal output = TestSignal::Zero(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      for (int i = 0; i < n; ++i) output(k, i) = filters[i].Step(input(k, i));
      benchmark::DoNotOptimize(output.data());
      benchmark::ClobberMemory();
    }
  }
  CountSamples(state, samples);
}

/// The same with matrices of a size known only at run time, as in "any number of channels".
struct PlainDynamicKalman {
  Eigen::MatrixXd a, h, q, r, p;
  Eigen::VectorXd x;

  explicit PlainDynamicKalman(int n) {
    a = Eigen::MatrixXd::Identity(2 * n, 2 * n);
    a.topRightCorner(n, n).setIdentity();
    h = Eigen::MatrixXd::Identity(n, 2 * n);
    q = p = Eigen::MatrixXd::Identity(2 * n, 2 * n);
    r = 15.0 * Eigen::MatrixXd::Identity(n, n);
    x = Eigen::VectorXd::Zero(2 * n);
  }
  void Step(const Eigen::VectorXd& z) {
    x = a * x;
    p = a * p * a.transpose() + q;
    const Eigen::MatrixXd gain = p * h.transpose() * (h * p * h.transpose() + r).inverse();
    x += gain * (z - h * x);
    p = (Eigen::MatrixXd::Identity(x.size(), x.size()) - gain * h) * p;
  }
};

void PlainDenseBenchmark(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  PlainDynamicKalman filter(n);
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      filter.Step(input.row(k).transpose());
      benchmark::DoNotOptimize(filter.x.data());
    }
  }
  CountSamples(state, samples);
}

void ControllerBenchmark(benchmark::State& state, const ControllerConfig& config,
                         double event_period_ms) {
  constexpr int n = 18;
  Controller controller(config, PlainGlove(n), CoupledHand(n),
                        {.event_period_ms = event_period_ms});
  const int samples = SampleCount(n);
  const TestSignal input = GloveCounts(samples, n);
  for (auto _ : state) {
    for (int k = 0; k < samples; ++k) {
      const Command command = controller.Step({.counts = RowOf(input, k)});
      benchmark::DoNotOptimize(command.motor_counts.data());
    }
  }
  CountSamples(state, samples);
}

/// One event of 18 joints per iteration, towards goals that jump beyond what all limits allow. The
/// same 10,000 events come again and again: `worst_us` is the longest of them, each in the shortest
/// of its times, so that what else the machine did is left out.
void PlanBenchmark(benchmark::State& state) {
  constexpr int n = 18;
  ModelPredictiveConfig config;
  config.kind = ModelPredictiveKind::kSecondOrder;
  config.steps = static_cast<int>(state.range(0));
  config.speed_limit_deg_s = 200.0;
  config.lead_limit_deg = 16.6;
  ModelPredictive planner(config, CoupledHand(n), 50.0);
  const auto rows = static_cast<std::size_t>(planner.path_length());
  std::vector<std::vector<double>> paths;
  std::uint64_t random = 1;
  for (int i = 0; i < 1000; ++i) {
    std::vector<double>& path = paths.emplace_back();
    const double size = i % 10 < 5 ? 3.0 : 0.5;
    for (std::size_t k = 0; k < rows * n; ++k) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      path.push_back(size * (static_cast<double>(random >> 40) / (1 << 24) - 0.25));
    }
  }
  std::vector<double> command(n);
  std::vector<double> shortest_us(10'000, std::numeric_limits<double>::infinity());
  std::size_t event = 0;
  for (auto _ : state) {
    if (event == 0) planner.Reset(std::vector<double>(n, 0.7));
    const auto begin = std::chrono::steady_clock::now();
    planner.Step(paths[event % paths.size()], command);
    const std::chrono::duration<double, std::micro> taken =
        std::chrono::steady_clock::now() - begin;
    shortest_us[event] = std::min(shortest_us[event], taken.count());
    event = (event + 1) % shortest_us.size();
    benchmark::DoNotOptimize(command.data());
  }
  std::int64_t failed = 0;
  for (const std::int64_t of_joint : planner.failed_plans()) failed += of_joint;
  state.counters["worst_us"] = *std::max_element(shortest_us.begin(), shortest_us.end());
  state.counters["failed"] = static_cast<double>(failed);
}

void Register() {
  benchmark::RegisterBenchmark("memcpy", CopyBenchmark)->Arg(18);
  benchmark::RegisterBenchmark("memcpy_in_cache", CachedCopyBenchmark)->Arg(18);
  for (const FilterKind& kind : FilterKinds()) {
    benchmark::RegisterBenchmark(std::string(kind.name).c_str(), FilterBenchmark, kind.defaults)
        ->Arg(18);
  }
  benchmark::RegisterBenchmark("kalman_3_states", FilterBenchmark,
                               FilterConfig{KalmanConfig{.noise = {.r = {15.0}}, .states = 3}})
      ->Arg(18);
  for (const PredictionKind& kind : PredictionKinds()) {
    if (kind.name == "none" || kind.name == "fitted_to_others") continue;
    benchmark::RegisterBenchmark(("prediction/" + std::string(kind.name)).c_str(),
                                 PredictionBenchmark, WithWeights(kind.defaults, false));
  }
  benchmark::RegisterBenchmark("prediction/fitted/all_channels", PredictionBenchmark,
                               WithWeights({FittedPredictionConfig{}}, true));
  benchmark::RegisterBenchmark("prediction_path/adaptive", PathBenchmark,
                               PredictionConfig{AdaptivePredictionConfig{}})
      ->Arg(10);
  benchmark::RegisterBenchmark("eigen_2x2", PlainEigenBenchmark)->Arg(18);
  benchmark::RegisterBenchmark("eigen_dense_36", PlainDenseBenchmark)->Arg(18);

  ControllerConfig config;
  config.filters = {{KalmanConfig{}}};
  benchmark::RegisterBenchmark("controller_20ms_events", ControllerBenchmark, config, 20.0);
  benchmark::RegisterBenchmark("controller_1ms_events", ControllerBenchmark, config, 1.0);
  for (const FilterKind& kind : FilterKinds()) {
    ControllerConfig of_kind;
    of_kind.filters = {WithOneR(kind.defaults)};
    benchmark::RegisterBenchmark(("controller/" + std::string(kind.name)).c_str(),
                                 ControllerBenchmark, of_kind, 20.0);
  }
  config.filters.insert(config.filters.begin(), {HampelConfig{}});
  config.prediction = {KalmanPredictionConfig{}};
  benchmark::RegisterBenchmark("model_predictive_event", PlanBenchmark)
      ->Arg(6)
      ->Arg(16)
      ->Iterations(100'000);
  benchmark::RegisterBenchmark("controller_everything", ControllerBenchmark, config, 1.0);

  RegisterCachedKalman();

  for (const FilterKind& kind : FilterKinds()) {
    benchmark::RegisterBenchmark(("rest/" + std::string(kind.name)).c_str(), RestBenchmark,
                                 kind.defaults);
  }
  for (const FilterKind& kind : FilterKinds()) {
    if (kind.name == "kalman_dense") continue;  // its cost is cubic in the channels
    auto* scaling = benchmark::RegisterBenchmark(("channels/" + std::string(kind.name)).c_str(),
                                                 FilterBenchmark, kind.defaults);
    scaling->RangeMultiplier(4)->Range(16, 4096);
  }
}

}  // namespace
}  // namespace gauntlet::controller

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  gauntlet::controller::Register();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
