#include "sim/trial/trace_recorder.h"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

namespace gauntlet::sim {

TraceRecorder::TraceRecorder(Trace& trace, Eigen::Index ticks, const TraceColumnNames& names,
                             std::span<const std::string_view> signals, int blocks)
    : rows_(ticks), places_(kBlockTicks * blocks) {
  std::size_t found = 0;
  ForEachSignal(trace, [&]<class Scalar>(const TraceSignal<Scalar>& signal, auto& matrix) {
    const bool is_named = std::ranges::find(signals, signal.name) != signals.end();
    if (!signals.empty() && !is_named) return;
    found += is_named ? 1 : 0;
    const auto width = static_cast<Eigen::Index>(names.Of(signal.columns).size());
    matrix = std::remove_reference_t<decltype(matrix)>(ticks, width);  // each row is written or cut
    if (width == 0) return;
    using Block = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    // Zeros would be memory that the system gives later, to the thread that records.
    const auto block = std::make_shared<Block>(Block::Ones(width, places_));
    columns_.push_back(
        {.read =
             [block, read = signal.read](const HandLoop& loop, Eigen::Index row) {
               read(loop, {block->col(row).data(), static_cast<std::size_t>(block->rows())});
             },
         .move =
             [block, &matrix](Eigen::Index row, Eigen::Index first, Eigen::Index count) {
               matrix.middleRows(first, count) = block->middleCols(row, count)
                                                     .transpose()
                                                     .template cast<Stored<Scalar>>()
                                                     .template cast<Scalar>();
             },
         .cut = [&matrix](Eigen::Index rows) { matrix.KeepRows(rows); }});
  });
  if (found != signals.size()) {
    throw std::invalid_argument("TraceRecorder: a signal is named that is none, or twice");
  }
}

bool TraceRecorder::Record(const HandLoop& loop) {
  const Eigen::Index recorded = recorded_.load(std::memory_order_relaxed);
  if (recorded == rows_) return false;
  if (recorded - moved_.load(std::memory_order_acquire) == places_) {
    ++left_out_;
    return false;
  }
  for (const Column& column : columns_) column.read(loop, recorded % places_);
  recorded_.store(recorded + 1, std::memory_order_release);
  if ((recorded + 1) % kBlockTicks != 0) return false;
  if (places_ == kBlockTicks) MoveBlocks();
  return true;
}

void TraceRecorder::MoveBlocks() {
  const Eigen::Index recorded = recorded_.load(std::memory_order_acquire);
  Move(recorded - recorded % kBlockTicks);
}

void TraceRecorder::Move(Eigen::Index end) {
  Eigen::Index moved = moved_.load(std::memory_order_relaxed);
  while (moved < end) {
    const Eigen::Index count = std::min(kBlockTicks - moved % kBlockTicks, end - moved);
    for (const Column& column : columns_) column.move(moved % places_, moved, count);
    moved += count;
    moved_.store(moved, std::memory_order_release);
  }
  TrimSignals();
}

void TraceRecorder::Finish() {
  const Eigen::Index recorded = recorded_.load(std::memory_order_acquire);
  Move(recorded);
  for (const Column& column : columns_) column.cut(recorded);
}

}  // namespace gauntlet::sim
