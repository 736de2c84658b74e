#include "tests/statistics/simulated_recordings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/score/statistics/blocks.h"
#include "sim/score/statistics/statistics.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 10.0;

using Series = std::vector<double>;

struct SquaredErrors {
  Series first;
  Series second;
};

double Rms(const Series& squares) {
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

class Recorder {
 public:
  explicit Recorder(const RecordingsShape& shape)
      : shape_(shape), random_(shape.seed, "simulated recordings") {}

  SquaredErrors Draw(std::size_t samples) {
    SquaredErrors drawn;
    const RecordedErrors kind = shape_.errors;
    const bool own = kind == RecordedErrors::kLevel || kind == RecordedErrors::kOwn;
    const Series x = Process(samples);
    const Series other = own ? Process(samples) : Series();
    for (std::size_t n = 0; n < samples; ++n) {
      double first = x[n] + 0.3 * Normal();
      double second = 0.8 * x[n] + 0.3 * Normal();
      if (own) {
        first = x[n];
        second = 0.9 * other[n];
      }
      const bool level = kind == RecordedErrors::kLevel;
      drawn.first.push_back(level ? 100.0 + 10.0 * x[n] : first * first);
      drawn.second.push_back(level ? 95.0 + 7.0 * other[n] : second * second);
    }
    return drawn;
  }

  /// True difference of the RMS errors: of Gaussian processes known, else of a long recording.
  double Truth() {
    switch (shape_.errors) {
      case RecordedErrors::kLevel:
        return 10.0 - std::sqrt(95.0);
      case RecordedErrors::kOwn:
        return 0.1;
      case RecordedErrors::kShared:
      case RecordedErrors::kOscillating:
        return std::sqrt(1.09) - std::sqrt(0.73);
      default:
        break;
    }
    double square = 0.0;
    const Series x = Process(4'000'000);
    for (const double value : x) square += value * value / static_cast<double>(x.size());
    return std::sqrt(square + 0.09) - std::sqrt(0.64 * square + 0.09);
  }

 private:
  double Normal() { return BoxMuller(random_).first; }

  Series Process(std::size_t samples) {
    if (shape_.errors == RecordedErrors::kMovements || shape_.errors == RecordedErrors::kRareFast) {
      return Movements(samples);
    }
    const double decay = std::exp(-1.0 / (kRate_hz * shape_.correlation_s));
    const double own = std::sqrt(1.0 - decay * decay);
    const bool turns = shape_.errors == RecordedErrors::kOscillating;
    const double angle = turns ? std::numbers::pi / kRate_hz : 0.0;  // period 2 s
    double real = Normal(), imaginary = Normal();
    Series values;
    for (std::size_t n = 0; n < samples; ++n) {
      values.push_back(real);
      const double next = std::cos(angle) * real - std::sin(angle) * imaginary;
      imaginary = decay * (std::sin(angle) * real + std::cos(angle) * imaginary);
      real = decay * next + own * Normal();
      if (turns) imaginary += own * Normal();
    }
    return values;
  }

  /// Speeds of minimum-jerk movements, which pass 0.3 to 1.5, and rests between them.
  Series Movements(std::size_t samples) {
    const bool rare = shape_.errors == RecordedErrors::kRareFast;
    Series values(samples, 0.0);
    double begin_s = -random_.Uniform(0.0, 10.0);
    while (begin_s * kRate_hz < static_cast<double>(samples)) {
      const double duration_s = random_.Uniform(0.4, 1.2);
      const double way = rare ? -std::log(random_.UniformAboveZero()) : random_.Uniform(0.3, 1.5);
      const int first = std::max(0, static_cast<int>(std::ceil(begin_s * kRate_hz)));
      const int end = std::min(static_cast<int>(samples),
                               static_cast<int>(std::ceil((begin_s + duration_s) * kRate_hz)));
      for (int n = first; n < end; ++n) {
        const double part = (n / kRate_hz - begin_s) / duration_s;
        values[static_cast<std::size_t>(n)] =
            30.0 * way / duration_s * part * part * (1.0 - part) * (1.0 - part);
      }
      begin_s += duration_s - shape_.correlation_s * std::log(random_.UniformAboveZero());
    }
    return values;
  }

  const RecordingsShape shape_;
  RandomStream random_;
};

/// Autocorrelation time of the paired difference: each squared error over 2 RMS, as it adds to the
/// RMS [s].
double CorrelationOf(const SquaredErrors& errors) {
  const double first = 2.0 * Rms(errors.first);
  const double second = 2.0 * Rms(errors.second);
  const auto bin = static_cast<std::size_t>(kRate_hz * kCorrelationBin_s);
  Series means;
  for (std::size_t n = 0; n + bin <= errors.first.size(); n += bin) {
    double sum = 0.0;
    for (std::size_t i = n; i < n + bin; ++i) {
      sum += errors.first[i] / first - errors.second[i] / second;
    }
    means.push_back(sum / static_cast<double>(bin));
  }
  return kCorrelationBin_s * AutocorrelationTime({&means, 1});
}

Series ValuesOf(const Series& squares, const BlockPlan& plan) {
  Series without;
  const auto place = [&](int block) {
    return static_cast<std::ptrdiff_t>(squares.size()) * block / plan.count;
  };
  for (int block = 0; block < plan.count; ++block) {
    Series rest(squares.begin(), squares.begin() + place(block));
    rest.insert(rest.end(), squares.begin() + place(block + 1), squares.end());
    without.push_back(Rms(rest));
  }
  return BlockValues(Rms(squares), without, plan.Widening());
}

}  // namespace

RecordingsOutcome SimulateRecordings(const RecordingsShape& shape) {
  Recorder recorder(shape);
  const double truth = recorder.Truth();
  RecordingsOutcome outcome;
  int with_intervals = 0;
  for (int i = 0; i < shape.recordings; ++i) {
    const SquaredErrors errors =
        recorder.Draw(static_cast<std::size_t>(shape.duration_s * kRate_hz));
    const double correlation_s = CorrelationOf(errors);
    outcome.correlation_s += correlation_s / shape.recordings;
    const BlockPlan plan = PlanBlocks(shape.duration_s, correlation_s);
    if (plan.count == 0) continue;
    ++with_intervals;
    outcome.blocks += plan.count;
    const MeanEstimate difference =
        EstimateDifference(ValuesOf(errors.first, plan), ValuesOf(errors.second, plan));
    const auto holds = [truth](const MeanInterval& interval) {
      return interval.low <= truth && truth <= interval.high;
    };
    outcome.coverage += holds(difference.IntervalAt(0.95));
    outcome.family_coverage += holds(difference.IntervalAt(1.0 - 0.05 / 45.0));
  }
  outcome.with_intervals = static_cast<double>(with_intervals) / shape.recordings;
  for (double* mean : {&outcome.coverage, &outcome.family_coverage, &outcome.blocks}) {
    *mean /= with_intervals;
  }
  return outcome;
}

}  // namespace gauntlet::sim
