#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "sim/show/pages/cells_chart.h"

namespace gauntlet::sim {

/// How many points the pictures of a page have at most. A page of that many stays below 3 MB.
inline constexpr std::int64_t kPagePoints = 2000;

/// One setting of one controller with its scores: a line, a point, a place in heat maps.
struct CellPoint {
  std::string name;
  std::vector<std::string> values;  // of the axes
  std::vector<double> scores;       // of the page's metrics
  bool is_answer = false;           // of the verdict: it comes first
  bool keeps_bounds = true;
  std::string yaml;
  std::string command;
};

/// A side of heat maps: what a value's column is.
struct HeatSide {
  ChartAxis axis;
  std::vector<std::string> labels;

  explicit HeatSide(const ChartAxis& of);
  std::optional<std::size_t> ColumnOf(const std::string& value) const;
};

/// Takes the points of a study one by one, and keeps what a page shows of them: of more than
/// kPagePoints the best half of that many, and of the others one in equal steps. Heat maps are of
/// all.
class CellPoints {
 public:
  /// `all`: how many points will come, about.
  CellPoints(std::vector<ChartAxis> axes, std::vector<std::size_t> metrics, std::size_t best_by,
             std::int64_t all);

  /// `point` is asked for its texts only if it is kept.
  template <class Texts>
  void Add(CellPoint point, const Texts& texts) {
    const std::int64_t number = seen_++;
    const Order order{!point.is_answer, !point.keeps_bounds, RankOf(point), number};
    AddToHeatMaps(point, order);
    const bool is_sample = number % every_ == 0;
    const bool is_good = kept_.size() < kPagePoints / 2 || order < worst_good_;
    if (!is_sample && !is_good) return;
    texts(point);
    kept_.push_back({order, number, is_sample, std::move(point)});
    if (std::ssize(kept_) > 2 * kPagePoints) DropSome();
  }

  void Finish() { DropSome(); }

  /// The answer first, then what keeps all bounds, then by the score.
  using Order = std::tuple<bool, bool, double, std::int64_t>;
  struct Kept {
    Order order;
    std::int64_t number;
    bool is_sample;
    CellPoint point;
  };
  const std::vector<Kept>& kept() const { return kept_; }
  std::int64_t seen() const { return seen_; }
  const std::vector<ChartAxis>& axes() const { return axes_; }
  const std::vector<std::size_t>& metrics() const { return metrics_; }
  std::size_t best_by() const { return best_by_; }

  std::vector<HeatMap> HeatMaps() const;

 private:
  struct Best {
    double rank = std::numeric_limits<double>::infinity();
    std::int64_t number = -1;
  };
  struct Pair {
    std::size_t x, y;
    std::vector<Best> best;
  };

  /// The lower the better.
  double RankOf(const CellPoint& point) const;
  void AddToHeatMaps(const CellPoint& point, const Order& order);
  /// Sorts; of too many points keeps the samples and the best.
  void DropSome();

  std::vector<ChartAxis> axes_;
  std::vector<std::size_t> metrics_;
  std::size_t best_by_;
  std::int64_t every_;
  std::int64_t seen_ = 0;
  Order worst_good_{true, true, std::numeric_limits<double>::infinity(), 0};
  std::vector<HeatSide> sides_;
  std::vector<Pair> pairs_;
  std::vector<Kept> kept_;
};

}  // namespace gauntlet::sim
