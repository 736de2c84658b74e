#include <H5Cpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/missing.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr hsize_t kMostValues = hsize_t{1} << 24;  // more than an hour of any glove
constexpr std::size_t kMostArrays = 1000;
constexpr std::size_t kMostNames = 4096;  // of columns

std::vector<std::size_t> ShapeOf(const H5::DataSpace& space) {
  std::vector<hsize_t> sizes(static_cast<std::size_t>(space.getSimpleExtentNdims()));
  if (!sizes.empty()) space.getSimpleExtentDims(sizes.data());
  return {sizes.begin(), sizes.end()};
}

/// Number of values of an array. Errors: UserError for too many.
std::size_t CountOf(const std::string& name, const std::vector<std::size_t>& shape) {
  hsize_t values = 1;
  for (const std::size_t size : shape) {
    if (size > kMostValues / std::max<hsize_t>(values, 1)) {
      throw UserError(
          fmt::format("{} has more than {} values; write a part of it as CSV", name, kMostValues));
    }
    values *= size;
  }
  return values;
}

void ReadInto(const H5::Attribute& from, const H5::StrType& type, void* place) {
  from.read(type, place);
}
void ReadInto(const H5::DataSet& from, const H5::StrType& type, void* place) {
  from.read(place, type);
}

/// Texts of fixed or variable size, in an attribute or a dataset.
template <class Texts>
std::vector<std::string> TextsIn(const Texts& from, std::size_t count) {
  const H5::StrType type = from.getStrType();
  std::vector<std::string> texts;
  if (type.isVariableStr()) {
    std::vector<char*> pointers(count);
    ReadInto(from, type, pointers.data());
    for (const char* pointer : pointers) texts.emplace_back(pointer != nullptr ? pointer : "");
    return texts;
  }
  std::string bytes(count * type.getSize(), '\0');
  ReadInto(from, type, bytes.data());
  for (std::size_t i = 0; i < count; ++i) {
    texts.emplace_back(bytes.substr(i * type.getSize(), type.getSize()).c_str());
  }
  return texts;
}

std::vector<std::string> TextsIn(const H5::Attribute& attribute) {
  return TextsIn(attribute,
                 static_cast<std::size_t>(attribute.getSpace().getSimpleExtentNpoints()));
}

/// The number in an attribute; NaN if it holds none, or several.
double NumberIn(const H5::Attribute& attribute) {
  double number = kMissing;
  const H5T_class_t kind = attribute.getTypeClass();
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return number;
  if (attribute.getSpace().getSimpleExtentNpoints() != 1) return number;
  attribute.read(H5::PredType::NATIVE_DOUBLE, &number);
  return number;
}

/// Texts in an attribute, none if it holds other things.
std::vector<std::string> TextsOf(const H5::Attribute& attribute) {
  if (attribute.getTypeClass() != H5T_STRING) return {};
  if (attribute.getSpace().getSimpleExtentNpoints() > hssize_t{kMostNames}) return {};
  return TextsIn(attribute);
}

/// The rate of rows by an attribute, 0 if it is none: a learning_rate is another rate.
double RowRateOf(const std::string& attribute, double number) {
  constexpr double kSlowest_hz = 0.5;
  constexpr double kFastest_hz = 1e5;
  const std::string bare = BareName(attribute);
  const bool is_of_rows = IsWordOf("fs fps rate ratehz dt", bare) || bare.starts_with("sampl") ||
                          bare.starts_with("frame") || bare.starts_with("control");
  const double rate_hz = is_of_rows ? RateOf(bare, number) : 0.0;
  return rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz ? rate_hz : 0.0;
}

/// Rates that are noted at a group, as lone numbers in it.
void AddRates(const H5::Group& group, const std::string& path, std::vector<NamedArray>& arrays) {
  for (int i = 0; i < group.getNumAttrs(); ++i) {
    try {
      const H5::Attribute attribute = group.openAttribute(static_cast<unsigned>(i));
      const std::string name = attribute.getName();
      const double number = NumberIn(attribute);
      if (!(RowRateOf(name, number) > 0.0)) continue;
      arrays.push_back(
          {.name = path.empty() ? name : path + "_" + name, .rows = 1, .values = {number}});
    } catch (const H5::Exception&) {
      continue;  // of a kind that this library does not read
    }
  }
}

/// The class that MATLAB 7.3 notes for a variable, as `double` or `char`; empty without one.
std::string MatlabClassOf(const H5::DataSet& dataset) {
  if (!dataset.attrExists("MATLAB_class")) return "";
  const std::vector<std::string> texts = TextsOf(dataset.openAttribute("MATLAB_class"));
  return texts.empty() ? "" : texts.front();
}

/// `place` with the unit of a time, as `milliseconds since 2025-11-29 10:00` of NetCDF. Source:
/// cfconventions.org, 4.4 Time Coordinate. xarray chooses the unit by the times.
std::string NameWithUnit(const std::string& place, const std::string& units) {
  const std::string own = place.substr(place.rfind('_') + 1);
  if (TimeScaleS(own) != 1.0) return place;
  const std::optional<double> scale_s = TimeScaleS(units.substr(0, units.find(' ')));
  return scale_s && *scale_s != 1.0 ? NameOfTimes(place, UnitOfSeconds(*scale_s)) : place;
}

/// Facts that are noted at a dataset: what stands for a missing value, a scale and an offset, the
/// unit, the rate of the rows, and names of the columns. Source: CF conventions 1.11, 2.5.1 and 8.1
/// (`_FillValue` is compared before `scale_factor` counts); `conversion` and `offset` of NWB 2.
void UseAttributes(const H5::DataSet& dataset, NamedArray& array) {
  std::string unit;
  double scale = 1.0, offset = 0.0, factor = 1.0, shift = 0.0;
  for (int i = 0; i < dataset.getNumAttrs(); ++i) {
    try {
      const H5::Attribute attribute = dataset.openAttribute(static_cast<unsigned>(i));
      const std::string name = BareName(attribute.getName());
      const double number = NumberIn(attribute);
      const std::vector<std::string> texts = TextsOf(attribute);
      if ((name == "fillvalue" || name == "missingvalue") && std::isfinite(number)) {
        std::ranges::replace(array.values, number, kMissing);
      }
      if (name == "scalefactor" && std::isfinite(number)) scale = number;
      if (name == "addoffset" && std::isfinite(number)) offset = number;
      if (name == "conversion" && std::isfinite(number)) factor = number;
      if (name == "offset" && std::isfinite(number)) shift = number;
      if ((name == "unit" || name == "units") && texts.size() == 1) unit = texts.front();
      if (const double rate_hz = RowRateOf(name, number); rate_hz > 0.0) array.rate_hz = rate_hz;
      const bool are_names = IsNameOfNames(name) || name == "columns" || name == "channels";
      if (are_names && texts.size() > 1 && texts.size() == array.columns &&
          array.column_names.empty()) {
        array.column_names = texts;
      }
    } catch (const H5::Exception&) {
      continue;  // of a kind that this library does not read
    }
  }
  if (factor != 1.0) {  // an offset alone may be one of anything
    scale = factor;
    offset = shift;
  }
  if (scale != 1.0 || offset != 0.0) {
    for (double& value : array.values) value = scale * value + offset;
  }
  const std::string with_unit = NameWithUnit(array.name, unit);
  if (with_unit != array.name) {
    array.name = with_unit;
  } else if (!unit.empty()) {
    AddUnit(array, unit);
  }
}

/// A filter that this program does not have, as lzf; empty if it has all.
std::string MissingFilter(const H5::DSetCreatPropList& creation) {
  for (int i = 0; i < creation.getNfilters(); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::array<char, 64> name = {};
    const H5Z_filter_t filter =
        H5Pget_filter2(creation.getId(), static_cast<unsigned>(i), &flags, &values, nullptr,
                       name.size() - 1, name.data(), &config);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    return name.front() != '\0' ? name.data() : fmt::format("filter {}", filter);
  }
  return "";
}

/// Blocks of a chunked dataset that were never written: the library gives zeros for them.
hsize_t UnwrittenChunks(const H5::DataSet& dataset, const H5::DSetCreatPropList& creation,
                        const std::vector<std::size_t>& shape) {
  std::vector<hsize_t> size(shape.size());
  creation.getChunk(static_cast<int>(size.size()), size.data());
  hsize_t all = 1, written = 0;
  for (std::size_t d = 0; d < shape.size(); ++d) all *= (shape[d] + size[d] - 1) / size[d];
  const H5::DataSpace space = dataset.getSpace();
  if (H5Dget_num_chunks(dataset.getId(), space.getId(), &written) < 0) return 0;
  return all - std::min(all, written);
}

/// Why a dataset is not read, as the library would give zeros or nothing for its values; empty if
/// it is.
std::string ReasonToLeaveOut(const H5::DataSet& dataset, const std::vector<std::size_t>& shape) {
  const H5::DSetCreatPropList creation = dataset.getCreatePlist();
  const H5D_layout_t layout = creation.getLayout();
  if (layout == H5D_VIRTUAL) return "virtual: its values are in other datasets or files";
  if (creation.getExternalCount() > 0) return "its values are in another file";
  if (const std::string filter = MissingFilter(creation); !filter.empty()) {
    return fmt::format("compressed by {}, which is not read; write it with gzip", filter);
  }
  H5D_space_status_t status = H5D_SPACE_STATUS_ALLOCATED;
  H5Dget_space_status(dataset.getId(), &status);
  if (status == H5D_SPACE_STATUS_NOT_ALLOCATED) return "its values were never written";
  if (layout != H5D_CHUNKED) return "";
  const hsize_t unwritten = UnwrittenChunks(dataset, creation, shape);
  return unwritten == 0 ? "" : fmt::format("blocks that were never written: {}", unwritten);
}

/// Reads the values as numbers. Errors: UserError with the name of the array.
void ReadValues(const H5::DataSet& dataset, const H5::DataType& type,
                const std::vector<std::size_t>& shape, ArrayOrder order, NamedArray& array) {
  std::vector<double> values(CountOf(array.name, shape));
  try {
    dataset.read(values.data(), type);
  } catch (const H5::Exception&) {
    throw UserError(fmt::format("is damaged: {} cannot be read", array.name));
  }
  SetValues(array, std::move(values), shape, order);
}

/// Member of a record that has numbers, or an array of numbers; sizes of the array to `shape`.
bool IsNumeric(const H5::CompType& type, unsigned member, std::vector<std::size_t>& shape) {
  H5T_class_t kind = type.getMemberClass(member);
  if (kind == H5T_ARRAY) {
    const H5::ArrayType array = type.getMemberArrayType(member);
    std::vector<hsize_t> sizes(static_cast<std::size_t>(array.getArrayNDims()));
    array.getArrayDims(sizes.data());
    shape.insert(shape.end(), sizes.begin(), sizes.end());
    kind = array.getSuper().getClass();
  }
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

/// The numbers of one member of the records.
NamedArray ReadMember(const H5::DataSet& dataset, const H5::CompType& type, unsigned member,
                      const std::string& place) {
  const std::string name = type.getMemberName(member);
  NamedArray array{.name = fmt::format("{}_{}", place, name), .values = {}};
  std::vector<std::size_t> of_member;
  if (!IsNumeric(type, member, of_member)) {
    array.left_out = "no numbers";
    return array;
  }
  std::vector<std::size_t> shape = ShapeOf(dataset.getSpace());
  shape.insert(shape.end(), of_member.begin(), of_member.end());
  CountOf(array.name, shape);
  const std::vector<hsize_t> sizes(of_member.begin(), of_member.end());
  const std::size_t width = CountOf(array.name, of_member) * sizeof(double);
  const H5::PredType& number = H5::PredType::NATIVE_DOUBLE;
  H5::CompType one(width);
  if (sizes.empty()) {
    one.insertMember(name, 0, number);
  } else {
    one.insertMember(name, 0, H5::ArrayType(number, static_cast<int>(sizes.size()), sizes.data()));
  }
  ReadValues(dataset, one, shape, ArrayOrder::kRows, array);
  return array;
}

/// A range of Octave, kept as base, limit and increment: `base:increment:limit`.
/// Source: Octave, libinterp/octave-value/ov-range.cc, save_hdf5 and load_hdf5.
NamedArray ReadRange(const H5::DataSet& dataset, const H5::CompType& type,
                     const std::string& place) {
  std::array<double, 3> numbers = {};  // base, limit, increment
  for (unsigned i = 0; i < numbers.size(); ++i) {
    const NamedArray member = ReadMember(dataset, type, i, place);
    if (member.values.size() == 1) numbers[i] = member.values.front();
  }
  std::size_t count = CountOfRange(numbers[0], numbers[1], numbers[2]);
  if (dataset.attrExists("OCTAVE_RANGE_NELEM")) {
    int elements = 0;
    dataset.openAttribute("OCTAVE_RANGE_NELEM").read(H5::PredType::NATIVE_INT, &elements);
    count = static_cast<std::size_t>(std::max(elements, 0));
  }
  CountOf(place, {count});
  return RangeArray(place, numbers[0], numbers[1], numbers[2], count);
}

bool IsRange(const H5::CompType& type) {
  return type.getNmembers() == 3 && type.getMemberName(0) == "base" &&
         type.getMemberName(1) == "limit" && type.getMemberName(2) == "increment";
}

/// Text of the letters of MATLAB 7.3, each a row.
void AddTexts(NamedArray array, std::vector<NamedArray>& arrays) {
  for (std::size_t row = 0; row < array.rows; ++row) {
    std::string& text = array.texts.emplace_back();
    for (std::size_t column = 0; column < array.columns; ++column) {
      const double letter = array.values[row * array.columns + column];
      text += letter >= 32.0 && letter < 127.0 ? static_cast<char>(letter) : '?';
    }
    text.erase(text.find_last_not_of(' ') + 1);
  }
  array.columns = 0;
  array.values.clear();
  arrays.push_back(std::move(array));
}

/// `is_of_octave`: a variable that Octave saved. Octave and MATLAB write their first dimension
/// last.
void AddArrays(const H5::DataSet& dataset, const std::string& place, bool is_of_octave,
               std::vector<NamedArray>& arrays) {
  const H5T_class_t kind = dataset.getTypeClass();
  const std::string matlab_class = MatlabClassOf(dataset);
  if (dataset.attrExists("MATLAB_empty")) return;
  NamedArray array{.name = place, .values = {}};
  const auto leave_out = [&](std::string reason) {
    array.left_out = std::move(reason);
    arrays.push_back(std::move(array));
  };
  if (kind == H5T_REFERENCE) {
    return leave_out(matlab_class.empty() ? "references"
                                          : "a cell array or struct array of MATLAB 7.3");
  }
  const H5::DataSpace space = dataset.getSpace();
  if (space.getSimpleExtentType() == H5S_NULL) return;
  std::vector<std::size_t> shape = ShapeOf(space);
  if (std::ranges::find(shape, 0U) != shape.end()) return;
  if (kind == H5T_STRING) {
    if (shape.size() == 1 && shape[0] <= kMostNames && IsNameOfNames(place)) {
      array.texts = TextsIn(dataset, shape[0]);
      array.rows = array.texts.size();
      array.columns = 0;
      arrays.push_back(std::move(array));
    } else if (!shape.empty()) {
      leave_out("texts");
    }
    return;
  }
  if (std::string reason = ReasonToLeaveOut(dataset, shape); !reason.empty()) {
    return leave_out(std::move(reason));
  }
  if (kind == H5T_COMPOUND) {
    const H5::CompType type = dataset.getCompType();
    if (IsRange(type)) {
      arrays.push_back(ReadRange(dataset, type, place));
      return;
    }
    for (int i = 0; i < type.getNmembers(); ++i) {
      arrays.push_back(ReadMember(dataset, type, static_cast<unsigned>(i), place));
    }
    return;
  }
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    return leave_out(kind == H5T_ENUM ? "flags or an enumeration" : "no numbers");
  }
  const bool is_reversed = is_of_octave || !matlab_class.empty();
  if (is_reversed) std::ranges::reverse(shape);
  ReadValues(dataset, H5::PredType::NATIVE_DOUBLE, shape,
             is_reversed ? ArrayOrder::kColumns : ArrayOrder::kRows, array);
  if (matlab_class == "char") return AddTexts(std::move(array), arrays);
  UseAttributes(dataset, array);
  arrays.push_back(std::move(array));
}

/// Why a link cannot be followed; empty if it can.
std::string ProblemOfLink(const H5::Group& group, const std::string& name) {
  H5L_info_t link = {};
  if (H5Lget_info(group.getId(), name.c_str(), &link, H5P_DEFAULT) < 0) return "a broken link";
  if (link.type == H5L_TYPE_EXTERNAL) return "a link into another file";
  const bool is_there =
      link.type == H5L_TYPE_HARD || H5Oexists_by_name(group.getId(), name.c_str(), H5P_DEFAULT) > 0;
  return is_there ? "" : "a link that leads nowhere";
}

/// The rate that NWB has beside the time of the first row of a series; nothing without one.
/// Source: nwb-schema, nwb.base.yaml, TimeSeries.
std::optional<NamedArray> RateBeside(const H5::DataSet& dataset, const std::string& path) {
  if (!dataset.attrExists("rate")) return std::nullopt;
  const double rate_hz = NumberIn(dataset.openAttribute("rate"));
  if (std::isnan(rate_hz)) return std::nullopt;
  return NamedArray{.name = path + "_rate", .rows = 1, .columns = 1, .values = {rate_hz}};
}

/// Groups in groups are read up to this depth.
void Collect(const H5::Group& group, const std::string& path, int depth,
             std::vector<NamedArray>& arrays) {
  constexpr int kDeepest = 8;
  const bool is_of_octave = group.attrExists("OCTAVE_NEW_FORMAT");
  AddRates(group, path, arrays);
  for (hsize_t i = 0; i < group.getNumObjs(); ++i) {
    const std::string name = group.getObjnameByIdx(i);
    const std::string place = path.empty() ? name : path + "_" + name;
    std::string problem = ProblemOfLink(group, name);
    const bool is_too_many = arrays.size() >= kMostArrays;
    if (is_too_many) problem = fmt::format("behind {} others", kMostArrays);
    if (problem.empty()) {
      const H5O_type_t type = group.childObjType(name);
      if (type == H5O_TYPE_DATASET) {
        const H5::DataSet dataset = group.openDataSet(name);
        AddArrays(dataset, place, is_of_octave, arrays);
        if (auto rate = name == "starting_time" ? RateBeside(dataset, path) : std::nullopt) {
          arrays.push_back(std::move(*rate));
        }
      } else if (type == H5O_TYPE_GROUP && name != "#refs#") {
        if (depth < kDeepest) {
          Collect(group.openGroup(name), place, depth + 1, arrays);
        } else {
          problem = "in too many groups";
        }
      }
    }
    if (!problem.empty()) arrays.push_back({.name = place, .values = {}, .left_out = problem});
    if (is_too_many) return;
  }
}

/// The wearer's angles, under the names that a recording has for them.
std::vector<NamedArray> ArraysOfTrace(const H5::DataSet& truth) {
  std::vector<NamedArray> read;
  AddArrays(truth, "true_angle_rad", false, read);
  if (read.empty()) return {};
  NamedArray angles = std::move(read.front());
  for (const std::string& channel : TextsIn(truth.openAttribute("columns"))) {
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
