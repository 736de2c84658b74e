#include "sim/base/optimise.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlopt.hpp>

namespace gauntlet::sim {
namespace {

constexpr double kViolationWeight = 10.0;
constexpr double kNoObjective = 1e6;  // worse than any that there is, and finite for the methods
constexpr double kFirstStep = 0.1;    // of the search around the best
constexpr double kClose = 1e-4;       // where it ends

class Search {
 public:
  explicit Search(const std::function<Measured(const std::vector<double>&)>& measure)
      : measure_(measure) {}

  /// Errors: what `measure` throws.
  void Run(nlopt::opt method, std::vector<double> start, int measurements) {
    if (measurements <= 0) return;
    method.set_lower_bounds(0.0);
    method.set_upper_bounds(1.0);
    method.set_maxeval(measurements);
    method.set_min_objective([](const std::vector<double>& place, std::vector<double>& /*gradient*/,
                                void* self) { return static_cast<Search*>(self)->MeritAt(place); },
                             this);
    try {
      double merit = 0.0;
      method.optimize(start, merit);
    } catch (const nlopt::roundoff_limited&) {  // as near as numbers allow
    } catch (const nlopt::forced_stop&) {
      std::rethrow_exception(error_);
    }
  }

  const std::vector<MeasuredPoint>& points() const { return points_; }
  double Merit(const Measured& measured) const {
    if (!std::isfinite(measured.objective)) return kNoObjective;
    return measured.objective / scale_ + kViolationWeight * measured.violation;
  }

 private:
  double MeritAt(const std::vector<double>& place) {
    try {
      points_.push_back({place, measure_(place)});
    } catch (...) {
      error_ = std::current_exception();
      throw nlopt::forced_stop();
    }
    const Measured& measured = points_.back().measured;
    if (scale_ == 0.0 && std::isfinite(measured.objective)) {
      scale_ = std::max(std::abs(measured.objective), 1e-12);
    }
    return Merit(measured);
  }

  const std::function<Measured(const std::vector<double>&)>& measure_;
  std::vector<MeasuredPoint> points_;
  std::exception_ptr error_;
  double scale_ = 0.0;
};

void Everywhere(Search& search, unsigned dimensions, int measurements) {
  search.Run(nlopt::opt(nlopt::GN_DIRECT_L, dimensions), std::vector<double>(dimensions, 0.5),
             measurements);
}

void Around(Search& search, const std::vector<double>& start, int measurements) {
  nlopt::opt around(nlopt::LN_SBPLX, static_cast<unsigned>(start.size()));
  around.set_initial_step(kFirstStep);
  around.set_xtol_abs(kClose);
  search.Run(around, start, measurements);
}

}  // namespace

std::vector<MeasuredPoint> LookEverywhere(
    int dimensions, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure) {
  Search search(measure);
  Everywhere(search, static_cast<unsigned>(dimensions), measurements);
  return search.points();
}

std::vector<MeasuredPoint> LookAround(
    const std::vector<double>& start, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure) {
  Search search(measure);
  Around(search, start, measurements);
  return search.points();
}

std::vector<MeasuredPoint> Minimise(
    int dimensions, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure) {
  Search search(measure);
  Everywhere(search, static_cast<unsigned>(dimensions), (measurements + 1) / 2);
  const MeasuredPoint best = *std::ranges::min_element(
      search.points(), {},
      [&search](const MeasuredPoint& point) { return search.Merit(point.measured); });
  Around(search, best.place, measurements - static_cast<int>(search.points().size()));
  return search.points();
}

const MeasuredPoint& BestOf(const std::vector<MeasuredPoint>& points) {
  const auto worse = [](const MeasuredPoint& a, const MeasuredPoint& b) {
    const auto rank = [](const Measured& m) {
      return std::isfinite(m.objective) ? m.violation : INFINITY;
    };
    const double first = rank(a.measured), second = rank(b.measured);
    return first != second ? first < second : a.measured.objective < b.measured.objective;
  };
  return *std::ranges::min_element(points, worse);
}

}  // namespace gauntlet::sim
