#include "tests/cli/glove_files.h"

#include <H5Cpp.h>
#include <fmt/format.h>
#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

constexpr double kSeconds = 3.0;
constexpr double kPi = 3.14159265358979323846;

/// Noise of about one, the same every time.
double Noise(int row, int sensor) {
  const double mixed = std::sin(12.9898 * row + 78.233 * sensor) * 43758.5453;
  return 2.0 * (mixed - std::floor(mixed)) - 1.0;
}

/// What a joint does, 5 to 85 degrees.
double AngleDeg(int row, int sensor, double rate_hz) {
  const double t = row / rate_hz;
  return 45.0 + 39.0 * std::sin(2.0 * kPi * (0.5 + 0.03 * sensor) * t + sensor) +
         0.5 * Noise(row, sensor);
}

using Values = std::function<double(int row, int sensor)>;

Values Counts(int bits, double rate_hz) {
  return [=](int row, int sensor) {
    const double full = std::ldexp(1.0, bits) - 1.0;
    return std::round(full * (0.2 + 0.6 * AngleDeg(row, sensor, rate_hz) / 90.0));
  };
}
Values Degrees(double rate_hz) {
  return [=](int row, int sensor) {
    return std::round(100.0 * (AngleDeg(row, sensor, rate_hz) - 10.0)) / 100.0;
  };
}
Values Radians(double rate_hz) {
  return [=](int row, int sensor) { return (AngleDeg(row, sensor, rate_hz) - 15.0) * kPi / 180.0; };
}
Values Volts(double rate_hz) {
  return [=](int row, int sensor) { return 1.1 + 0.012 * AngleDeg(row, sensor, rate_hz); };
}
Values Shares(double rate_hz) {
  return [=](int row, int sensor) {
    return std::clamp((AngleDeg(row, sensor, rate_hz) - 5.0) / 80.0, 0.0, 1.0);
  };
}

/// The way a text is written.
struct Style {
  std::string separator = ",";
  std::string line_end = "\n";
  bool decimal_comma = false;
  bool quoted = false;
  std::string before = {};  // the header
  std::string header = {};
};

std::string Cell(const Style& style, double value) {
  std::string text = fmt::format("{}", value);
  if (style.decimal_comma) std::ranges::replace(text, '.', ',');
  return style.quoted ? "\"" + text + "\"" : text;
}

/// `first`: the cells of a row before its sensors, their separators included.
std::string Text(const Style& style, double rate_hz, int sensors, const Values& values,
                 const std::function<std::string(int row)>& first,
                 const std::function<std::string(int row)>& last = {}) {
  std::string text = style.before;
  if (!style.header.empty()) text += style.header + style.line_end;
  for (int row = 0; row < kSeconds * rate_hz; ++row) {
    text += first ? first(row) : "";
    for (int sensor = 0; sensor < sensors; ++sensor) {
      if (sensor > 0) text += style.separator;
      text += Cell(style, values(row, sensor));
    }
    text += (last ? last(row) : "") + style.line_end;
  }
  return text;
}

std::function<void(const fs::path&)> Bytes(std::string bytes) {
  return [bytes = std::move(bytes)](const fs::path& file) {
    std::ofstream(file, std::ios::binary) << bytes;
  };
}

std::string Numbered(const std::string& name, int count, const std::string& separator = ",") {
  std::string names;
  for (int i = 1; i <= count; ++i) names += fmt::format("{}{}{}", i > 1 ? separator : "", name, i);
  return names;
}

/// The clock of a row after 13:59:59 of a day.
std::string Clock(int row, double rate_hz, char point) {
  const double t = 13.0 * 3600.0 + 59.0 * 60.0 + 59.0 + row / rate_hz;
  const auto milliseconds = static_cast<long>(std::round(1e3 * t));
  return fmt::format("{:02}:{:02}:{:02}{}{:03}", milliseconds / 3600000, milliseconds / 60000 % 60,
                     milliseconds / 1000 % 60, point, milliseconds % 1000);
}

std::string Utf16(const std::string& ascii) {
  std::string wide = "\xff\xfe";
  for (const char letter : ascii) wide += {letter, '\0'};
  return wide;
}

// --- NumPy ---------------------------------------------------------------------------------------

template <class Number>
std::string Npy(const std::string& type, const std::string& shape,
                const std::vector<double>& values) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  header.resize((header.size() + 10 + 64) / 64 * 64 - 11, ' ');
  header += '\n';
  std::string bytes = std::string("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 255);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (const double value : values) {
    const auto number = static_cast<Number>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return bytes;
}

std::string Little(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 255);
  return text;
}

std::string Deflated(const std::string& bytes) {
  z_stream stream = {};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = bytes.size();
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = packed.size();
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string Zip(const std::vector<std::pair<std::string, std::string>>& files, bool deflated) {
  std::string zip, directory;
  for (const auto& [name, bytes] : files) {
    const std::string packed = deflated ? Deflated(bytes) : bytes;
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    const std::string facts = Little(20, 2) + Little(0, 2) + Little(deflated ? 8 : 0, 2) +
                              Little(0, 4) + Little(crc, 4) + Little(packed.size(), 4) +
                              Little(bytes.size(), 4) + Little(name.size(), 2) + Little(0, 2);
    directory += "PK\x01\x02" + Little(20, 2) + facts + Little(0, 2) + Little(0, 2) + Little(0, 2) +
                 Little(0, 4) + Little(zip.size(), 4) + name;
    zip += "PK\x03\x04" + facts + name + packed;
  }
  const std::size_t start = zip.size();
  return zip + directory + "PK\x05\x06" + Little(0, 4) + Little(files.size(), 2) +
         Little(files.size(), 2) + Little(directory.size(), 4) + Little(start, 4) + Little(0, 2);
}

/// Rows of sensors, one after another.
std::vector<double> Matrix(double rate_hz, int sensors, const Values& values) {
  std::vector<double> matrix;
  for (int row = 0; row < kSeconds * rate_hz; ++row) {
    for (int sensor = 0; sensor < sensors; ++sensor) matrix.push_back(values(row, sensor));
  }
  return matrix;
}

std::vector<double> Times(double rate_hz) {
  return Matrix(rate_hz, 1, [rate_hz](int row, int) { return row / rate_hz; });
}

int RowsOf(double rate_hz) { return static_cast<int>(kSeconds * rate_hz); }

// --- MATLAB and HDF5 -----------------------------------------------------------------------------

/// `values` column by column, as MATLAB has them.
matvar_t* MatVariable(const char* name, std::size_t rows, std::size_t columns,
                      const std::vector<double>& values) {
  std::array<std::size_t, 2> size = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(),
                       const_cast<double*>(values.data()), 0);
}

void WriteMat(const fs::path& file, const std::vector<matvar_t*>& variables) {
  mat_t* const mat = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT5);
  for (matvar_t* variable : variables) {
    Mat_VarWrite(mat, variable, MAT_COMPRESSION_ZLIB);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

void WriteStructMat(const fs::path& file, double rate_hz, int sensors, const Values& values) {
  const std::size_t rows = RowsOf(rate_hz);
  std::vector<double> angles;
  for (int sensor = 0; sensor < sensors; ++sensor) {
    for (std::size_t row = 0; row < rows; ++row)
      angles.push_back(values(static_cast<int>(row), sensor));
  }
  std::array<const char*, 2> fields = {"time", "angles"};
  std::array<std::size_t, 2> one = {1, 1};
  matvar_t* const glove = Mat_VarCreateStruct("glove", 2, one.data(), fields.data(), 2);
  const std::vector<double> times = Times(rate_hz);
  matvar_t* const time = MatVariable("time", rows, 1, times);
  matvar_t* const table = MatVariable("angles", rows, sensors, angles);
  Mat_VarSetStructFieldByName(glove, "time", 0, time);
  Mat_VarSetStructFieldByName(glove, "angles", 0, table);
  WriteMat(file, {glove});
}

/// A row per sensor, and the rate besides.
void WriteTurnedMat(const fs::path& file, double rate_hz, int sensors, const Values& values) {
  const std::vector<double> angles = Matrix(rate_hz, sensors, values);
  WriteMat(file, {MatVariable("fs", 1, 1, {rate_hz}),
                  MatVariable("glove", sensors, RowsOf(rate_hz), angles)});
}

void AddDataset(H5::Group group, const char* name, hsize_t rows, hsize_t columns,
                const std::vector<double>& values) {
  const std::array<hsize_t, 2> size = {rows, columns};
  const H5::DataSpace space(columns > 1 ? 2 : 1, size.data());
  group.createDataSet(name, H5::PredType::NATIVE_DOUBLE, space)
      .write(values.data(), H5::PredType::NATIVE_DOUBLE);
}

void WriteHdf5(const fs::path& file, double rate_hz, int sensors, const Values& values) {
  const H5::H5File output(file.string(), H5F_ACC_TRUNC);
  const H5::Group group = output.createGroup("observations");
  AddDataset(group, "timestamp", RowsOf(rate_hz), 1, Times(rate_hz));
  AddDataset(group, "qpos", RowsOf(rate_hz), sensors, Matrix(rate_hz, sensors, values));
}

/// As MATLAB saves `-v7.3`: HDF5 behind 512 bytes of its own, matrices column by column, so that
/// rows and columns are swapped for everybody else.
void WriteMat73(const fs::path& file, double rate_hz, int sensors, const Values& values) {
  constexpr hsize_t kUserBlock = 512;
  {
    H5::FileCreatPropList properties;
    properties.setUserblock(kUserBlock);
    const H5::H5File output(file.string(), H5F_ACC_TRUNC, properties);
    std::vector<double> angles;
    for (int sensor = 0; sensor < sensors; ++sensor) {
      for (int row = 0; row < RowsOf(rate_hz); ++row) angles.push_back(values(row, sensor));
    }
    const H5::Group root = output.openGroup("/");
    AddDataset(root, "angles", sensors, RowsOf(rate_hz), angles);
    AddDataset(root, "t", 1, RowsOf(rate_hz), Times(rate_hz));
  }
  std::string head =
      "MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Nov 23 05:00:00 2026 "
      "HDF5 schema 1.00 .";
  head.resize(124, ' ');
  head += std::string("\x00\x02IM", 4);
  std::fstream(file, std::ios::binary | std::ios::in | std::ios::out) << head;
}

// --- JSON ----------------------------------------------------------------------------------------

std::string JsonRows(double rate_hz, const Values& values, bool lines) {
  std::string text = lines ? "" : "{\"glove\": \"right\", \"frames\": [";
  for (int row = 0; row < kSeconds * rate_hz; ++row) {
    if (row > 0) text += lines ? "\n" : ", ";
    text += fmt::format(
        "{{\"timestamp\": {}, \"joints\": {{\"index_mcp\": {}, \"index_pip\": {}, \"thumb\": "
        "{{\"mcp\": {}, \"ip\": {}}}}}}}",
        1.7e9 + row / rate_hz, values(row, 0), values(row, 1), values(row, 2), values(row, 3));
  }
  return text + (lines ? "\n" : "]}");
}

std::string JsonColumns(double rate_hz, int sensors, const Values& values) {
  std::string times, rows;
  for (int row = 0; row < kSeconds * rate_hz; ++row) {
    times += fmt::format("{}{}", row > 0 ? "," : "", 1e3 * row / rate_hz);
    rows += row > 0 ? ",[" : "[";
    for (int sensor = 0; sensor < sensors; ++sensor) {
      rows += fmt::format("{}{}", sensor > 0 ? "," : "", values(row, sensor));
    }
    rows += "]";
  }
  return "{\"time_ms\": [" + times + "], \"flex\": [" + rows + "], \"fingers\": [\"a\", \"b\"]}";
}

const char* const kFive = "thumb,index,middle,ring,pinky";

std::vector<GloveFile> TextFiles() {
  std::vector<GloveFile> files;
  const auto add = [&files](const char* name, double rate_hz, const char* unit, int sensors,
                            std::string bytes) {
    files.push_back({name, rate_hz, unit, sensors, Bytes(std::move(bytes))});
  };
  const auto seconds = [](double rate_hz, const std::string& separator) {
    return [=](int row) { return fmt::format("{:.4f}{}", row / rate_hz, separator); };
  };
  add("comma.csv", 100, "counts", 5,
      Text({.header = "time_s," + std::string(kFive)}, 100, 5, Counts(10, 100), seconds(100, ",")));
  add("decimal_comma.csv", 0, "deg", 4,
      Text({.separator = ";",
            .decimal_comma = true,
            .header = "Zeit;Index_MCP;Index_PIP;Thumb_MCP;Thumb_IP"},
           60, 4, Degrees(60), [](int row) {
             std::string text = fmt::format("{:.5f};", row / 60.0);
             std::ranges::replace(text, '.', ',');
             return text;
           }));
  files.back().question = "column 1 'Zeit' rises by 0.0166";
  add("tab_ms.txt", 50, "deg", 6,
      Text({.separator = "\t",
            .header = "Time (ms)\tThumbMCP\tThumbIP\tIndexMCP\tIndexPIP\tMiddleMCP\tMiddlePIP"},
           50, 6, Degrees(50), [](int row) { return fmt::format("{}\t", 20 * row); }));
  add("blanks.dat", 30, "rad", 5, Text({.separator = "  "}, 30, 5, Radians(30), seconds(30, "  ")));
  add("crlf_mark_epoch_ms.csv", 100, "counts", 5,
      Text({.line_end = "\r\n",
            .before = "\xEF\xBB\xBF",
            .header = "Timestamp,flex1,flex2,flex3,flex4,flex5"},
           100, 5, Counts(12, 100),
           [](int row) { return fmt::format("{},", 1700000000000 + 10L * row); }));
  add("no_time_label.csv", 0, "share", 5,
      Text({.header = "label,ch0_norm,ch1_norm,ch2_norm,ch3_norm,ch4_norm"}, 50, 5, Shares(50),
           [](int) { return "V,"; }));
  add("iso_volts.csv", 20, "unknown", 5,
      Text({.header = "datetime," + std::string(kFive)}, 20, 5, Volts(20),
           [](int row) { return "2024-05-31T" + Clock(row, 20, '.') + "Z,"; }));
  files.back().question = "of an unknown unit; --unit deg, rad, counts";
  add("date_and_clock.csv", 25, "counts", 5,
      Text({.header = "Date,Time," + std::string(kFive)}, 25, 5, Counts(10, 25),
           [](int row) { return "31.05.2024," + Clock(row, 25, '.') + ","; }));
  add("clock_comma.csv", 40, "deg", 4,
      Text({.separator = ";",
            .decimal_comma = true,
            .header = "clock;index_mcp;index_pip;ring_mcp;ring_pip"},
           40, 4, Degrees(40), [](int row) { return Clock(row, 40, ',') + ";"; }));
  add("time_parts.csv", 50, "deg", 4,
      Text({.header = "hour,minute,second,millisecond,index_mcp,index_pip,ring_mcp,ring_pip"}, 50,
           4, Degrees(50), [](int row) {
             const int ms = 59000 + 20 * row;
             return fmt::format("13,{},{},{},", 58 + ms / 60000, ms / 1000 % 60, ms % 1000);
           }));
  add("software_header.csv", 100, "deg", 3,
      Text({.before = "Glove Studio 2.1\nSerial;17;B\nSensors,3\n\n",
            .header = "t,index_mcp,index_pip,thumb_ip"},
           100, 3, Degrees(100), seconds(100, ",")));
  add("names_and_units.csv", 100, "deg", 3,
      Text({.before = "time,index_mcp,index_pip,thumb_ip\n", .header = "s,deg,deg,deg"}, 100, 3,
           Degrees(100), seconds(100, ",")));
  add("numpy_savetxt.txt", 60, "rad", 3,
      Text({.separator = " ", .header = "# t index_mcp index_pip thumb_ip"}, 60, 3, Radians(60),
           seconds(60, " ")));
  add("pandas_index.csv", 50, "counts", 5,
      Text({.header = kFive}, 50, 5, Counts(10, 50),
           [](int row) { return fmt::format("{},", row); }));
  files.back().rate_hz = 0;  // only numbers of rows
  add("cyberglove_us.csv", 100, "counts", 21,
      Text({.header = "timestamp," + Numbered("s", 22)}, 100, 22, Counts(16, 100),
           [](int row) { return fmt::format("{},", 1700000000000000 + 10000L * row); }));
  files.back().sensors = 0;  // as many as a CyberGlove has, but not its range: one fact
  files.back().question = "22 sensors";
  add("ros_ns.csv", 80, "rad", 5,
      Text({.header = "time," + std::string(kFive)}, 80, 5, Radians(80),
           [](int row) { return fmt::format("{},", 1700000000000000000 + 12500000L * row); }));
  add("ros_stamps.csv", 50, "rad", 5,
      Text({.header = "header.stamp.secs,header.stamp.nsecs," + std::string(kFive)}, 50, 5,
           Radians(50), [](int row) {
             return fmt::format("{},{},", 1700000000 + row / 50, 20000000L * (row % 50));
           }));
  add("eighteen_bytes.txt", 90, "counts", 18,
      Text({.separator = " "}, 90, 18, Counts(8, 90), seconds(90, " ")));
  files.back().sensors = 15;  // as above
  add("with_motion_sensor.csv", 100, "counts", 5,
      Text(
          {.header =
               "t_ms,thumb,index,middle,ring,little,ax,ay,az,gx,gy,gz,qw,qx,qy,qz,temperature"},
          100, 5, Counts(12, 100), [](int row) { return fmt::format("{},", 10 * row); },
          [](int row) {
            std::string more;
            for (int i = 0; i < 10; ++i) more += fmt::format(",{:.3f}", Noise(row, 100 + i));
            return more + ",24.5";
          }));
  add("negative_flexion.csv", 100, "rad", 3,
      Text(
          {.header = "time,index_mcp,index_pip,middle_pip"}, 100, 3,
          [](int row, int sensor) { return -Radians(100)(row, sensor); }, seconds(100, ",")));
  add("ten_hz.csv", 10, "deg", 5,
      Text({.header = "time," + std::string(kFive)}, 10, 5, Degrees(10), seconds(10, ",")));
  add("unicode_text.txt", 50, "deg", 3,
      Utf16(Text(
          {.separator = "\t", .line_end = "\r\n", .header = "time\tindex_mcp\tindex_pip\tthumb_ip"},
          50, 3, Degrees(50), seconds(50, "\t"))));
  add("quoted.csv", 50, "counts", 5,
      Text(
          {.quoted = true, .header = "\"time\",\"thumb\",\"index\",\"middle\",\"ring\",\"little\""},
          50, 5, Counts(10, 50), [](int row) { return fmt::format("\"{:.2f}\",", row / 50.0); }));
  return files;
}

}  // namespace

void WriteCellMat(const fs::path& file) {
  std::array<std::size_t, 2> size = {1, 2};
  matvar_t* const cells = Mat_VarCreate("data", MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0);
  for (int i = 0; i < 2; ++i) {
    std::vector<double> values;
    for (int k = 0; k < 200; ++k) values.push_back(AngleDeg(k, i, 50.0));
    Mat_VarSetCell(cells, i, MatVariable("", 100, 2, values));
  }
  WriteMat(file, {cells});
}

std::vector<GloveFile> GloveFiles() {
  std::vector<GloveFile> files = TextFiles();
  const auto shape = [](int rows, int columns) { return fmt::format("({}, {})", rows, columns); };
  files.push_back({"stored.npz", 100, "rad", 16,
                   Bytes(Zip({{"t.npy", Npy<double>("<f8", "(300,)", Times(100))},
                              {"joints.npy",
                               Npy<double>("<f8", shape(300, 16), Matrix(100, 16, Radians(100)))}},
                             false))});
  files.back().sensors = 0;
  files.back().question = "16 sensors [rad], whose joints are unknown";
  files.push_back(
      {"deflated.npz", 60, "deg", 5,
       Bytes(Zip({{"fs.npy", Npy<double>("<f8", "()", {60.0})},
                  {"flex.npy", Npy<float>("<f4", shape(180, 5), Matrix(60, 5, Degrees(60)))}},
                 true))});
  files.push_back({"array.npy", 0, "counts", 5,
                   Bytes(Npy<std::int16_t>("<i2", shape(150, 5), Matrix(50, 5, Counts(12, 50))))});
  files.push_back({"structure.mat", 100, "deg", 5,
                   [](const fs::path& file) { WriteStructMat(file, 100, 5, Degrees(100)); }});
  files.push_back({"turned.mat", 100, "unknown", 5,
                   [](const fs::path& file) { WriteTurnedMat(file, 100, 5, Volts(100)); }});
  files.back().question = "of an unknown unit; --unit deg, rad, counts";
  files.push_back({"seven_three.mat", 100, "rad", 5,
                   [](const fs::path& file) { WriteMat73(file, 100, 5, Radians(100)); }});
  files.push_back({"robot.hdf5", 50, "rad", 14,
                   [](const fs::path& file) { WriteHdf5(file, 50, 14, Radians(50)); }});
  files.back().sensors = 0;  // qpos is a robot's: two arms of seven joints, as well as a hand
  files.back().question = "14 sensors [rad], whose joints are unknown";
  files.push_back({"frames.json", 60, "deg", 4, Bytes(JsonRows(60, Degrees(60), false))});
  files.push_back({"lines.jsonl", 50, "rad", 4, Bytes(JsonRows(50, Radians(50), true))});
  files.push_back({"columns.json", 100, "counts", 5, Bytes(JsonColumns(100, 5, Counts(12, 100)))});
  return files;
}

}  // namespace gauntlet::test
