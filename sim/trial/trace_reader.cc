#include "sim/trial/trace_reader.h"

#include <H5Cpp.h>
#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/base/input_file.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

// --- in the helper: from HDF5 to the stream -----------------------------------------------------

/// Values that are read at a time.
constexpr hsize_t kBlockValues = 65'536;

const H5::PredType& MemoryType(float) { return H5::PredType::NATIVE_FLOAT; }
const H5::PredType& MemoryType(int) { return H5::PredType::NATIVE_INT; }
const H5::PredType& MemoryType(std::uint8_t) { return H5::PredType::NATIVE_UINT8; }

/// The texts of an attribute, of fixed or variable length.
std::vector<std::string> ReadTexts(const H5::H5Object& object, const char* name) {
  const H5::Attribute attribute = object.openAttribute(name);
  const H5::StrType type = attribute.getStrType();
  const auto count = static_cast<std::size_t>(attribute.getSpace().getSimpleExtentNpoints());
  std::vector<std::string> texts;
  if (count == 0) return texts;
  if (type.isVariableStr()) {
    std::vector<char*> pointers(count);
    attribute.read(type, static_cast<void*>(pointers.data()));
    for (const char* pointer : pointers) texts.emplace_back(pointer != nullptr ? pointer : "");
    return texts;  // the helper ends soon: nothing is freed
  }
  const std::size_t size = type.getSize();
  std::string bytes(count * size, '\0');
  attribute.read(type, bytes.data());
  for (std::size_t i = 0; i < count; ++i) {
    const std::string field = bytes.substr(i * size, size);
    texts.emplace_back(field.c_str());
  }
  return texts;
}

std::string ReadText(const H5::H5Object& object, const char* name) {
  const std::vector<std::string> texts = ReadTexts(object, name);
  return texts.empty() ? "" : texts.front();
}

double ReadNumber(const H5::H5Object& object, const char* name) {
  const H5::Attribute attribute = object.openAttribute(name);
  if (attribute.getSpace().getSimpleExtentNpoints() != 1) {
    throw H5::AttributeIException(name, "is not one number");
  }
  double value = 0.0;
  attribute.read(H5::PredType::NATIVE_DOUBLE, &value);
  return value;
}

/// Sends a signal block by block. `Value`: what stands in the file.
template <class Value>
void SendMatrix(const H5::DataSet& dataset, TraceSender& sender) {
  hsize_t size[2] = {0, 0};
  H5::DataSpace place_in_file = dataset.getSpace();
  if (place_in_file.getSimpleExtentNdims() != 2) {
    throw H5::DataSetIException("signal", "has not two dimensions");
  }
  place_in_file.getSimpleExtentDims(size);
  sender.Size(size[0], size[1]);
  if (size[1] == 0) return;
  const hsize_t block_rows = std::max<hsize_t>(kBlockValues / size[1], 1);
  std::vector<Value> block(std::min(block_rows, size[0]) * size[1]);
  for (hsize_t row = 0; row < size[0]; row += block_rows) {
    const hsize_t begin[2] = {row, 0};
    const hsize_t count[2] = {std::min(block_rows, size[0] - row), size[1]};
    place_in_file.selectHyperslab(H5S_SELECT_SET, count, begin);
    dataset.read(block.data(), MemoryType(Value{}), H5::DataSpace(2, count), place_in_file);
    sender.Values(std::span<const Value>(block).first(count[0] * count[1]));
  }
}

/// A row of a table of stretches. Its texts stay as long as the helper.
struct StretchRow {
  const char* name = nullptr;
  const char* channel = nullptr;
  int begin = 0;
  int end = 0;
};

/// Sends a table of stretches: the ticks of all, then their names and channels. A file may lack it.
void SendStretches(const H5::Group& group, const char* table, const char* name_column,
                   TraceSender& sender) {
  std::vector<StretchRow> rows;
  if (group.nameExists(table)) {
    H5::StrType text(H5::PredType::C_S1, H5T_VARIABLE);
    text.setCset(H5T_CSET_UTF8);
    const H5::CompType row(sizeof(StretchRow));
    row.insertMember(name_column, HOFFSET(StretchRow, name), text);
    row.insertMember("channel", HOFFSET(StretchRow, channel), text);
    row.insertMember("begin_sample", HOFFSET(StretchRow, begin), H5::PredType::NATIVE_INT);
    row.insertMember("end_sample", HOFFSET(StretchRow, end), H5::PredType::NATIVE_INT);
    const H5::DataSet dataset = group.openDataSet(table);
    rows.resize(static_cast<std::size_t>(dataset.getSpace().getSimpleExtentNpoints()));
    if (!rows.empty()) dataset.read(rows.data(), row);
  }
  std::vector<int> ticks;
  for (const StretchRow& row : rows) ticks.insert(ticks.end(), {row.begin, row.end});
  sender.Size(rows.size(), 2);
  sender.Values(std::span<const int>(ticks));
  for (const StretchRow& row : rows) {
    sender.Text(row.name != nullptr ? row.name : "");
    sender.Text(row.channel != nullptr ? row.channel : "");
  }
}

void SendController(const H5::H5File& input, const std::string& name, TraceSender& sender) {
  sender.Text(name);
  const H5::Group group = input.openGroup("controllers/" + name);
  const Trace none;
  ForEachSignal(none, [&]<class Scalar>(const TraceSignal<Scalar>& signal, const auto&) {
    const std::string dataset(signal.name);
    if (!group.nameExists(dataset)) return sender.Size(0, 0);
    SendMatrix<Stored<Scalar>>(group.openDataSet(dataset), sender);
  });
  sender.Text(ReadText(group, "health"));
}

void SendTrace(const std::filesystem::path& file, const std::vector<std::string>& only,
               const HelperProcess::Send& send) {
  H5::Exception::dontPrint();
  H5PLset_loading_state(0);  // no plugins: a file can name any
  const H5::H5File input(file.string(), H5F_ACC_RDONLY);
  OpenNoMoreFiles();  // a file can also say that a part of it is in another
  TraceSender sender(send);
  sender.Text(ReadText(input, "scenario"));
  sender.Number(ReadNumber(input, "seed"));
  const H5::Group glove = input.openGroup("glove");
  const H5::DataSet truth = glove.openDataSet("true_angle_rad");
  const H5::DataSet reference = glove.openDataSet("reference_angle_rad");
  sender.Number(ReadNumber(truth, "rate_hz"));
  sender.Texts(ReadTexts(truth, "columns"));
  sender.Texts(ReadTexts(reference, "columns"));
  SendMatrix<float>(truth, sender);
  SendMatrix<float>(reference, sender);
  SendMatrix<float>(glove.openDataSet("counts"), sender);
  SendStretches(glove, "segments", "label", sender);
  SendStretches(glove, "masked", "reason", sender);
  std::vector<std::string> controllers = ReadTexts(input, "controllers");
  if (!only.empty()) {
    std::erase_if(controllers, [&only](const std::string& name) {
      return std::ranges::find(only, name) == only.end();
    });
  }
  sender.Number(static_cast<double>(controllers.size()));
  for (const std::string& controller : controllers) SendController(input, controller, sender);
}

// --- in the program: from the stream to a trace -------------------------------------------------

constexpr std::size_t kMostControllers = 10'000;

[[noreturn]] void Fail(const std::string& signal, const std::string& problem) {
  throw UserError({.key = signal, .problem = problem});
}

void CheckColumns(const std::string& signal, const Signal& matrix,
                  const std::vector<std::string>& names) {
  if (matrix.cols() == std::ssize(names)) return;
  Fail(signal, fmt::format("has {} columns, must have {}", matrix.cols(), names.size()));
}

void CheckFinite(const std::string& signal, const Signal& matrix) {
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    if (!matrix.col(c).allFinite()) Fail(signal, "has values that are no finite numbers");
    TrimSignals();
  }
}

void CheckGlove(const TraceFile& file) {
  if (!(file.tick_rate_hz >= 1.0) || !(file.tick_rate_hz <= 1e6)) {
    Fail("glove.true_angle_rad", fmt::format("rate_hz is {}, must be 1 .. 1e6", file.tick_rate_hz));
  }
  CheckColumns("glove.true_angle_rad", file.true_angle_rad, file.channel_names);
  CheckColumns("glove.counts", file.counts, file.channel_names);
  CheckColumns("glove.reference_angle_rad", file.reference_angle_rad, file.joint_names);
  CheckFinite("glove.true_angle_rad", file.true_angle_rad);
  CheckFinite("glove.reference_angle_rad", file.reference_angle_rad);
  const Eigen::Index ticks = file.true_angle_rad.rows();
  if (file.reference_angle_rad.rows() != ticks || file.counts.rows() > ticks) {
    Fail("glove", fmt::format("{} rows of true angles, {} of reference angles, {} of counts", ticks,
                              file.reference_angle_rad.rows(), file.counts.rows()));
  }
}

/// Takes a table of stretches, row by row, each within the glove's ticks.
void ReceiveStretches(const std::string& table, TraceReceiver& receiver, const TraceFile& file,
                      const std::function<void(const std::string& name, const std::string& channel,
                                               int begin, int end)>& take) {
  IntegerSignal ticks;
  receiver.Matrix(ticks);
  if (ticks.cols() != 2) Fail(table, fmt::format("has {} numbers in a row", ticks.cols()));
  const Eigen::Index all = file.true_angle_rad.rows();
  for (Eigen::Index row = 0; row < ticks.rows(); ++row) {
    const int begin = ticks(row, 0), end = ticks(row, 1);
    if (begin < 0 || begin > end || end > all) {
      Fail(table, fmt::format("has ticks {} to {}, the motion {}", begin, end, all));
    }
    const std::string name = receiver.Text();
    take(name, receiver.Text(), begin, end);
  }
}

void ReceiveSegments(TraceReceiver& receiver, TraceFile& file) {
  ReceiveStretches("glove.segments", receiver, file,
                   [&file](const std::string& label, const std::string&, int begin, int end) {
                     file.segments.push_back({.label = label, .begin = begin, .end = end});
                   });
}

void ReceiveMasked(TraceReceiver& receiver, TraceFile& file) {
  const std::string table = "glove.masked";
  ReceiveStretches(
      table, receiver, file,
      [&](const std::string& reason, const std::string& channel, int begin, int end) {
        const auto known = std::ranges::find(kMaskReasonNames, reason);
        if (known == kMaskReasonNames.end()) Fail(table, "has a reason that is none");
        const auto named = std::ranges::find(file.channel_names, channel);
        if (named == file.channel_names.end()) Fail(table, "has a channel that the glove lacks");
        file.masked.push_back({.reason = static_cast<MaskReason>(known - kMaskReasonNames.begin()),
                               .channel = static_cast<int>(named - file.channel_names.begin()),
                               .begin = begin,
                               .end = end});
      });
}

/// Checks a name as a scenario's names are checked.
void CheckName(const TraceFile& file, const std::string& name) {
  const auto is_allowed = [](unsigned char letter) {
    return std::isalnum(letter) != 0 || std::string_view("_-+").find(letter) != std::string::npos;
  };
  if (name.empty() || !std::ranges::all_of(name, is_allowed)) {
    Fail("controllers", "a name has letters, digits, _, - and + only");
  }
  if (std::ranges::find(file.traces, name, &Trace::controller_name) != file.traces.end()) {
    Fail("controllers", name + " appears twice");
  }
}

/// Columns that a signal must have; one that is optional may have none.
struct Width {
  Eigen::Index columns;
  bool is_optional;
};

Width WidthOf(const TraceFile& file, const Trace& trace, TraceColumns columns,
              std::string_view signal) {
  switch (columns) {
    case TraceColumns::kChannels:
      return {std::ssize(file.channel_names), false};
    case TraceColumns::kJoints:  // an earlier version kept no targets
      return {std::ssize(file.joint_names), signal == "target_angle_rad"};
    case TraceColumns::kMotors:  // nor limits
      return {trace.command_counts.cols(), signal == "motor_at_limit"};
    case TraceColumns::kCables:
      return {trace.tension_n.cols(), false};
    case TraceColumns::kGrip:
    case TraceColumns::kDigits:
    case TraceColumns::kLinks:
      return {1, true};
    case TraceColumns::kPose:
      return {7, true};
    case TraceColumns::kForces:
      return {2, true};
    case TraceColumns::kPalm:
      return {3, true};
    case TraceColumns::kSensors:
      return {std::ssize(file.joint_names), true};
  }
  return {0, true};
}

/// `trace` against the glove's signals, and its own against each other.
void CheckTrace(const TraceFile& file, const Trace& trace) {
  const Eigen::Index ticks = trace.hand_angle_rad.rows();
  ForEachSignal(trace, [&](const auto& signal, const auto& matrix) {
    const std::string name =
        fmt::format("controllers.{}.{}", trace.controller_name, std::string(signal.name));
    const Width width = WidthOf(file, trace, signal.columns, signal.name);
    if (matrix.cols() != width.columns && !(width.is_optional && matrix.cols() == 0)) {
      Fail(name, fmt::format("has {} columns, must have {}", matrix.cols(), width.columns));
    }
    if (matrix.cols() > 0 && matrix.rows() != ticks) {
      Fail(name, fmt::format("has {} rows, hand_angle_rad has {}", matrix.rows(), ticks));
    }
    if constexpr (std::is_same_v<std::decay_t<decltype(matrix)>, Signal>) {
      // Joint sensors say nothing before their first reading.
      if (signal.columns != TraceColumns::kSensors) CheckFinite(name, matrix);
    }
  });
  const Eigen::Index most = file.true_angle_rad.rows();
  if (ticks > most || (trace.health.ok && ticks < most)) {
    Fail("controllers." + trace.controller_name,
         fmt::format("has {} rows, the glove {}", ticks, most));
  }
}

Trace ReceiveController(TraceReceiver& receiver, TraceFile& file) {
  Trace trace;
  trace.controller_name = receiver.Text();
  CheckName(file, trace.controller_name);
  ForEachSignal(trace, [&](const auto&, auto& matrix) { receiver.Matrix(matrix); });
  const std::string health = receiver.Text();
  trace.health = {.ok = health == "ok", .problem = health == "ok" ? "" : health};
  CheckTrace(file, trace);
  return trace;
}

}  // namespace

TraceFile ReceiveTrace(const TraceReceiver::Receive& receive, std::uintmax_t file_bytes) {
  TraceReceiver receiver(receive, file_bytes);
  TraceFile file;
  file.scenario = receiver.Text();
  const double seed = receiver.Number();
  if (!(seed >= 0.0 && seed <= 2147483647.0)) Fail("seed", fmt::format("is {}", seed));
  file.seed = static_cast<int>(seed);
  file.tick_rate_hz = receiver.Number();
  file.channel_names = receiver.Texts();
  file.joint_names = receiver.Texts();
  receiver.Matrix(file.true_angle_rad);
  receiver.Matrix(file.reference_angle_rad);
  receiver.Matrix(file.counts);
  CheckGlove(file);
  ReceiveSegments(receiver, file);
  ReceiveMasked(receiver, file);
  const double controllers = receiver.Number();
  if (!(controllers >= 0.0 && controllers <= kMostControllers)) {
    Fail("controllers", fmt::format("has {} names", controllers));
  }
  for (int i = 0; i < controllers; ++i) file.traces.push_back(ReceiveController(receiver, file));
  return file;
}

TraceFile ReadTraceFile(const std::filesystem::path& file, const TraceReading& reading) {
  const std::string place = file.string();
  const std::uintmax_t size = std::filesystem::file_size(InputFile(file));

  HelperLimits limits;
  limits.processor_s = reading.processor_s;
  if (!(limits.processor_s > 0.0)) {
    constexpr double kStart_s = 2.0;
    constexpr double kPerByte_s = 1e-7;  // some 50 times as long as it takes
    limits.processor_s = kStart_s + kPerByte_s * static_cast<double>(size);
  }
  try {
    HelperProcess helper(
        [&](const HelperProcess::Send& send) {
          try {
            SendTrace(file, reading.only, send);
          } catch (const H5::Exception& exception) {
            throw UserError(exception.getDetailMsg());
          }
        },
        limits, reading.keep_going);
    TraceFile trace =
        ReceiveTrace([&helper](std::span<char> bytes) { helper.Receive(bytes); }, size);
    helper.Finish();
    return trace;
  } catch (const HelperEnded& ended) {
    throw UserError(
        {.place = place,
         .problem = fmt::format("is damaged: the process that read it {}", ended.what())});
  } catch (const HelperSilent& silent) {
    throw RunError(fmt::format("{}: the process that reads it {}", place, silent.what()));
  } catch (const HelperError& problem) {
    throw UserError({.place = place,
                     .problem = fmt::format("is not a trace file of Gauntlet, or damaged ({})",
                                            problem.what())});
  } catch (const UserError& problem) {
    throw UserError({.place = place, .key = problem.key(), .problem = problem.problem()});
  }
}

}  // namespace gauntlet::sim
