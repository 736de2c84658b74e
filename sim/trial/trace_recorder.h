#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {

/// Fills a trace tick by tick with signals of ForEachSignal(). Rows are collected in blocks of
/// consecutive ticks and then moved to the column-major signals: a write per column and tick would
/// touch one cache line each.
class TraceRecorder {
 public:
  static constexpr Eigen::Index kBlockTicks = 64;

  /// `trace` gets `ticks` rows of the columns that `names` has, of the signals that are named; of
  /// all if none is. Others have no columns. Errors: std::invalid_argument for one that is none.
  TraceRecorder(Trace& trace, Eigen::Index ticks, const TraceColumnNames& names,
                std::span<const std::string_view> signals = {});

  /// Takes the next row. True at the end of a block.
  bool Record(const HandLoop& loop);
  /// Cuts the trace behind the last row.
  void Finish();

 private:
  /// What to do for one signal; the block is in the closures.
  struct Column {
    std::function<void(const HandLoop&, Eigen::Index)> read;  // into a row of the block
    std::function<void(Eigen::Index, Eigen::Index)> move;     // first tick, ticks
    std::function<void(Eigen::Index)> cut;
  };

  void Flush();

  std::vector<Column> columns_;
  Eigen::Index recorded_ = 0;
  Eigen::Index flushed_ = 0;
};

}  // namespace gauntlet::sim
