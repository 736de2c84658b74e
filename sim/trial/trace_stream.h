#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Content of `trace.h5` on its way from the helper that reads it: numbers, texts and matrices one
/// after another, in an order that both sides know. A matrix is rows, columns, then its values row
/// by row, 32 bits each, or 8 of a flag.
class TraceSender {
 public:
  using Send = std::function<void(std::span<const char>)>;

  explicit TraceSender(Send send) : send_(std::move(send)) {}

  void Number(double number);
  void Text(std::string_view text);
  void Texts(const std::vector<std::string>& texts);
  /// Before the values.
  void Size(std::uint64_t rows, std::uint64_t columns);
  void Values(std::span<const float> values);
  void Values(std::span<const int> values);
  void Values(std::span<const std::uint8_t> values);

 private:
  Send send_;
};

/// The other end, which believes nothing: all that comes has to fit into `budget_bytes`, the size
/// of the file that it is said to come from. What does not is a UserError without a place, before
/// any memory is taken for it.
class TraceReceiver {
 public:
  /// Fills the bytes with the next that were sent, or throws.
  using Receive = std::function<void(std::span<char>)>;

  TraceReceiver(Receive receive, std::uintmax_t budget_bytes)
      : receive_(std::move(receive)), budget_bytes_(budget_bytes) {}

  double Number();
  std::string Text();
  std::vector<std::string> Texts();
  /// Values of type float, widened, int, or flags.
  template <class Scalar>
  void Matrix(SignalOf<Scalar>& matrix);

 private:
  template <class Value>
  Value Take();
  /// Takes `count` things of `size` bytes each from what the file can hold.
  void Spend(std::uint64_t count, std::uint64_t size);

  Receive receive_;
  std::uintmax_t budget_bytes_;
};

}  // namespace gauntlet::sim
