#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace gauntlet::test {

/// A recording in the shape of one that a public source has, made up by a formula.
struct GloveFile {
  std::string name;
  double rate_hz = 0.0;  // that the file tells; 0: it does not
  std::string unit;      // as gauntlet inspect names it
  int sensors = 0;       // that drive a joint
  std::function<void(const std::filesystem::path&)> write;
  std::string question = {};  // part of the sentence that asks for the joints; empty: none is open
};

/// Shapes that can be read: text of all kinds, NPY, NPZ, MAT, HDF5, JSON; 3 to 32 columns, 10 to
/// 100 Hz; counts of 8 to 16 bits, degrees, radians, volts, shares.
std::vector<GloveFile> GloveFiles();

/// A MAT file with a cell array `data` of two tables of 100 rows.
void WriteCellMat(const std::filesystem::path& file);

}  // namespace gauntlet::test
