#include <H5Cpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/tables/library_arrays.h"

namespace gauntlet::sim {
namespace {

constexpr hsize_t kMostValues = hsize_t{1} << 24;  // more than an hour of any glove
constexpr std::size_t kMostArrays = 1000;

/// Nothing for what holds no numbers, or nothing at all.
bool ReadArray(const H5::DataSet& dataset, NamedArray& array) {
  const H5T_class_t kind = dataset.getTypeClass();
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return false;
  const H5::DataSpace space = dataset.getSpace();
  const int rank = space.getSimpleExtentNdims();
  constexpr int kMostDimensions = 3;
  if (rank > kMostDimensions) return false;
  std::array<hsize_t, kMostDimensions> size = {1, 1, 1};
  space.getSimpleExtentDims(size.data());
  hsize_t values = 1;
  for (const hsize_t part : size) {
    if (part == 0) return false;
    if (part > kMostValues / values) {
      throw UserError(fmt::format("{} has more than {} values; write a part of it as CSV",
                                  array.name, kMostValues));
    }
    values *= part;
  }
  array.rows = size[0];
  array.columns = size[1] * size[2];
  array.values.resize(values);
  dataset.read(array.values.data(), H5::PredType::NATIVE_DOUBLE);
  return true;
}

/// Groups in groups are read up to this depth.
void Collect(const H5::Group& group, const std::string& path, int depth,
             std::vector<NamedArray>& arrays) {
  constexpr int kDeepest = 8;
  if (depth > kDeepest) return;
  for (hsize_t i = 0; i < group.getNumObjs() && arrays.size() < kMostArrays; ++i) {
    const std::string name = group.getObjnameByIdx(i);
    const std::string place = path.empty() ? name : path + "_" + name;
    const H5O_type_t type = group.childObjType(name);
    if (type == H5O_TYPE_GROUP && name != "#refs#") {
      Collect(group.openGroup(name), place, depth + 1, arrays);
    } else if (type == H5O_TYPE_DATASET) {
      NamedArray array{.name = place, .values = {}};
      if (ReadArray(group.openDataSet(name), array)) arrays.push_back(std::move(array));
    }
  }
}

/// Fixed texts of an attribute, as Gauntlet writes them.
std::vector<std::string> TextsOf(const H5::DataSet& dataset, const char* name) {
  const H5::Attribute attribute = dataset.openAttribute(name);
  const H5::StrType type = attribute.getStrType();
  const auto count = static_cast<std::size_t>(attribute.getSpace().getSimpleExtentNpoints());
  std::vector<std::string> texts;
  if (type.isVariableStr()) {
    std::vector<char*> pointers(count);
    attribute.read(type, static_cast<void*>(pointers.data()));
    for (const char* pointer : pointers) texts.emplace_back(pointer != nullptr ? pointer : "");
    return texts;
  }
  std::string bytes(count * type.getSize(), '\0');
  attribute.read(type, bytes.data());
  for (std::size_t i = 0; i < count; ++i) {
    texts.emplace_back(bytes.substr(i * type.getSize(), type.getSize()).c_str());
  }
  return texts;
}

/// The wearer's angles, under the names that a recording has for them.
std::vector<NamedArray> ArraysOfTrace(const H5::DataSet& truth) {
  NamedArray angles{.name = "true_angle_rad", .values = {}};
  if (!ReadArray(truth, angles)) return {};
  for (const std::string& channel : TextsOf(truth, "columns")) {
    angles.column_names.push_back(channel + "_rad");
  }
  double rate_hz = 0.0;
  truth.openAttribute("rate_hz").read(H5::PredType::NATIVE_DOUBLE, &rate_hz);
  NamedArray time{.name = "time_s", .rows = angles.rows, .values = {}};
  for (std::size_t row = 0; row < angles.rows; ++row) {
    time.values.push_back(static_cast<double>(row) / rate_hz);
  }
  return {std::move(time), std::move(angles)};
}

}  // namespace

std::vector<NamedArray> ReadHdf5Arrays(const std::filesystem::path& file) {
  try {
    H5::Exception::dontPrint();
    H5PLset_loading_state(0);  // no plugins: a file can name any
    const H5::H5File input(file.string(), H5F_ACC_RDONLY);
    OpenNoMoreFiles();  // a file can also say that a part of it is in another
    if (input.attrExists("scenario") && input.nameExists("glove") &&
        input.nameExists("glove/true_angle_rad")) {
      return ArraysOfTrace(input.openDataSet("glove/true_angle_rad"));
    }
    std::vector<NamedArray> arrays;
    Collect(input.openGroup("/"), "", 0, arrays);
    return arrays;
  } catch (const H5::Exception& exception) {
    throw UserError(
        fmt::format("is damaged, or HDF5 that is not read ({})", exception.getDetailMsg()));
  }
}

}  // namespace gauntlet::sim
