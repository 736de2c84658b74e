#include <fmt/format.h>
#include <matio.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/tables/library_arrays.h"

namespace gauntlet::sim {
namespace {

template <class Number>
void Append(const matvar_t& variable, NamedArray& array) {
  const auto* const data = static_cast<const Number*>(variable.data);
  for (std::size_t row = 0; row < array.rows; ++row) {
    for (std::size_t column = 0; column < array.columns; ++column) {
      array.values.push_back(static_cast<double>(data[column * array.rows + row]));
    }
  }
}

std::string NameIn(const matvar_t& variable) {
  return variable.name == nullptr ? "" : variable.name;
}

/// False for what holds no real numbers.
bool AppendNumbers(const matvar_t& variable, NamedArray& array) {
  static const std::map<matio_types, void (*)(const matvar_t&, NamedArray&)> kAppend = {
      {MAT_T_DOUBLE, Append<double>},     {MAT_T_SINGLE, Append<float>},
      {MAT_T_INT8, Append<mat_int8_t>},   {MAT_T_UINT8, Append<mat_uint8_t>},
      {MAT_T_INT16, Append<mat_int16_t>}, {MAT_T_UINT16, Append<mat_uint16_t>},
      {MAT_T_INT32, Append<mat_int32_t>}, {MAT_T_UINT32, Append<mat_uint32_t>}};
  const auto found = kAppend.find(variable.data_type);
  if (found != kAppend.end()) found->second(variable, array);
  return found != kAppend.end();
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
  const std::size_t before = arrays.size();
  for (std::size_t i = 0; i < cells; ++i) {
    if (all[i] == nullptr) continue;
    const bool is_vector = rows == 1 || rows == cells;
    Collect(*all[i],
            is_vector ? fmt::format("{}_{}", place, i + 1)
                      : fmt::format("{}_{}_{}", place, i % rows + 1, i / rows + 1),
            arrays);
  }
  for (std::size_t i = before; i < arrays.size(); ++i) arrays[i].cells_of = place;
}

void Collect(const matvar_t& variable, const std::string& place, std::vector<NamedArray>& arrays) {
  if (variable.class_type == MAT_C_CELL) {
    CollectCells(variable, place, arrays);
    return;
  }
  if (variable.class_type == MAT_C_STRUCT) {
    auto& structure = const_cast<matvar_t&>(variable);  // the library asks for it, and reads only
    for (unsigned i = 0; i < Mat_VarGetNumberOfFields(&structure); ++i) {
      const matvar_t* const field = Mat_VarGetStructFieldByIndex(&structure, i, 0);
      if (field != nullptr) Collect(*field, place + "_" + NameIn(*field), arrays);
    }
    return;
  }
  if (variable.class_type == MAT_C_CHAR) return AddTexts(place, TextsIn(variable), arrays);
  if (variable.data == nullptr || variable.isComplex != 0 || variable.rank < 2 ||
      variable.rank > 3 || variable.class_type == MAT_C_SPARSE) {
    return;
  }
  NamedArray array{.name = place, .rows = variable.dims[0], .values = {}};
  for (int d = 1; d < variable.rank; ++d) array.columns *= variable.dims[d];
  if (array.rows * array.columns * static_cast<std::size_t>(variable.data_size) > variable.nbytes) {
    throw UserError(fmt::format("is damaged: {} is smaller than it says", place));
  }
  if (AppendNumbers(variable, array)) arrays.push_back(std::move(array));
}

/// The library takes zeros for what a truncated file lacks: its elements, each a head of 8 bytes
/// with its size, have to end where the file ends. Source: MAT-File Format, level 5.
void CheckElements(const std::filesystem::path& file) {
  constexpr std::uint64_t kHead = 128;
  std::ifstream input(file, std::ios::binary);
  const std::uint64_t end = std::filesystem::file_size(file);
  std::array<char, 2> order = {};
  input.seekg(kHead - 2).read(order.data(), order.size());
  const bool swapped = order[0] == 'M';
  for (std::uint64_t place = kHead; place < end;) {
    std::array<std::uint32_t, 2> tag = {};
    input.seekg(static_cast<std::streamoff>(place));
    input.read(reinterpret_cast<char*>(tag.data()), sizeof tag);
    place += sizeof tag + (swapped ? __builtin_bswap32(tag[1]) : tag[1]);
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
