#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/trial/trace_file.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kBufferBytes = 1 << 20;

/// One column of the table: a name and how to print the value of a sample.
struct CsvColumn {
  std::string name;
  std::function<void(Eigen::Index, fmt::memory_buffer&)> print;
};

/// One per name; the matrix has a row for every `ticks_per_row` ticks, in between cells are empty.
template <class Matrix>
void AddColumns(std::string_view signal, const std::vector<std::string>& names,
                const Matrix& matrix, int ticks_per_row, std::vector<CsvColumn>& columns) {
  for (std::size_t c = 0; c < names.size(); ++c) {
    columns.push_back({fmt::format("{}.{}", signal, names[c]),
                       [&matrix, c, ticks_per_row](Eigen::Index tick, fmt::memory_buffer& out) {
                         if (tick % ticks_per_row != 0) return;
                         fmt::format_to(std::back_inserter(out), "{}",
                                        matrix(tick / ticks_per_row, static_cast<Eigen::Index>(c)));
                       }});
  }
}

}  // namespace

void WriteTraceCsv(const std::filesystem::path& target, const GloveSignal& glove,
                   const HandModel& hand, const Trace& trace) {
  const TraceColumnNames names(glove.channel_names, hand);
  std::vector<CsvColumn> columns;
  AddColumns("true_angle_rad", glove.channel_names, glove.true_angle_rad, 1, columns);
  AddColumns("counts", glove.channel_names, glove.counts, glove.ticks_per_sample, columns);
  ForEachSignal(trace, [&](const auto& signal, const auto& matrix) {
    if (matrix.cols() > 0) AddColumns(signal.name, names.Of(signal.columns), matrix, 1, columns);
  });

  OutputFile file(target);
  std::ofstream stream(file.temporary_path(), std::ios::binary);
  fmt::memory_buffer text;
  const auto write = [&] {
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
    TrimSignals();
  };
  const auto append = std::back_inserter(text);
  fmt::format_to(append, "t_s");
  for (const CsvColumn& column : columns) fmt::format_to(append, ",{}", column.name);
  for (Eigen::Index k = 0; k < trace.hand_angle_rad.rows(); ++k) {
    fmt::format_to(append, "\n{}", static_cast<double>(k) / glove.tick_rate_hz);
    for (const CsvColumn& column : columns) {
      text.push_back(',');
      column.print(k, text);
    }
    if (text.size() > kBufferBytes) write();
  }
  text.push_back('\n');
  write();
  stream.close();
  if (!stream) {
    throw RunError(fmt::format("{}: cannot write: {}", target.string(), std::strerror(errno)));
  }
  file.Commit();
}

}  // namespace gauntlet::sim
