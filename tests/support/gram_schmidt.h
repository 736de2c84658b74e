#pragma once

#include <cmath>
#include <optional>

namespace gauntlet::test {

/// The x for which the rows of a x are nearest to b (Eigen's matrices), by Gram and Schmidt;
/// nothing where a column of a depends on those before it. A decomposition of Eigen's takes seconds
/// to compile, in every test that has one.
template <class Matrix>
std::optional<Matrix> SolveByGramSchmidt(Matrix a, Matrix b) {
  using std::sqrt;
  const auto rows = a.rows(), columns = a.cols(), sides = b.cols();
  const auto dot = [rows](const Matrix& left, auto i, const Matrix& right, auto j) {
    auto sum = 0 * left(0, 0);
    for (decltype(a.rows()) k = 0; k < rows; ++k) sum += left(k, i) * right(k, j);
    return sum;
  };
  // Makes the columns of a orthonormal; a = (them) r, and c is what of b lies along them.
  Matrix r(columns, columns), c(columns, sides);
  for (decltype(a.rows()) i = 0; i < columns; ++i) {
    auto before = dot(a, i, a, i);
    for (decltype(i) j = 0; j < i; ++j) before += r(j, i) * r(j, i);
    r(i, i) = sqrt(dot(a, i, a, i));
    if (!(r(i, i) > 1e-14 * sqrt(before))) return std::nullopt;
    for (decltype(i) k = 0; k < rows; ++k) a(k, i) /= r(i, i);
    for (decltype(i) j = i + 1; j < columns; ++j) {
      r(i, j) = dot(a, i, a, j);
      for (decltype(i) k = 0; k < rows; ++k) a(k, j) -= r(i, j) * a(k, i);
    }
    for (decltype(i) j = 0; j < sides; ++j) {
      c(i, j) = dot(a, i, b, j);
      for (decltype(i) k = 0; k < rows; ++k) b(k, j) -= c(i, j) * a(k, i);
    }
  }
  for (decltype(a.rows()) i = columns; i-- > 0;) {
    for (decltype(i) j = 0; j < sides; ++j) {
      for (decltype(i) k = i + 1; k < columns; ++k) c(i, j) -= r(i, k) * c(k, j);
      c(i, j) /= r(i, i);
    }
  }
  return c;
}

}  // namespace gauntlet::test
