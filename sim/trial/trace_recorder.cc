#include "sim/trial/trace_recorder.h"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

namespace gauntlet::sim {

TraceRecorder::TraceRecorder(Trace& trace, Eigen::Index ticks, const TraceColumnNames& names,
                             std::span<const std::string_view> signals) {
  std::size_t found = 0;
  ForEachSignal(trace, [&]<class Scalar>(const TraceSignal<Scalar>& signal, auto& matrix) {
    const bool is_named = std::ranges::find(signals, signal.name) != signals.end();
    if (!signals.empty() && !is_named) return;
    found += is_named ? 1 : 0;
    const auto width = static_cast<Eigen::Index>(names.Of(signal.columns).size());
    matrix = std::remove_reference_t<decltype(matrix)>(ticks, width);  // each row is written or cut
    if (width == 0) return;
    using Block = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    const auto block = std::make_shared<Block>(Block::Zero(width, kBlockTicks));
    columns_.push_back(
        {.read =
             [block, read = signal.read](const HandLoop& loop, Eigen::Index row) {
               read(loop, {block->col(row).data(), static_cast<std::size_t>(block->rows())});
             },
         .move =
             [block, &matrix](Eigen::Index first, Eigen::Index count) {
               matrix.middleRows(first, count) = block->leftCols(count)
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
  const Eigen::Index row = recorded_ - flushed_;
  for (const Column& column : columns_) column.read(loop, row);
  if (++recorded_ - flushed_ < kBlockTicks) return false;
  Flush();
  return true;
}

void TraceRecorder::Flush() {
  for (const Column& column : columns_) column.move(flushed_, recorded_ - flushed_);
  flushed_ = recorded_;
  TrimSignals();
}

void TraceRecorder::Finish() {
  Flush();
  for (const Column& column : columns_) column.cut(recorded_);
}

}  // namespace gauntlet::sim
