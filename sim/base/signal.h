#pragma once

#include <Eigen/Core>
#include <iterator>
#include <new>
#include <utility>
#include <vector>

#include "controller/angle.h"
#include "controller/assert.h"
#include "controller/number.h"
#include "sim/base/signal_storage.h"

namespace gauntlet::sim {

/// A matrix whose values are on the disk if there are many: see SignalStorage. It derives from
/// Eigen::Map, so that it can be used in any expression like an Eigen::Matrix. As there, new values
/// are not initialised.
///
/// A long signal that is assigned from an expression is computed column by column.
template <class Scalar>
class SignalOf
    : public Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>, Eigen::Aligned16> {
 public:
  using Base = Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>, Eigen::Aligned16>;

  SignalOf() : Base(nullptr, 0, 0) {}
  SignalOf(Eigen::Index rows, Eigen::Index cols)
      : SignalOf(SignalStorage(static_cast<std::size_t>(rows * cols) * sizeof(Scalar)), rows,
                 cols) {}
  SignalOf(const SignalOf& other) : SignalOf(static_cast<const Base&>(other)) {}
  SignalOf(SignalOf&& other) noexcept : SignalOf() { *this = std::move(other); }
  template <class Derived>  // NOLINTNEXTLINE(google-explicit-constructor): as of Eigen::Matrix
  SignalOf(const Eigen::DenseBase<Derived>& values) : SignalOf(values.rows(), values.cols()) {
    const auto& matrix = values.derived().matrix();
    if (!storage_.is_on_disk()) {
      Base::operator=(matrix);
      return;
    }
    for (Eigen::Index c = 0; c < this->cols(); ++c) {
      this->col(c) = matrix.col(c);
      TrimSignals();
    }
  }
  ~SignalOf() = default;

  SignalOf& operator=(const SignalOf& other) { return *this = SignalOf(other); }
  SignalOf& operator=(SignalOf&& other) noexcept {
    storage_ = std::move(other.storage_);
    PointTo(other.rows(), other.cols());
    other.PointTo(0, 0);
    return *this;
  }
  template <class Derived>
  SignalOf& operator=(const Eigen::DenseBase<Derived>& values) {
    return *this = SignalOf(values);
  }

  using Base::setZero;
  void setZero(Eigen::Index rows, Eigen::Index cols) {  // NOLINT(readability-identifier-naming)
    *this = SignalOf(rows, cols);
    if (!storage_.is_on_disk()) setZero();  // on the disk all values are 0 from the start
  }
  /// Keeps the first rows.
  void KeepRows(Eigen::Index rows) {
    if (rows < this->rows()) *this = SignalOf(this->topRows(rows));
  }

  bool is_on_disk() const { return storage_.is_on_disk(); }

 private:
  SignalOf(SignalStorage storage, Eigen::Index rows, Eigen::Index cols)
      : Base(static_cast<Scalar*>(storage.data()), rows, cols), storage_(std::move(storage)) {}

  /// Eigen's documented way to let a map refer to other memory: placement new.
  void PointTo(Eigen::Index rows, Eigen::Index cols) {
    new (static_cast<Base*>(this)) Base(static_cast<Scalar*>(storage_.data()), rows, cols);
  }

  SignalStorage storage_;
};

/// Matrix of samples x channels, column-major: the values of one channel are contiguous.
using Signal = SignalOf<double>;
/// Matrix of integers, such as commands, likewise.
using IntegerSignal = SignalOf<int>;

/// Every `step`-th row, beginning with the first.
inline Signal EveryRow(const Signal& signal, Eigen::Index step) {
  GAUNTLET_ASSERT(step > 0);
  Signal result((signal.rows() + step - 1) / step, signal.cols());
  for (Eigen::Index c = 0; c < signal.cols(); ++c) {
    result.col(c) = signal.col(c)(Eigen::seqN(0, result.rows(), step));
    TrimSignals();
  }
  return result;
}

/// Some columns of a signal, in this order. No copy if these are all columns in their order.
template <class Matrix>
class Columns {
 public:
  Columns(const Matrix& whole, const std::vector<int>& columns)
      : whole_(whole), all_(std::ssize(columns) == whole.cols()) {
    if (!all_) part_ = whole(Eigen::all, columns);
  }
  const Matrix& operator*() const { return all_ ? whole_ : part_; }
  const Matrix* operator->() const { return &**this; }

 private:
  const Matrix& whole_;
  bool all_;
  Matrix part_;
};

/// Number of rows between two calls of TrimSignals() in a loop over rows.
inline constexpr Eigen::Index kTrimRows = 4096;

using controller::kDegPerRad;
using controller::kNaN;
using controller::kRadPerDeg;

}  // namespace gauntlet::sim
