#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/tables/array_files.h"
#include "sim/tables/file_format.h"

namespace gauntlet::sim {
namespace {

template <class Number>
void Append(const matvar_t& variable, std::vector<double>& values) {
  const auto* const data = static_cast<const Number*>(variable.data);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(data[i]);
}

std::string NameIn(const matvar_t& variable) {
  return variable.name == nullptr ? "" : variable.name;
}

/// False for what holds no real numbers.
bool ReadNumbers(const matvar_t& variable, std::vector<double>& values) {
  static const std::map<matio_types, void (*)(const matvar_t&, std::vector<double>&)> kAppend = {
      {MAT_T_DOUBLE, Append<double>},      {MAT_T_SINGLE, Append<float>},
      {MAT_T_INT8, Append<std::int8_t>},   {MAT_T_UINT8, Append<std::uint8_t>},
      {MAT_T_INT16, Append<std::int16_t>}, {MAT_T_UINT16, Append<std::uint16_t>},
      {MAT_T_INT32, Append<std::int32_t>}, {MAT_T_UINT32, Append<std::uint32_t>},
      {MAT_T_INT64, Append<std::int64_t>}, {MAT_T_UINT64, Append<std::uint64_t>}};
  const auto found = kAppend.find(variable.data_type);
  if (found != kAppend.end()) found->second(variable, values);
  return found != kAppend.end();
}

/// Why a variable without structure is not read; empty if it may be.
std::string_view ReasonToLeaveOut(const matvar_t& variable) {
  if (variable.class_type == MAT_C_SPARSE) return "a sparse matrix";
  if (variable.class_type == MAT_C_FUNCTION) return "a function";
  if (variable.class_type == MAT_C_OBJECT || variable.class_type == MAT_C_OPAQUE) {
    return "an object of MATLAB";
  }
  return variable.isComplex != 0 ? "complex numbers" : "";
}

void Collect(const matvar_t& variable, const std::string& place, std::vector<NamedArray>& arrays);

/// The rows of a matrix of letters.
std::vector<std::string> TextsIn(const matvar_t& variable) {
  std::vector<std::string> texts;
  if (variable.data == nullptr || variable.rank != 2) return texts;
  const std::size_t rows = variable.dims[0];
  const auto width = static_cast<std::size_t>(variable.data_size);
  if (rows * variable.dims[1] * width > variable.nbytes || width > 2) return texts;
  for (std::size_t row = 0; row < rows; ++row) {
    std::string text;
    for (std::size_t i = 0; i < variable.dims[1]; ++i) {
      const auto* const letter =
          static_cast<const unsigned char*>(variable.data) + (i * rows + row) * width;
      text += static_cast<char>(width == 1 || letter[1] == 0 ? letter[0] : '?');
    }
    texts.emplace_back(Trimmed(text));
  }
  return texts;
}

void AddTexts(const std::string& place, std::vector<std::string> texts,
              std::vector<NamedArray>& arrays) {
  if (texts.empty()) return;
  arrays.push_back({.name = place, .columns = 0, .values = {}, .texts = std::move(texts)});
}

/// Arrays from the place `first` on are in this cell.
void MarkCell(const std::string& cells_of, const std::string& cell, std::size_t first,
              std::vector<NamedArray>& arrays) {
  for (std::size_t i = first; i < arrays.size(); ++i) {
    arrays[i].cells_of = cells_of;
    arrays[i].cell = cell;
  }
}

/// Cells are called `name_2`, in a matrix of cells `name_2_1`.
void CollectCells(const matvar_t& variable, const std::string& place,
                  std::vector<NamedArray>& arrays) {
  if (variable.rank < 2 || variable.data == nullptr) return;
  const std::size_t rows = variable.dims[0];
  const std::size_t cells = variable.nbytes / static_cast<std::size_t>(variable.data_size);
  const auto* const all = static_cast<matvar_t* const*>(variable.data);
  std::vector<std::string> texts;  // of cells that are all letters
  for (std::size_t i = 0; i < cells && texts.size() == i; ++i) {
    if (all[i] == nullptr || all[i]->class_type != MAT_C_CHAR) break;
    for (std::string& text : TextsIn(*all[i])) texts.push_back(std::move(text));
  }
  if (cells > 0 && texts.size() == cells) return AddTexts(place, std::move(texts), arrays);
  for (std::size_t i = 0; i < cells; ++i) {
    if (all[i] == nullptr) continue;
    const bool is_vector = rows == 1 || rows == cells;
    const std::string cell = is_vector ? fmt::format("{}_{}", place, i + 1)
                                       : fmt::format("{}_{}_{}", place, i % rows + 1, i / rows + 1);
    const std::size_t before = arrays.size();
    Collect(*all[i], cell, arrays);
    MarkCell(place, cell, before, arrays);
  }
}

/// The fields of a structure; those of the second element of a struct array begin with `name_2`.
void CollectFields(const matvar_t& variable, const std::string& place,
                   std::vector<NamedArray>& arrays) {
  auto& structure = const_cast<matvar_t&>(variable);  // the library asks for it, and reads only
  std::size_t elements = 1;
  for (int d = 0; d < variable.rank; ++d) elements *= variable.dims[d];
  const unsigned fields = Mat_VarGetNumberOfFields(&structure);
  if (fields == 0 || elements > variable.nbytes) return;
  for (std::size_t i = 0; i < elements; ++i) {
    const std::string cell = elements == 1 ? place : fmt::format("{}_{}", place, i + 1);
    const std::size_t before = arrays.size();
    for (unsigned f = 0; f < fields; ++f) {
      const matvar_t* const field = Mat_VarGetStructFieldByIndex(&structure, f, i);
      if (field != nullptr) Collect(*field, cell + "_" + NameIn(*field), arrays);
    }
    if (elements > 1) MarkCell(place, cell, before, arrays);
  }
}

void Collect(const matvar_t& variable, const std::string& place, std::vector<NamedArray>& arrays) {
  if (variable.class_type == MAT_C_CELL) return CollectCells(variable, place, arrays);
  if (variable.class_type == MAT_C_STRUCT) return CollectFields(variable, place, arrays);
  if (variable.class_type == MAT_C_CHAR) return AddTexts(place, TextsIn(variable), arrays);
  if (variable.class_type == MAT_C_EMPTY) return;
  NamedArray array{
      .name = place, .values = {}, .left_out = std::string(ReasonToLeaveOut(variable))};
  if (!array.left_out.empty()) {
    arrays.push_back(std::move(array));
    return;
  }
  const std::vector<std::size_t> shape(variable.dims, variable.dims + variable.rank);
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size == 0) return;
    if (size > variable.nbytes / count) {
      throw UserError(fmt::format("is damaged: {} is smaller than it says", place));
    }
    count *= size;
  }
  if (variable.data == nullptr) {
    array.left_out = "no numbers";
    arrays.push_back(std::move(array));
    return;
  }
  if (count > variable.nbytes / static_cast<std::size_t>(variable.data_size)) {
    throw UserError(fmt::format("is damaged: {} is smaller than it says", place));
  }
  std::vector<double> values(count);
  if (ReadNumbers(variable, values)) {
    SetValues(array, std::move(values), shape, ArrayOrder::kColumns);
  } else {
    array.left_out = "no numbers";
  }
  arrays.push_back(std::move(array));
}

/// Bytes of a variable of MAT 4 behind its head of 20 bytes: its name and its values.
/// Source: MAT-File Format, level 4.
std::uint64_t BytesOfMat4(const std::array<std::uint32_t, 5>& head) {
  constexpr std::array<std::uint64_t, 6> kWidths = {8, 4, 4, 2, 2, 1};
  const auto& [type, rows, columns, is_complex, name] = head;
  const std::uint64_t width = kWidths.at(std::min<std::size_t>(type / 10 % 10, 5));
  const std::uint64_t values = std::uint64_t{rows} * columns;
  if (values > std::numeric_limits<std::uint32_t>::max()) return values;  // more than any file
  return name + values * width * (is_complex != 0 ? 2 : 1);
}

/// The library takes zeros for what a truncated file lacks: its elements have to end where the file
/// ends. Each has a head of 8 bytes with its size, in MAT 4 of 20 bytes.
/// Source: MAT-File Format, level 5.
void CheckElements(const std::filesystem::path& file) {
  constexpr std::uint64_t kHead = 128;
  std::ifstream input(file, std::ios::binary);
  const std::uint64_t end = std::filesystem::file_size(file);
  std::string head(kHead, '\0');
  input.read(head.data(), kHead);
  input.clear();
  const bool is_mat4 = IsMat4(head);
  const bool swapped = is_mat4 ? head.front() == 0 && head[3] != 0 : head[kHead - 2] == 'M';
  const std::size_t words = is_mat4 ? 5 : 2;
  for (std::uint64_t place = is_mat4 ? 0 : kHead; place < end;) {
    std::array<std::uint32_t, 5> tag = {};
    input.seekg(static_cast<std::streamoff>(place));
    input.read(reinterpret_cast<char*>(tag.data()), static_cast<std::streamsize>(4 * words));
    if (swapped)
      std::ranges::transform(tag, tag.begin(), [](auto word) { return __builtin_bswap32(word); });
    place += 4 * words + (is_mat4 ? BytesOfMat4(tag) : tag[1]);
    if (!input || place > end) throw UserError("is damaged: it ends too early");
  }
}

}  // namespace

std::vector<NamedArray> ReadMatArrays(const std::filesystem::path& file) {
  CheckElements(file);
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(Mat_Open(file.c_str(), MAT_ACC_RDONLY),
                                                    Mat_Close);
  if (mat == nullptr) throw UserError("cannot be opened as a MAT file");
  OpenNoMoreFiles();
  std::vector<NamedArray> arrays;
  bool has_objects = false;
  for (;;) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNext(mat.get()),
                                                                  Mat_VarFree);
    if (variable == nullptr) break;
    const std::string name = NameIn(*variable);
    // What MATLAB keeps of its objects is behind them, in a variable of bytes without a name.
    const bool is_of_objects = name.empty() || name == "__function_workspace__";
    has_objects = has_objects || is_of_objects || variable->class_type == MAT_C_OPAQUE;
    if (!is_of_objects) Collect(*variable, name, arrays);
  }
  if (arrays.empty() && has_objects) {
    throw UserError(
        "holds objects of MATLAB, such as a table, which only MATLAB reads; writetable(T, "
        "'T.csv') saves a table as CSV");
  }
  return arrays;
}

}  // namespace gauntlet::sim
