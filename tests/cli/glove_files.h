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
  int sensors = 0;       // that are joints of a hand
  std::function<void(const std::filesystem::path&)> write;
};

/// Shapes that can be read: text of all kinds, NPY, NPZ, MAT, HDF5, JSON; 3 to 32 columns, 10 to
/// 100 Hz; counts of 8 to 16 bits, degrees, radians, volts, shares.
std::vector<GloveFile> GloveFiles();

}  // namespace gauntlet::test
