#include "controller/linearisation/table_linearisation.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/angle.h"
#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

/// y over strictly growing x as a broken line that goes on beyond its ends.
double Interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
  const std::size_t i = above - x.begin();
  const double share = (at - x[i - 1]) / (x[i] - x[i - 1]);
  // From the nearer corner, so that corners are met exactly.
  return share <= 0.5 ? y[i - 1] + share * (y[i] - y[i - 1])
                      : y[i] - (1.0 - share) * (y[i] - y[i - 1]);
}

struct Table {
  std::vector<double> counts, angle_rad;                   // counts grow
  std::vector<double> angle_rad_growing, counts_by_angle;  // angles grow
};

Table MakeTable(const ChannelCurve& curve, std::size_t channel) {
  const auto fail = [channel](const char* problem) {
    throw SettingError("linearisation.channels[" + std::to_string(channel) + "]", problem);
  };
  const std::size_t n = curve.counts.size();
  if (n < 2 || curve.angle_deg.size() != n) {
    fail("counts and angle_deg must have the same number of values, at least 2");
  }
  Table table{.counts = curve.counts,
              .angle_rad = {},
              .angle_rad_growing = {},
              .counts_by_angle = curve.counts};
  for (const double angle : curve.angle_deg) {
    table.angle_rad.push_back(angle * kRadPerDeg);
  }
  const bool falling = table.angle_rad[1] < table.angle_rad[0];
  for (std::size_t i = 1; i < n; ++i) {
    if (!(table.counts[i] > table.counts[i - 1])) fail("counts must grow from corner to corner");
    const double change = table.angle_rad[i] - table.angle_rad[i - 1];
    if (!(falling ? change < 0.0 : change > 0.0)) fail("angle_deg must all grow or all fall");
  }
  table.angle_rad_growing = table.angle_rad;
  if (falling) {
    std::reverse(table.angle_rad_growing.begin(), table.angle_rad_growing.end());
    std::reverse(table.counts_by_angle.begin(), table.counts_by_angle.end());
  }
  return table;
}

class TableLinearisation final : public Linearisation {
 public:
  explicit TableLinearisation(const std::vector<ChannelCurve>& curves) {
    for (std::size_t i = 0; i < curves.size(); ++i) tables_.push_back(MakeTable(curves[i], i));
  }

  int channel_count() const noexcept override { return tables_.size(); }
  void ToAngles(std::span<const double> counts,
                std::span<double> angle_rad) const noexcept override {
    GAUNTLET_ASSERT(angle_rad.size() == counts.size() && std::ssize(counts) % channel_count() == 0);
    for (std::size_t at = 0; at < counts.size(); ++at) {
      const Table& table = tables_[at % tables_.size()];
      angle_rad[at] = Interpolate(table.counts, table.angle_rad, counts[at]);
    }
  }
  void ToCounts(std::span<const double> angle_rad,
                std::span<double> counts) const noexcept override {
    GAUNTLET_ASSERT(counts.size() == angle_rad.size() && std::ssize(counts) % channel_count() == 0);
    for (std::size_t at = 0; at < angle_rad.size(); ++at) {
      const Table& table = tables_[at % tables_.size()];
      counts[at] = Interpolate(table.angle_rad_growing, table.counts_by_angle, angle_rad[at]);
    }
  }

 private:
  std::vector<Table> tables_;
};

}  // namespace

std::unique_ptr<Linearisation> MakeTableLinearisation(const std::vector<ChannelCurve>& curves) {
  return std::make_unique<TableLinearisation>(curves);
}

}  // namespace gauntlet::controller
