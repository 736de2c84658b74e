#include "sim/show/pages/cell_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/answers/sweep/sweep_result.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostAxesOfHeat = 4;  // six pairs
constexpr int kBins = 12;

}  // namespace

HeatSide::HeatSide(const ChartAxis& of) : axis(of), labels(of.labels) {
  for (int bin = 0; labels.size() < kBins && of.labels.empty(); ++bin) {
    const double place = (bin + 0.5) / kBins;
    labels.push_back(fmt::format("{:.3g}", of.log ? of.low * std::pow(of.high / of.low, place)
                                                  : of.low + place * (of.high - of.low)));
  }
}

std::optional<std::size_t> HeatSide::ColumnOf(const std::string& value) const {
  const double place = axis.PlaceOf(value);
  if (std::isnan(place)) return std::nullopt;
  if (!axis.labels.empty()) {
    return static_cast<std::size_t>(std::ranges::find(labels, value) - labels.begin());
  }
  return std::min(static_cast<std::size_t>(place * kBins), labels.size() - 1);
}

CellPoints::CellPoints(std::vector<ChartAxis> axes, std::vector<std::size_t> metrics,
                       std::size_t best_by, std::int64_t all)
    : axes_(std::move(axes)),
      metrics_(std::move(metrics)),
      best_by_(best_by),
      every_(std::max<std::int64_t>(1, (2 * all + kPagePoints - 1) / kPagePoints)) {
  if (all <= kPagePoints) every_ = 1;
  const std::size_t sides = std::min(axes_.size(), kMostAxesOfHeat);
  for (std::size_t x = 0; x < sides; ++x) {
    for (std::size_t y = x + 1; y < sides; ++y) pairs_.push_back({x, y, {}});
  }
  for (const ChartAxis& axis : axes_) sides_.emplace_back(axis);
}

std::vector<HeatMap> CellPoints::HeatMaps() const {
  std::vector<HeatMap> maps;
  for (const Pair& pair : pairs_) {
    if (pair.best.empty()) continue;
    HeatMap& map = maps.emplace_back();
    map.x = pair.x;
    map.y = pair.y;
    map.x_name = axes_[pair.x].name;
    map.y_name = axes_[pair.y].name;
    map.score = std::string(Metrics()[best_by_].key);
    map.x_labels = sides_[pair.x].labels;
    map.y_labels = sides_[pair.y].labels;
    map.lower_is_better = Metrics()[best_by_].lower_is_better;
    for (const Best& best : pair.best) {
      const bool is_there = std::isfinite(best.rank);
      map.best.push_back(is_there ? (map.lower_is_better ? best.rank : -best.rank) : kNaN);
      const auto found = std::ranges::find(kept_, best.number, &Kept::number);
      map.points.push_back(found == kept_.end() ? kNoPoint
                                                : static_cast<std::size_t>(found - kept_.begin()));
    }
  }
  return maps;
}

double CellPoints::RankOf(const CellPoint& point) const {
  const double score = point.scores[PlaceOfMetric(metrics_, best_by_)];
  if (std::isnan(score)) return std::numeric_limits<double>::infinity();
  return Metrics()[best_by_].lower_is_better ? score : -score;
}

void CellPoints::AddToHeatMaps(const CellPoint& point, const Order& order) {
  const auto& [no_answer, breaks_bounds, rank, number] = order;
  if (breaks_bounds || !std::isfinite(rank)) return;
  for (Pair& pair : pairs_) {
    const auto x = sides_[pair.x].ColumnOf(point.values[pair.x]);
    const auto y = sides_[pair.y].ColumnOf(point.values[pair.y]);
    if (!x || !y) continue;
    pair.best.resize(sides_[pair.x].labels.size() * sides_[pair.y].labels.size());
    Best& best = pair.best[*y * sides_[pair.x].labels.size() + *x];
    if (rank < best.rank) best = {rank, number};
  }
}

void CellPoints::DropSome() {
  std::ranges::sort(kept_, {}, &Kept::order);
  if (std::ssize(kept_) <= kPagePoints && every_ == 1) return;
  const std::size_t good = std::min<std::size_t>(kept_.size(), kPagePoints / 2);
  std::vector<Kept> left;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (i < good || kept_[i].is_sample) left.push_back(std::move(kept_[i]));
  }
  kept_ = std::move(left);
  worst_good_ = kept_[good - 1].order;
}

}  // namespace gauntlet::sim
