#include "sim/trial/trace_stream.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {
namespace {

constexpr std::uint64_t kLongestText = 10'000;
constexpr std::uint64_t kMostTexts = 10'000;
constexpr std::uint64_t kMostColumns = 10'000;
/// Values that are turned from rows to columns at a time: they stay in a core's cache.
constexpr Eigen::Index kBlockValues = 65'536;

template <class Value>
std::span<const char> BytesOf(const Value& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <class Value>
std::span<const char> BytesOf(std::span<const Value> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void CheckCount(const char* what, std::uint64_t count, std::uint64_t most) {
  if (count <= most) return;
  throw UserError(fmt::format("{} {}, must be at most {}", count, what, most));
}

}  // namespace

void TraceSender::Number(double number) { send_(BytesOf(number)); }

void TraceSender::Text(std::string_view text) {
  send_(BytesOf(std::uint64_t{text.size()}));
  send_(std::span(text));
}

void TraceSender::Texts(const std::vector<std::string>& texts) {
  send_(BytesOf(std::uint64_t{texts.size()}));
  for (const std::string& text : texts) Text(text);
}

void TraceSender::Size(std::uint64_t rows, std::uint64_t columns) {
  send_(BytesOf(rows));
  send_(BytesOf(columns));
}

void TraceSender::Values(std::span<const float> values) { send_(BytesOf(values)); }
void TraceSender::Values(std::span<const int> values) { send_(BytesOf(values)); }
void TraceSender::Values(std::span<const std::uint8_t> values) { send_(BytesOf(values)); }

void TraceReceiver::Spend(std::uint64_t count, std::uint64_t size) {
  if (count > budget_bytes_ / size) {
    throw UserError(
        "says that it has more signals than fit into its size (compressed ones are not read; "
        "h5repack -f NONE unpacks them)");
  }
  budget_bytes_ -= count * size;
}

template <class Value>
Value TraceReceiver::Take() {
  Value value = {};
  receive_({reinterpret_cast<char*>(&value), sizeof value});
  return value;
}

double TraceReceiver::Number() { return Take<double>(); }

std::string TraceReceiver::Text() {
  const auto size = Take<std::uint64_t>();
  CheckCount("bytes of text", size, kLongestText);
  Spend(size, 1);
  std::string text(size, '\0');
  receive_(text);
  return text;
}

std::vector<std::string> TraceReceiver::Texts() {
  const auto count = Take<std::uint64_t>();
  CheckCount("texts", count, kMostTexts);
  std::vector<std::string> texts;
  for (std::uint64_t i = 0; i < count; ++i) texts.push_back(Text());
  return texts;
}

template <class Scalar>
void TraceReceiver::Matrix(SignalOf<Scalar>& matrix) {
  using Sent = Stored<Scalar>;
  const auto row_count = Take<std::uint64_t>();
  const auto column_count = Take<std::uint64_t>();
  CheckCount("columns", column_count, kMostColumns);
  if (column_count > 0) Spend(row_count, column_count * sizeof(Sent));
  const Eigen::Index columns = column_count;
  const Eigen::Index rows = columns > 0 ? row_count : 0;
  matrix = SignalOf<Scalar>(rows, columns);
  Eigen::Matrix<Sent, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block;
  for (Eigen::Index row = 0; row < rows; row += block.rows()) {
    block.resize(std::min(std::max<Eigen::Index>(kBlockValues / columns, 1), rows - row), columns);
    receive_({reinterpret_cast<char*>(block.data()), block.size() * sizeof(Sent)});
    matrix.middleRows(row, block.rows()) = block.template cast<Scalar>();
    TrimSignals();
  }
}

template void TraceReceiver::Matrix(Signal&);
template void TraceReceiver::Matrix(IntegerSignal&);
template void TraceReceiver::Matrix(SignalOf<std::uint8_t>&);

}  // namespace gauntlet::sim
