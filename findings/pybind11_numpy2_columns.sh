#!/bin/bash
# pybind11 2.10.3 and 2.13.6 with NumPy 2.4.6 and 1.26.4 (PyPI), g++ and the headers of Python: a filter in C++ whose
# module was built with the pybind11 of Debian 12 (2.10.3), and whose user has the NumPy that pip takes today.
#
# Guess: an old module and a new NumPy do not go together, so that the import fails or the first call raises or crashes.
# Seen: nothing fails. NumPy 2 keeps the size of an element elsewhere, pybind11 before 2.12 reads 0 there, and arrays that
# the module makes have strides of 0: each row and column is the first value. The angles of all joints are those of the
# thumb. With pybind11 2.13.6, or NumPy 1.26.4, they are right.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
cat >"$folder/hand.cc" <<'CODE'
#include <pybind11/numpy.h>
PYBIND11_MODULE(hand, module) {
  module.def("half", [](pybind11::array_t<double> angles) {
    pybind11::array_t<double> result(angles.size());
    for (pybind11::ssize_t i = 0; i < angles.size(); ++i) result.mutable_data()[i] = angles.data()[i] / 2.0;
    return result;
  });
}
CODE
for versions in "2.10.3 2.4.6" "2.10.3 1.26.4" "2.13.6 2.4.6"; do
  read -r pybind11 numpy <<<"$versions"
  "$folder/venv/bin/pip" -q --disable-pip-version-check install "pybind11==$pybind11" "numpy==$numpy"
  read -ra includes <<<"$("$folder/venv/bin/python" -m pybind11 --includes)"
  g++ -O1 -std=c++17 -shared -fPIC "${includes[@]}" "$folder/hand.cc" -o "$folder/hand.so"
  PYTHONPATH=$folder "$folder/venv/bin/python" - "$pybind11" <<'PYTHON'
import sys

import numpy as np
import hand

halves = hand.half(np.array([10.0, 20.0, 30.0, 40.0]))
print(f"pybind11 {sys.argv[1]}, NumPy {np.__version__}: halves of 10, 20, 30, 40: {halves}, strides {halves.strides}")
is_wrong = sys.argv[1].startswith("2.10") and np.__version__.startswith("2.")
expected = [5.0, 5.0, 5.0, 5.0] if is_wrong else [5.0, 10.0, 15.0, 20.0]
assert halves.tolist() == expected, "something else"
PYTHON
done
