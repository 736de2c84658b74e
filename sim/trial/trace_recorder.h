#pragma once

#include <atomic>
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
  /// all if none is. Others have no columns. With several blocks another thread moves them, see
  /// MoveBlocks(). Errors: std::invalid_argument for one that is none.
  TraceRecorder(Trace& trace, Eigen::Index ticks, const TraceColumnNames& names,
                std::span<const std::string_view> signals = {}, int blocks = 1);

  /// Takes the next row. True at the end of a block. A row beyond the trace, or for which no block
  /// is free, is left out. It does not allocate, and with several blocks it touches only these.
  bool Record(const HandLoop& loop);
  /// For a thread of its own: moves the blocks that are full.
  void MoveBlocks();
  /// Cuts the trace behind the last row.
  void Finish();

  /// Rows that found no block free.
  Eigen::Index left_out() const { return left_out_; }

 private:
  /// Work for one signal; the block is in the closures.
  struct Column {
    std::function<void(const HandLoop&, Eigen::Index)> read;             // into a row of the blocks
    std::function<void(Eigen::Index, Eigen::Index, Eigen::Index)> move;  // row, first tick, ticks
    std::function<void(Eigen::Index)> cut;
  };

  void Move(Eigen::Index end);

  std::vector<Column> columns_;
  Eigen::Index rows_;    // of the trace
  Eigen::Index places_;  // rows of all blocks
  std::atomic<Eigen::Index> recorded_ = 0;
  std::atomic<Eigen::Index> moved_ = 0;
  Eigen::Index left_out_ = 0;
};

}  // namespace gauntlet::sim
