#include <fmt/format.h>

#include <cstdio>
#include <iterator>

#include "sim/base/atomic_file.h"
#include "sim/base/error.h"
#include "sim/trial/trace_file.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

/// One column of the table: a name and how to print the value of a sample.
struct CsvColumn {
  std::string name;
  std::function<void(Eigen::Index, fmt::memory_buffer&)> print;
};

template <class Matrix>
void AddColumns(const std::string& signal, const std::vector<std::string>& names,
                const Matrix& matrix, std::vector<CsvColumn>& columns) {
  for (std::size_t c = 0; c < names.size(); ++c) {
    columns.push_back({fmt::format("{}.{}", signal, names[c]),
                       [&matrix, c](Eigen::Index k, fmt::memory_buffer& out) {
                         fmt::format_to(std::back_inserter(out), "{}",
                                        matrix(k, static_cast<Eigen::Index>(c)));
                       }});
  }
}

}  // namespace

void WriteTraceCsv(const std::filesystem::path& target, const GloveSignal& glove,
                   const HandModel& hand, const Trace& trace) {
  const controller::TendonTransmission& transmission = hand.transmission();
  const TraceColumnNames names{transmission.channel_names, transmission.motor_names,
                               hand.cable_names()};
  std::vector<CsvColumn> columns;
  AddColumns("true_angle_rad", glove.channel_names, glove.true_angle_rad, columns);
  AddColumns("counts", glove.channel_names, glove.counts, columns);
  ForEachSignal(trace, [&](const char* name, const char*, TraceColumns kind, const auto& matrix) {
    if (matrix.cols() > 0) AddColumns(name, names.Of(kind), matrix, columns);
  });

  fmt::memory_buffer text;
  const auto append = std::back_inserter(text);
  fmt::format_to(append, "t_s");
  for (const CsvColumn& column : columns) fmt::format_to(append, ",{}", column.name);
  for (Eigen::Index k = 0; k < trace.hand_angle_rad.rows(); ++k) {
    fmt::format_to(append, "\n{}", static_cast<double>(k) / glove.rate_hz);
    for (const CsvColumn& column : columns) {
      text.push_back(',');
      column.print(k, text);
    }
  }
  text.push_back('\n');
  WriteFileAtomically(target, {text.data(), text.size()});
}

}  // namespace gauntlet::sim
