#include "tests/cli/glove_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace gauntlet::test {
namespace {

using Formula = std::function<double(int row)>;
using Joints = std::map<std::string, std::string>;

constexpr int kRows = 120;
constexpr double kPi = 3.14159265358979323846;
const std::array<std::string, 5> kFingers = {"thumb", "index", "middle", "ring", "little"};
const std::array<std::string, 5> kFlex5 = {"thumb_ip", "index_pip", "middle_pip", "ring_pip",
                                           "little_pip"};

/// Noise of about one, the same every time.
double Noise(int row, int sensor) {
  const double mixed = std::sin(12.9898 * row + 78.233 * sensor) * 43758.5453;
  return 2.0 * (mixed - std::floor(mixed)) - 1.0;
}

/// What a joint does at 50 to 100 Hz, 5 to 75 degrees.
double AngleDeg(int row, int sensor) {
  return 40.0 + 34.0 * std::sin(0.05 * row * (1.0 + 0.1 * sensor) + sensor) +
         0.3 * Noise(row, sensor);
}
Formula Degrees(int sensor) {
  return [=](int row) { return std::round(1e3 * AngleDeg(row, sensor)) / 1e3; };
}
Formula Radians(int sensor) {
  return [=](int row) { return std::round(1e5 * AngleDeg(row, sensor) * kPi / 180.0) / 1e5; };
}
Formula Counts(int sensor, double full) {
  return [=](int row) { return std::round(full * (0.3 + AngleDeg(row, sensor) / 180.0)); };
}
Formula Shares(int sensor) {
  return [=](int row) { return std::clamp((AngleDeg(row, sensor) - 8.0) / 60.0, 0.0, 1.0); };
}
Formula Always(double value) {
  return [value](int) { return value; };
}
Formula Clock(double step, double start = 0.0) {
  return [=](int row) { return start + step * row; };
}
Formula Wave(double amplitude, double phase) {
  return [=](int row) { return amplitude * std::sin(0.03 * row + phase); };
}

/// A table of columns with names.
class Table {
 public:
  Table& Add(std::string name, Formula value) {
    columns_.emplace_back(std::move(name), std::move(value));
    return *this;
  }
  std::string Text(const std::string& separator = ",", bool has_header = true) const {
    std::string text;
    if (has_header) {
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        text += (c > 0 ? separator : "") + columns_[c].first;
      }
      text += "\n";
    }
    for (int row = 0; row < kRows; ++row) text += Row(row, separator) + "\n";
    return text;
  }
  /// A row per column, with its name in front if it has one.
  std::string Turned(const std::string& separator = ",") const {
    std::string text;
    for (const auto& [name, value] : columns_) {
      text += name;
      for (int row = 0; row < kRows; ++row) {
        text += (row > 0 || !name.empty() ? separator : "") + Cell(value(row));
      }
      text += "\n";
    }
    return text;
  }
  std::string Row(int row, const std::string& separator) const {
    std::string text;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      text += (c > 0 ? separator : "") + Cell(columns_[c].second(row));
    }
    return text;
  }
  static std::string Cell(double value) { return fmt::format("{}", value); }

 private:
  std::vector<std::pair<std::string, Formula>> columns_;
};

/// Five sensors `name1` .. or a finger's name each, in the order of the fingers.
Joints AddFive(Table& table, const std::string& name, int first,
               const std::function<Formula(int sensor)>& values) {
  Joints joints;
  for (int i = 0; i < 5; ++i) {
    const std::string column = fmt::format("{}{}", name, first + i);
    table.Add(column, values(i));
    joints[column] = kFlex5[i];
  }
  return joints;
}

/// mcp and pip of four fingers; `pattern` has a place for the finger and one for the joint.
Joints AddEight(Table& table, const std::string& pattern, const std::function<Formula(int)>& values,
                bool is_capital = false) {
  Joints joints;
  int sensor = 0;
  for (std::size_t f = 1; f < kFingers.size(); ++f) {
    for (std::string joint : {"mcp", "pip"}) {
      std::string finger = kFingers[f];
      const std::string channel = finger + "_" + joint;
      if (is_capital) {
        finger[0] = static_cast<char>(finger[0] - 32);
        for (char& letter : joint) letter = static_cast<char>(letter - 32);
      }
      const std::string column = fmt::format(fmt::runtime(pattern), finger, joint);
      table.Add(column, values(sensor++));
      joints[column] = channel;
    }
  }
  return joints;
}

void AddAxes(Table& table, const std::string& stem, const std::string& axes, double amplitude) {
  for (const char axis : axes) table.Add(stem + axis, Wave(amplitude, axis));
}

void AddTips(Table& table, const std::string& pattern, bool is_capital = false) {
  for (std::string finger : kFingers) {
    if (is_capital) finger[0] = static_cast<char>(finger[0] - 32);
    for (const char axis : std::string(is_capital ? "XYZ" : "xyz")) {
      table.Add(fmt::format(fmt::runtime(pattern), finger, axis), Wave(0.2, axis));
    }
  }
}

using Shapes = std::vector<GloveShape>;

void AddPositionsAndAngles(Shapes& shapes) {
  const auto add = [&shapes](const Table& table, const char* unit, const Joints& joints,
                             double hz) {
    shapes.push_back({fmt::format("positions_{}", shapes.size()), table.Text(), hz, unit, joints});
  };
  Table manus;
  manus.Add("Frame", Clock(1)).Add("Elapsed_Time_In_Milliseconds", Clock(12.5));
  AddTips(manus, "{}_TIP_Position_{}", true);
  add(manus, "deg", AddEight(manus, "{}_{}_Flex", Degrees, true), 80);
  Table radians;
  radians.Add("time_s", Clock(0.01));
  const Joints of_radians = AddEight(radians, "{}_{}_rad", Radians);
  AddTips(radians, "{}_tip_{}");
  add(radians, "rad", of_radians, 100);
  Table both;
  both.Add("t", Clock(0.02));
  AddTips(both, "{}.position.{}");
  AddEight(both, "{}_{}_raw", [](int sensor) { return Counts(sensor, 4095); });
  add(both, "deg", AddEight(both, "{}_{}_deg", Degrees), 50);
  shapes.back().question = "index_mcp_raw and index_mcp_deg both name index_mcp";
  shapes.back().map_answers = true;
  Table quaternions;
  quaternions.Add("timestamp_ms", Clock(10));
  for (const std::string& finger : kFingers) AddAxes(quaternions, finger + "_q", "wxyz", 0.7);
  add(quaternions, "deg", AddEight(quaternions, "{}_{}_angle_deg", Degrees), 100);
  Table velocities;
  velocities.Add("time", Clock(0.01));
  AddEight(velocities, "{}_{}_velocity", [](int sensor) { return Wave(200, sensor); });
  add(velocities, "deg", AddEight(velocities, "{}_{}_deg", Degrees), 100);
  Table confident;
  confident.Add("time_us", Clock(16666.7));
  const Joints of_confident = AddEight(confident, "{}_{}_deg", Degrees);
  AddEight(confident, "{}_{}_confidence", Shares);
  AddAxes(confident, "palm_", "xyz", 0.4);
  add(confident, "deg", of_confident, 60);
}

/// Without names: time, five sensors and a quaternion.
void AddNamelessMotionSensor(Shapes& shapes) {
  Table nameless;
  nameless.Add("", Clock(0.01));
  for (int i = 0; i < 5; ++i) nameless.Add("", Counts(i, 1023));
  nameless.Add("", [](int row) { return std::cos(0.02 * row); }).Add("", [](int row) {
    return std::sin(0.02 * row) * std::cos(0.03 * row);
  });
  nameless.Add("", [](int row) { return std::sin(0.02 * row) * std::sin(0.03 * row); });
  nameless.Add("", Always(0.0));
  Joints joints;
  for (int i = 0; i < 5; ++i) joints[std::to_string(i + 2)] = kFlex5[i];
  shapes.push_back({"motion_nameless", nameless.Text(",", false), 100, "counts", joints});
  shapes.back().question = "columns 2 to 10: 9 sensors [unknown], of different sizes";
}

void AddMotionSensors(Shapes& shapes) {
  const auto counts = [](int sensor) { return Counts(sensor, 1023); };
  const auto add = [&shapes](Table& table, const char* unit, const Joints& joints, double hz) {
    shapes.push_back({fmt::format("motion_{}", shapes.size()), table.Text(), hz, unit, joints});
  };
  Table rpy;
  rpy.Add("timestamp_ms", Clock(10));
  for (const char* name : {"roll", "pitch", "yaw"}) rpy.Add(name, Wave(50, *name));
  Joints joints = AddFive(rpy, "flex", 1, counts);
  add(rpy.Add("sampling_hz", [](int row) { return row % 2 == 0 ? 99.5 : 100.5; }), "counts", joints,
      100);
  Table imu;
  imu.Add("millis", Clock(20, 5000));
  joints = AddFive(imu, "bend_", 0, counts);
  AddAxes(imu, "acc_", "xyz", 9.8);
  AddAxes(imu, "gyro_", "xyz", 200);
  add(imu.Add("temp", Always(31.5)), "counts", joints, 50);
  Table quaternion;
  quaternion.Add("t_us", Clock(10000)).Add("packet", Clock(1));
  AddAxes(quaternion, "q", "wxyz", 0.5);
  joints = AddFive(quaternion, "sensor", 1, counts);
  add(quaternion, "counts", joints, 100);
  Table clocks;
  clocks.Add("pc_time_ms", Clock(10, 7e5)).Add("glove_clock_ms", Clock(10.0001, 12));
  joints = AddFive(clocks, "ch", 0, [](int sensor) { return Counts(sensor, 4095); });
  AddAxes(clocks, "m", "xyz", 40);
  add(clocks, "counts", joints, 100);
  Table named;
  named.Add("time", Clock(0.02));
  for (std::size_t i = 0; i < kFingers.size(); ++i) {
    named.Add(kFingers[i], counts(static_cast<int>(i)));
  }
  AddAxes(named, "LinAcc", "XYZ", 4);
  named.Add("battery", [](int row) { return 3.9 - 0.001 * row; });
  add(named, "counts",
      {{"thumb", "thumb_ip"},
       {"index", "index_pip"},
       {"middle", "middle_pip"},
       {"ring", "ring_pip"},
       {"little", "little_pip"}},
      50);
}

void AddDeadSensors(Shapes& shapes) {
  for (int dead = 0; dead < 6; ++dead) {
    Table table;
    table.Add("time_s", Clock(0.02));
    const bool is_share = dead % 2 == 0;
    Joints joints = AddFive(table, is_share ? "ch" : "flex", 1 - dead % 2, [&](int sensor) {
      if (sensor == dead || (dead == 5 && sensor > 2)) return Always(is_share ? 1.0 : 1023.0);
      return is_share ? Shares(sensor) : Counts(sensor, 1023);
    });
    for (auto joint = joints.begin(); joint != joints.end();) {
      const auto place = std::ranges::find(kFlex5, joint->second) - kFlex5.begin();
      joint = place == dead || (dead == 5 && place > 2) ? joints.erase(joint) : std::next(joint);
    }
    shapes.push_back(
        {fmt::format("dead_{}", dead), table.Text(), 50, is_share ? "share" : "counts", joints});
  }
}

/// Lists as numpy prints them, `names` of five or more numbers each.
std::string ListTable(const std::vector<std::pair<std::string, int>>& lists, const char* cell,
                      const std::string& between) {
  std::string text;
  for (const auto& [name, size] : lists) text += "," + name;
  text += ",timestamp,frame_index,episode_index,index,task_index\n";
  for (int row = 0; row < kRows; ++row) {
    text += std::to_string(row);
    for (const auto& [name, size] : lists) {
      std::string list;
      for (int i = 0; i < size; ++i) {
        list += (i > 0 ? between : "") + Table::Cell(Degrees(i)(row + (name[0] == 'a' ? 3 : 0)));
      }
      text += "," + fmt::format(fmt::runtime(cell), list);
    }
    text += fmt::format(",{:.5f},{},0,{},0\n", row / 50.0, row, row);
  }
  return text;
}

void AddLists(Shapes& shapes) {
  const std::string log = "gauntlet identify";
  shapes.push_back(
      {"lists_arm", ListTable({{"action", 6}, {"observation.state", 6}}, "[{}]", " ")});
  shapes.back().question = log;
  shapes.push_back(
      {"lists_lines", ListTable({{"action", 7}, {"observation.state", 7}}, "\"[{}\n ]\"", "  ")});
  shapes.back().question = log;
  shapes.push_back(
      {"lists_commas", ListTable({{"action", 6}, {"observation.state", 6}}, "\"[{}]\"", ", ")});
  shapes.back().question = log;
  shapes.push_back({"lists_flex", ListTable({{"flex", 5}}, "[{}]", " "), 50, "deg"});
  for (int i = 0; i < 5; ++i) shapes.back().joints[fmt::format("flex_{}", i + 1)] = kFlex5[i];
  shapes.push_back({"lists_glove", ListTable({{"glove", 5}}, "\"[{}]\"", ","), 50, "deg"});
  for (int i = 0; i < 5; ++i) shapes.back().joints[fmt::format("glove_{}", i + 1)] = kFlex5[i];
  shapes.push_back({"lists_unknown", ListTable({{"hand", 16}}, "[{}]", " ")});
  shapes.back().question = "16 sensors";
}

void AddTurned(Shapes& shapes) {
  for (const int sensors : {5, 15}) {
    Table table;
    for (int i = 0; i < sensors; ++i) table.Add("", Radians(i));
    table.Add("", Clock(1.0 / 86400 / 50, 738000.25));
    GloveShape shape = {fmt::format("turned_{}", sensors), table.Turned(), 50, "rad"};
    shape.question = sensors == 15 ? "15 sensors" : "of an unknown unit; --unit deg, rad";
    for (int i = 0; i < 5; ++i) shape.joints[std::to_string(i + 1)] = kFlex5[i];
    shapes.push_back(shape);
  }
  Table named;
  named.Add("time_ms", Clock(10));
  Joints joints = AddEight(named, "{}_{}_deg", Degrees);
  shapes.push_back({"turned_names", named.Turned(), 100, "deg", joints});
  shapes.push_back({"turned_blanks", named.Turned(" "), 100, "deg", joints});
  Table five;
  five.Add("t", Clock(0.0125));
  joints = AddFive(five, "flex", 1, [](int sensor) { return Counts(sensor, 1023); });
  shapes.push_back({"turned_semicolons", five.Turned(";"), 80, "counts", joints});
  Table none;
  for (int i = 0; i < 7; ++i) none.Add("", Degrees(i));
  shapes.push_back({"turned_no_time", none.Turned()});
  shapes.back().question = "7 sensors";
}

void AddWithoutHand(Shapes& shapes) {
  const auto add = [&shapes](const Table& table, const char* name, const char* question) {
    shapes.push_back({name, table.Text()});
    shapes.back().question = question;
  };
  Table imu;
  imu.Add("Time_Stamp", [](int row) { return 5e5 + std::floor(row * 9.765625); });
  AddAxes(imu, "Low_Noise_Accelerometer_", "XYZ", 9.8);
  AddAxes(imu, "Gyroscope_", "XYZ", 100);
  add(imu, "none_imu", "no column looks like a sensor of a hand");
  Table emg;
  emg.Add("time", Clock(0.001));
  for (int i = 1; i <= 8; ++i) {
    emg.Add(fmt::format("emg{}", i), [i](int row) { return Noise(row, i); });
  }
  add(emg, "none_emg", "activities of muscles");
  Table weather;
  weather.Add("timestamp", Clock(1, 1.7e9)).Add("humidity", Wave(30, 0)).Add("wind", Wave(8, 1));
  add(weather, "none_weather", "no column looks like a sensor of a hand");
  Table servo;
  servo.Add("time_ms", Clock(10))
      .Add("goal_position", Degrees(1))
      .Add("present_position", Degrees(2));
  add(servo, "none_servo", "gauntlet identify");
  Table pose;
  pose.Add("t", Clock(0.01));
  AddAxes(pose, "hand_position_", "xyz", 0.5);
  AddAxes(pose, "hand_orientation_", "xyzw", 0.5);
  add(pose, "none_pose", "no column looks like a sensor of a hand");
  Table still;
  still.Add("time_s", Clock(0.01));
  for (const std::string& finger : kFingers) still.Add(finger, Always(512));
  add(still, "none_moves", "no sensor of the hand changes");
}

/// Rows as a microcontroller prints them for a plotter, or a logger. `before` and `after` stand
/// around the clock of a row; an empty `after`: there is none.
std::string Labelled(const std::vector<std::string>& labels, const std::string& colon,
                     const std::string& separator, const std::string& before,
                     const std::string& after) {
  std::string text;
  for (int row = 0; row < kRows; ++row) {
    const int ms = 1000 + 25 * row;
    const std::string clock = fmt::format("10:15:{:02}.{:03}", ms / 1000, ms % 1000);
    if (!after.empty()) text += before + clock + after;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      text += (i > 0 ? separator : "") + labels[i] + colon +
              Table::Cell(Counts(static_cast<int>(i), 1023)(row));
    }
    text += "\n";
  }
  return text;
}

void AddLabels(Shapes& shapes) {
  const std::vector<std::string> fingers = {"Thumb", "Index", "Middle", "Ring", "Pinky"};
  const auto add = [&shapes](const std::vector<std::string>& labels, const char* colon,
                             const char* separator, const std::string& after,
                             const char* before = "") {
    shapes.push_back({fmt::format("labels_{}", shapes.size()),
                      Labelled(labels, colon, separator, before, after), after.empty() ? 0.0 : 40.0,
                      "counts"});
    for (std::size_t i = 0; i < 5; ++i) shapes.back().joints[labels[i]] = kFlex5[i];
  };
  add(fingers, ":", "\t", " -> ");
  add(fingers, ":", ",", " -> ");
  add({"flex1", "flex2", "flex3", "flex4", "flex5"}, ":", " ", " -> ");
  add(fingers, "=", " ", "");
  add({"A0", "A1", "A2", "A3", "A4"}, ": ", ", ", " -> ");
  add({"a", "b", "c", "d", "e"}, ":", " ", " -> ");
  add(fingers, ":", " , ", " - ", "2024-05-15 ");
  add(fingers, ":", " ", "] ", "[2024-05-15 ");
}

/// As `ros2 topic echo --csv` prints JointState; `parts` of position, velocity and effort have
/// numbers, the others are empty.
std::string JointState(const std::vector<std::string>& joints, int parts, int rate_hz,
                       const std::function<Formula(int)>& values) {
  std::string text;
  for (int row = 0; row < kRows; ++row) {
    const long long ns = 400000095LL + 1000000000LL / rate_hz * row;
    text += fmt::format("{},{},base_link", 1762000000 + ns / 1000000000, ns % 1000000000);
    for (const std::string& joint : joints) text += "," + joint;
    for (int part = 0; part < parts; ++part) {
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const double value = values(static_cast<int>(i))(row);
        text += "," + Table::Cell(part == 0 ? value : 0.1 * Noise(row, part));
      }
    }
    text += std::string(static_cast<std::size_t>(3 - parts), ',') + "\n";
  }
  return text;
}

void AddJointStates(Shapes& shapes) {
  const std::vector<std::string> joints = {"index_mcp", "index_pip", "middle_mcp", "thumb_ip"};
  Joints same;
  for (const std::string& joint : joints) same[joint + "_rad"] = joint;
  for (const int parts : {1, 2, 3}) {
    shapes.push_back({fmt::format("joint_state_{}", parts), JointState(joints, parts, 100, Radians),
                      100, "rad", same});
  }
  shapes.push_back({"joint_state_slow", JointState(joints, 1, 20, Radians), 20, "rad", same});
  shapes.push_back({"joint_state_arm",
                    JointState({"joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"},
                               1, 100, Radians)});
  shapes.back().question = "6 sensors";
  shapes.push_back(
      {"joint_state_hands",
       JointState({"left_index_mcp", "left_index_pip", "right_index_mcp", "right_index_pip"}, 1, 50,
                  Radians),
       50,
       "rad",
       {{"right_index_mcp_rad", "index_mcp"}, {"right_index_pip_rad", "index_pip"}}});
  shapes.back().options = {"--hand", "right"};
}

/// A time in steps of 10 ms and two joints; `cell` gives what stands between them in a row.
std::string TwoJoints(const std::string& header, const std::function<std::string(int row)>& cell,
                      const std::function<double(int row, int sensor)>& angle_deg) {
  std::string text = header;
  for (int row = 0; row < kRows; ++row) {
    text += fmt::format("{}{:.3f},{:.3f}\n", cell(row), angle_deg(row, 1), angle_deg(row, 2));
  }
  return text;
}

/// Messages as rostopic echo and ros2 topic echo print them.
void AddEchoes(Shapes& shapes, const Joints& joints) {
  std::string ros1, ros2, no_time;
  for (int row = 0; row < kRows; ++row) {
    std::array<double, 3> value = {};
    for (int i = 0; i < 3; ++i) value[i] = Radians(i)(row);
    const int s = 1500000000 + row / 50;
    const int ns = 20000000 * (row % 50);
    ros1 += fmt::format(
        "header: \n  seq: {}\n  stamp: \n    secs: {}\n    nsecs: {}\n  frame_id: ''\n"
        "name: [index_mcp, index_pip, thumb_ip]\nposition: [{}, {}, {}]\nvelocity: []\n"
        "effort: []\n---\n",
        row, s, ns, value[0], value[1], value[2]);
    ros2 += fmt::format(
        "header:\r\n  stamp:\r\n    sec: {}\r\n    nanosec: {}\r\n  frame_id: ''\r\nname:\r\n"
        "- index_mcp\r\n- index_pip\r\n- thumb_ip\r\nposition:\r\n- {}\r\n- {}\r\n- {}\r\n"
        "velocity: []\r\neffort:\r\n- .nan\r\n- .nan\r\n- .nan\r\n---\r\n",
        s, ns, value[0], value[1], value[2]);
    no_time += fmt::format("layout:\n  dim: []\n  data_offset: 0\ndata:\n- {}\n- {}\n---\n",
                           value[0], value[1]);
  }
  shapes.push_back({"echo_ros1", ros1, 50, "rad", joints});
  shapes.push_back({"echo_ros2", ros2, 50, "rad", joints});
  shapes.push_back({"echo_cut", ros1 + "header: \n  seq: 1", 50, "rad", joints});
  shapes.push_back({"echo_no_time", no_time});
  shapes.back().question = "messages without a time in a header";
  const auto list = ros2.find("- thumb_ip");
  shapes.push_back({"echo_shortened", ros2.replace(list, 10, "- '...'   ")});
  shapes.back().question = "shortened lists";
  // Lines above a table that look like the keys of a message.
  shapes.push_back({"echo_none",
                    TwoJoints(
                        "subject: 7\n---\ntime,index_mcp,index_pip\n",
                        [](int row) { return fmt::format("{:.2f},", 0.01 * row); }, AngleDeg),
                    100,
                    "deg",
                    {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}}});
}

/// Files of other tools: rostopic echo -p, opengloves, an Arduino's plotter, names above units,
/// rows in bursts, a clock per hand, a date beside a clock in ms, a servo whose command is held.
void AddOtherTools(Shapes& shapes) {
  const auto counts = [](int sensor) { return Counts(sensor, 4095); };
  std::string text;
  const std::vector<std::string> joints = {"index_mcp", "index_pip", "thumb_ip"};
  for (int row = -1; row < kRows; ++row) {
    text += row < 0 ? "%time,field.header.seq"
                    : fmt::format("{},{}", 1500000000000000000 + 20000000LL * row, row);
    for (int i = 0; i < 3; ++i) text += row < 0 ? fmt::format(",field.name{}", i) : "," + joints[i];
    for (int i = 0; i < 3; ++i) {
      text += row < 0 ? fmt::format(",field.position{}", i) : "," + Table::Cell(Radians(i)(row));
    }
    text += "\n";
  }
  shapes.push_back({"tool_rostopic", text, 50, "rad", {}});
  for (const std::string& joint : joints) shapes.back().joints[joint + "_rad"] = joint;
  AddEchoes(shapes, shapes.back().joints);
  text.clear();
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < 5; ++i) text += fmt::format("{}{}", "ABCDE"[i], counts(i)(row));
    text += row % 7 == 0 ? "F2048G2047P0IL\n" : "F2048G2047P0\n";
  }
  shapes.push_back({"tool_opengloves", text, 0, "counts"});
  for (std::size_t i = 0; i < 5; ++i) {
    shapes.back().joints[kFingers[i]] = kFlex5[i];
  }
  text.clear();
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < 5; ++i) {
      text += fmt::format("{}flex{}:{}", i > 0 ? "," : "", i + 1, counts(i)(row));
    }
    text += "\n";
  }
  shapes.push_back({"tool_plotter", text, 0, "counts"});
  for (int i = 0; i < 5; ++i) shapes.back().joints[fmt::format("flex{}", i + 1)] = kFlex5[i];
  Table units;
  units.Add("time", Clock(10));
  AddEight(units, "{}_{}", Degrees);
  Joints numbers;
  int column = 1;
  for (const auto& finger : {"index", "middle", "ring", "little"}) {
    for (const auto& joint : {"mcp", "pip"}) {
      numbers[std::to_string(++column)] = fmt::format("{}_{}", finger, joint);
    }
  }
  text = units.Text();
  text.insert(text.find('\n') + 1, "[ms],[deg],[deg],[deg],[deg],[deg],[deg],[deg],[deg]\n");
  shapes.push_back({"tool_units", "Glove Studio 2\n\n" + text, 100, "deg", numbers});
  Table bursts;  // eight rows in each packet of 80 ms, a tenth of a millisecond apart
  bursts.Add("time_ms", [](int row) { return 80.0 * (row / 8) + 0.1 * (row % 8); });
  const Joints of_bursts = AddEight(bursts, "{}_{}_deg", Degrees);
  shapes.push_back({"tool_bursts", bursts.Text(), 100, "deg", of_bursts});
  Table hands;
  hands.Add("left_time_ms", Clock(10));
  AddEight(hands, "left_{}_{}_deg", Degrees);
  hands.Add("right_time_ms", Clock(12.5, 37));
  AddEight(hands, "right_{}_{}_deg", Degrees);
  shapes.push_back({"tool_clocks", hands.Text()});
  shapes.back().question = "the joints have a clock of their own, column 10,";
  shapes.back().options = {"--hand", "right"};
  Table dated;
  dated.Add("recv_timestamp_ms", Clock(10, 5000));
  const Joints of_dated = AddEight(dated, "{}_{}_deg", Degrees);
  text = "date," + dated.Text();
  for (std::size_t end = text.find('\n'); end + 1 < text.size(); end = text.find('\n', end + 1)) {
    text.insert(end + 1, "2024-05-31,");
  }
  shapes.push_back({"tool_date", text, 100, "deg", of_dated});
  Table held;
  held.Add("t", Clock(0.02)).Add("command_angle", [](int row) {
    return row / 40 % 2 == 0 ? 20.0 : 90.0;
  });
  held.Add("feedback_angle", [](int row) { return std::round(Degrees(0)(row)); });
  shapes.push_back({"tool_servo", held.Text()});
  shapes.back().question = "then gauntlet identify glove.csv";
}

void AddTurnsAndSigns(Shapes& shapes) {
  const auto turning = [](double start) {
    return
        [start](int row) { return std::fmod(start + 50.0 * std::sin(0.06 * row) + 720.0, 360.0); };
  };
  for (const double start : {0.0, 350.0, 15.0}) {
    Table table;
    table.Add("time", Clock(0.02)).Add("wrist_roll.pos", turning(start));
    table.Add("wrist_flex.pos", Wave(30, 0.5));
    shapes.push_back(
        {fmt::format("turns_{}", start),
         table.Text(),
         50,
         "deg",
         {{"wrist_roll.pos", "forearm_rotation"}, {"wrist_flex.pos", "wrist_flexion"}}});
  }
  for (const bool is_radians : {false, true}) {
    Table table;
    table.Add("time_s", Clock(0.01));
    const Joints joints = AddEight(
        table, is_radians ? "{}_{}_rad" : "{}_{}_deg", [is_radians](int sensor) -> Formula {
          const Formula value = is_radians ? Radians(sensor) : Degrees(sensor);
          return [value](int row) { return -value(row); };
        });
    shapes.push_back({fmt::format("signs_{}", is_radians), table.Text(), 100,
                      is_radians ? "rad" : "deg", joints, true});
  }
  Table wrong;  // the name of the time says seconds, the values are milliseconds
  wrong.Add("time_s", Clock(10));
  shapes.push_back({"signs_time", "", 100, "deg", AddEight(wrong, "{}_{}_deg", Degrees)});
  shapes.back().text = wrong.Text();
  shapes.back().question = "0.1 rows per second, must be from 1 to 10000";
}

void AddNumbers(Shapes& shapes) {
  const auto numbered = [](int sensors, const std::function<Formula(int)>& values) {
    Table table;
    table.Add("time_ms", Clock(10));
    for (int i = 1; i <= sensors; ++i) table.Add(fmt::format("s{}", i), values(i));
    return table;
  };
  const auto bytes = [](int sensor) { return Counts(sensor, 255); };
  GloveShape cyber = {"number_22", numbered(22, bytes).Text(), 100, "counts"};
  const std::array<const char*, 22> kCyber = {"thumb_rotation",
                                              "thumb_mcp",
                                              "thumb_ip",
                                              "thumb_abduction",
                                              "index_mcp",
                                              "index_pip",
                                              "index_dip",
                                              "middle_mcp",
                                              "middle_pip",
                                              "middle_dip",
                                              "finger_spread",
                                              "ring_mcp",
                                              "ring_pip",
                                              "ring_dip",
                                              "",
                                              "little_mcp",
                                              "little_pip",
                                              "little_dip",
                                              "",
                                              "",
                                              "wrist_flexion",
                                              "wrist_deviation"};
  for (int i = 0; i < 22; ++i) {
    if (*kCyber[i] != '\0') cyber.joints[fmt::format("s{}", i + 1)] = kCyber[i];
  }
  shapes.push_back(cyber);
  cyber.name = "number_23_preset";
  cyber.text = numbered(23, bytes).Text();
  cyber.options = {"--preset", "cyberglove22", "--columns", "2-23"};
  shapes.push_back(cyber);
  shapes.push_back({"number_23", numbered(23, bytes).Text()});
  shapes.back().question = "23 sensors";
  shapes.push_back({"number_16_rad", numbered(16, Radians).Text()});
  shapes.back().question = "16 sensors";
  shapes.push_back({"number_7", numbered(7, bytes).Text()});
  shapes.back().question = "7 sensors";
  Table hands;
  hands.Add("t", Clock(0.01));
  for (const char side : {'L', 'R'}) {
    for (int i = 1; i <= 5; ++i) hands.Add(fmt::format("{}_flex{}", side, i), Counts(i, 1023));
  }
  shapes.push_back({"number_hands", hands.Text()});
  shapes.back().question = "--hand left or --hand right";
}

/// Columns that rise as a time does and are none, lines above a table that are as long as its rows,
/// and units that cannot be the same.
void AddRising(Shapes& shapes) {
  const auto add = [&](const char* name, std::string text, double rate_hz, Joints joints) {
    shapes.push_back({name, std::move(text), rate_hz, "deg", std::move(joints)});
  };
  const auto ask = [&](const char* name, std::string text, const char* question) {
    shapes.push_back({name, std::move(text)});
    shapes.back().question = question;
  };
  const Joints two = {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}};
  const auto time = [](int row) { return fmt::format("{:.2f},", 0.01 * row); };
  add("rises_frame",
      TwoJoints(
          "frame,index_mcp,index_pip\n", [](int row) { return fmt::format("{},", 2 * row); },
          AngleDeg),
      50, two);
  add("rises_temp",
      TwoJoints(
          "temp,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{:.1f},", 30 + 0.1 * row); }, AngleDeg),
      50, two);
  ask("rises_joint",
      TwoJoints(
          "time,middle_mcp,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{},{:.4f},", row, 0.6256 * row); }, AngleDeg),
      "column 1 'time' rises by 1 from row to row; --time-unit s, ms");
  add("padded", TwoJoints("Subject,1,\nTrial,3,\n,,\ntime,index_pip,index_mcp\n", time, AngleDeg),
      100, two);
  ask("two_units",
      TwoJoints("time,r_shoulder_elev,r_elbow_flex\n", time,
                [](int row, int sensor) {
                  return sensor == 1 ? 0.3 * std::sin(0.1 * row) : AngleDeg(row, sensor);
                }),
      "a map says the unit of each");
  shapes.back().map_answers = true;
  ask("below_zero",
      TwoJoints(
          "",
          [&](int row) {
            return time(row) + fmt::format("{0:.1f},{0:.1f},{0:.1f},", 9.0 * row - 500);
          },
          [](int row, int sensor) { return 900 * std::sin(0.1 * row + sensor); }),
      "whose joints are unknown");
  std::string points = "Frame#,Time,A,,,B,,,C,,\n,,X1,Y1,Z1,X2,Y2,Z2,X3,Y3,Z3\n,,,,,,,,,,\n";
  for (int row = 0; row < kRows; ++row) {
    points += fmt::format("{},{:.2f}", row + 1, 0.01 * row);
    for (int i = 0; i < 9; ++i) points += "," + Table::Cell(100 * std::sin(0.1 * row + i));
    points += "\n";
  }
  ask("points_trc", points, "9 columns are positions, not angles");
  ask("moments", TwoJoints("time,index_mcp_moment,index_pip_moment\n", time, AngleDeg),
      "no column looks like a sensor");
  ask("forces", TwoJoints("time,wrist_f_norm_N,elbow_mA\n", time, AngleDeg),
      "no column looks like a sensor");
}

/// Clocks of some joints or rows only, and one in a unit that two rates fit.
void AddClocks(Shapes& shapes) {
  const Joints joints = {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}};
  const auto two_clocks = [](const char* header, double later_s) {
    std::string text = header;
    for (int row = 0; row < kRows; ++row) {
      text += fmt::format("{:.2f},{:.3f},{:.2f},{:.3f}\n", 0.01 * row, AngleDeg(row, 1),
                          0.01 * row + later_s, AngleDeg(row, 2));
    }
    return text;
  };
  shapes.push_back({"clocks_own", two_clocks("Time_a,index_mcp,Time_b,index_pip\n", 10.0)});
  shapes.back().question = "columns 1 and 3 are clocks of different joints, up to 10 s apart";
  shapes.push_back(
      {"clocks_same", two_clocks("time,index_mcp,time_b,index_pip\n", 0.001), 100, "deg", joints});
  const auto few_times = [](int row) {
    return row < 90 ? fmt::format("{:.2f},", 0.01 * row) : ",";
  };
  shapes.push_back(
      {"clocks_missing", TwoJoints("time,index_mcp,index_pip\n", few_times, AngleDeg)});
  shapes.back().question = "the time is missing in 25 % of the rows";
  shapes.back().map_answers = false;
  shapes.push_back({"clocks_noted",
                    TwoJoints(
                        "// Update Rate: 100.0Hz\nSampleTimeFine,index_mcp,index_pip\n",
                        [](int row) { return fmt::format("{},", 100 * row); }, AngleDeg),
                    100, "deg", joints});
  shapes.push_back(
      {"clocks_ticks",
       TwoJoints(
           "timestamp,index_mcp,index_pip\n",
           [](int row) { return fmt::format("{},", 638450000000000000 + 100000 * row); }, AngleDeg),
       100, "deg", joints});
  shapes.push_back(
      {"clocks_ms",
       TwoJoints(
           "time,ms,index_mcp,index_pip\n",
           [](int row) { return fmt::format("10:11:{:02},{},", row / 100, 10 * (row % 100)); },
           AngleDeg),
       100, "deg", joints});
  shapes.push_back({"clocks_millis", "", 100, "counts"});  // millis() behind a serial monitor's
  for (int row = 0; row < kRows; ++row) {
    shapes.back().text += fmt::format("10:15:{:02}.{:02} -> {}", row / 100, row % 100,
                                      500 + 10 * row + (row % 3 == 1 ? 1 : 0));
    for (int i = 0; i < 5; ++i) shapes.back().text += "," + Table::Cell(Counts(i, 1023)(row));
    shapes.back().text += "\n";
  }
  for (std::size_t i = 0; i < 5; ++i) {
    shapes.back().joints[fmt::format("value_{}", i + 2)] = kFlex5[i];
  }
  shapes.push_back({"commas", "time,index_mcp,index_pip\n"});
  for (int row = 0; row < kRows; ++row) {
    shapes.back().text += fmt::format("0,{:02},{},{:02},{},{:02}\n", row % 100, 20 + row % 50,
                                      row % 9, 30 + row % 40, row % 7);
  }
  shapes.back().question = "are there decimal commas between commas?";
  shapes.push_back(
      {"clocks_slow", TwoJoints(
                          "timestamp,index_mcp,index_pip\n",
                          [](int row) { return fmt::format("{},", 1000 * row); }, AngleDeg)});
  shapes.back().question = "column 1 'timestamp' rises by 1000 from row to row";
}

/// Rows of several hands or sessions in one table, headers that lack a name, and clocks that fall.
void AddParts(Shapes& shapes) {
  const Joints joints = {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}};
  const auto add = [&](const char* name, std::string text, const char* question) {
    shapes.push_back({name, std::move(text), 100, "deg", joints});
    shapes.back().question = question;
    shapes.back().map_answers = false;
  };
  const auto hands = [](int row, int sensor) {
    return row % 2 == 0 ? AngleDeg(row / 2, sensor) : 80.0 - AngleDeg(row / 2, sensor);
  };
  add("parts_hands",
      TwoJoints(
          "time,hand,index_mcp,index_pip\n",
          [](int row) {
            return fmt::format("{:.2f},{},", 0.01 * (row / 2), row % 2 == 0 ? "left" : "right");
          },
          hands),
      "rows of 2 hands or devices alternate (column 2 'hand'); --hand left or --hand right");
  add("parts_hands_right", shapes.back().text, "");
  shapes.back().options = {"--hand", "right"};
  add("parts_hands_behind",
      TwoJoints(
          "time,hand,index_mcp,index_pip\n",
          [](int row) {
            return fmt::format("{:.2f},{},", 0.01 * row, row < kRows / 2 ? "left" : "right");
          },
          AngleDeg),
      "rows of 2 hands or devices (column 2 'hand'); --hand left or --hand right");
  add("parts_hands_first", shapes.back().text, "");
  shapes.back().options = {"--hand", "left"};
  add("parts_devices",
      TwoJoints(
          "time,device_id,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{:.3f},{},", 0.005 * row, 7 + row % 2); }, hands),
      "rows of 2 hands or devices alternate (column 2 'device_id')");
  const auto sessions = [](int row, int sensor) {
    return 20.0 + 0.2 * AngleDeg(row, sensor) + (row / 40 == 1 ? 40.0 : 0.0);
  };
  add("parts_sessions",
      TwoJoints(
          "session_id,index_mcp,index_pip\n", [](int row) { return fmt::format("s{},", row / 40); },
          sessions),
      "");
  shapes.back().rate_hz = 50;
  add("parts_trials",
      TwoJoints(
          "trial,time,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{},{:.2f},", row / 40, 0.01 * row); }, sessions),
      "");
  add("parts_user",
      TwoJoints(
          "user,time,index_mcp,index_pip\n",
          [](int row) { return fmt::format("u{},{:.2f},", row / 40, 0.01 * row); }, AngleDeg),
      "");
  const auto time = [](int row) { return fmt::format("{:.2f},", 0.01 * row); };
  add("header_short",
      TwoJoints(
          "time,index_mcp,index_pip\n",
          [&](int row) { return time(row) + fmt::format("{:.3f},", AngleDeg(row, 0)); }, AngleDeg),
      "the header has 3 names for 4 columns");
  const auto no_text = [&](int row) { return time(row); };
  // Something behind every so many rows: remarks with and without a name, or a joint.
  const auto behind = [](const std::string& text, const char* more, int every) {
    std::string with;
    int line = 0;
    for (const char letter : text) {
      if (letter == '\n' && line++ % every == every - 1) with += more;
      with += letter;
    }
    return with;
  };
  const std::string plain = TwoJoints("time,index_mcp,index_pip\n", no_text, AngleDeg);
  const std::string named = TwoJoints("time,index_mcp,index_pip,event\n", no_text, AngleDeg);
  add("remarks_few", behind(plain, ",press", 30), "");
  add("remarks", behind(plain, ",press", 3), "33 % of the rows have more than 3 values");
  add("remarks_named", behind(named, ",press", 3), "33 % of the rows have more than 3 values");
  add("remarks_often", behind(named, ",press", 2), "50 % of the rows have fewer than 4 values");
  add("remarks_commas", behind(plain, ",", 2), "");
  add("rows_short",
      behind(TwoJoints("time,index_mcp,index_pip,middle_mcp\n", no_text, AngleDeg), ",7.5", 2),
      "50 % of the rows have fewer than 4 values");
  std::string wider;
  for (int row = 0; row < 2 * kRows; ++row) {
    wider += fmt::format("{:.2f},{:.3f},{:.3f},{:.3f}\n", 0.01 * row, AngleDeg(row, 3),
                         AngleDeg(row, 4), AngleDeg(row, 5));
  }
  add("tables_below", plain + "time,thumb_ip,ring_mcp,ring_pip\n" + wider,
      "120 rows above the table have another number of columns");
  add("tables_apart", plain + TwoJoints("\ntime,thumb_ip,ring_mcp\n", no_text, AngleDeg),
      "line 123 names the columns anew, in another way");
  add("names_again", plain + TwoJoints("time,index_pip,index_mcp\n", no_text, AngleDeg),
      "names the columns anew, in another way");
  add("header_comment", TwoJoints("time,index_mcp,index_pip,comment\n", no_text, AngleDeg), "");
  shapes.back().joints = {{"2", "index_mcp"}, {"3", "index_pip"}};
  add("header_long",
      TwoJoints(
          "ID,index_mcp,index_pip\n", [](int) { return ""; }, AngleDeg),
      "the header has 3 names for 2 columns");
  add("header_of_rows",
      TwoJoints(
          "time,index_mcp,index_pip\n",
          [&](int row) { return fmt::format("\"{}\",{}", row + 1, time(row)); }, AngleDeg),
      "the header has 3 names for 4 columns");
  add("header_of_r",
      TwoJoints(
          "index_mcp,index_pip\n", [](int row) { return fmt::format("\"{}\",", row + 1); },
          AngleDeg),
      "");
  shapes.back().rate_hz = 50;
  add("time_falls",
      TwoJoints(
          "time,index_mcp,index_pip\n", [&](int row) { return time(kRows - row); }, AngleDeg),
      "the time (column 1) falls from row to row");
  add("rate_of_motive",
      TwoJoints(
          "Format Version,1.23,Capture Frame Rate,240.0\n\nFrame,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{},", row); }, AngleDeg),
      "");
  shapes.back().rate_hz = 240;
}

/// Tables that are no angles of joints yet, and that a question leads on.
void AddLedOn(Shapes& shapes) {
  const auto time = [](int row) { return fmt::format("{:.2f},", 0.01 * row); };
  const auto ask = [&](const char* name, std::string text, const char* question) {
    shapes.push_back({name, std::move(text)});
    shapes.back().question = question;
  };
  const auto from_straight_deg = [](int row, int sensor) { return 180.0 - AngleDeg(row, sensor); };
  ask("straight_180", TwoJoints("time,index_mcp,index_pip\n", time, from_straight_deg),
      "angles between bones, 180 deg where straight, are as in the map");
  ask("straight_pi",
      TwoJoints("time,index_mcp_rad,index_pip_rad\n", time,
                [&](int row, int sensor) { return from_straight_deg(row, sensor) * kPi / 180.0; }),
      "angles between bones, 180 deg where straight, are as in the map");
  ask("straight_one",
      TwoJoints("time,index_mcp,index_pip\n", time,
                [&](int row, int sensor) {
                  return sensor == 1 ? AngleDeg(row, sensor) : from_straight_deg(row, sensor);
                }),
      "column 3: index_pip of 100 % of the rows is outside its range, 0 to 100 deg; angles between "
      "bones, 180 deg where straight, are as in the map");
  ask("straight_bent",
      TwoJoints("time,index_mcp,index_pip\n", time,
                [&](int row, int sensor) { return 120.0 - 0.6 * AngleDeg(row, sensor); }),
      "of the rows is outside its range, -45 to 90 deg; the unit [deg] or the joint is another");
  const auto percent = [](int row, int sensor) { return 2.0 + 96.0 * Shares(sensor)(row); };
  ask("action_percent",
      TwoJoints("timestamp,action.thumb_mcp.pos,action.thumb_ip.pos\n", time, percent),
      "--unit percent if they are");
  shapes.push_back(
      {"action_glove",
       TwoJoints("timestamp,action.index_mcp.pos,action.index_pip.pos\n", time, AngleDeg),
       100,
       "deg",
       {{"action.index_mcp.pos", "index_mcp"}, {"action.index_pip.pos", "index_pip"}}});
  const auto muscle = [](int row, int sensor) { return 40.0 * Noise(row, sensor) - 2.0; };
  ask("muscles_exg", TwoJoints("time,EXG Channel 0,EXG Channel 1\n", time, muscle),
      "activities of muscles; the joint that each is to move is unknown");
  ask("muscles_uv", TwoJoints("time,left_1_uV,left_2_uV\n", time, muscle),
      "activities of muscles; the joint that each is to move is unknown");
  ask("muscles_nameless", TwoJoints("time,ch1,ch2\n", time, muscle),
      "of muscles they need envelope_ms in the map");
  std::string eeg = "%OpenBCI Raw EXG Data\n%Sample Rate = 250 Hz\n";
  for (int row = 0; row < 250; ++row) {
    eeg += fmt::format("{}, {:.2f}, {:.2f}, -187500.02, {:.3f}\n", row, 9000.0 + muscle(row, 1),
                       -52000.0 + muscle(row, 2), 0.1 * Noise(row, 3));
  }
  ask("muscles_openbci", eeg, "columns 2 to 4: activities of muscles");
  ask("profile_and_more",
      TwoJoints(
          "Frame,Elapsed_Time_In_Milliseconds,Thumb_CMC_Flex,Index_MCP_Flex,Index_PIP_Flex,"
          "Thumb_MCP_Flex,Pinky_DIP_Flex\n",
          [](int row) {
            return fmt::format("{},{},{:.2f},{:.2f},{:.2f},", row, 10 * row, AngleDeg(row, 3),
                               AngleDeg(row, 4), AngleDeg(row, 5));
          },
          AngleDeg),
      "like manus_core_csv, but column 6 is a joint by its name, which it does not have");
  ask("clocks_swapped",
      TwoJoints(
          "time_s,index_mcp,index_pip\n",
          [](int row) { return fmt::format("{:.2f},", 0.01 * (row % 4 < 2 ? row ^ 1 : row)); },
          AngleDeg),
      "the time (column 1) goes back in 25 % of the rows; sort the rows by it");
  shapes.back().map_answers = false;
  Table window;
  for (int sensor = 1; sensor <= 5; ++sensor) {
    for (int k = 0; k < 20; ++k) {
      window.Add(fmt::format("flex{}_{}", sensor, k),
                 [=](int row) { return Counts(sensor, 1023)(20 * row + k); });
    }
  }
  ask("window_a_row", window.Text(), "if a row is a window of samples, write one sample a row");
  std::string persons = R"({"persons": [{"name": "a", "frames": [)";
  for (int row = 0; row < kRows; ++row) {
    persons += fmt::format(R"({}{{"time": {:.2f}, "index_mcp": {:.3f}, "index_pip": {:.3f}}})",
                           row > 0 ? ", " : "", 0.01 * row, AngleDeg(row, 1), AngleDeg(row, 2));
  }
  // Rows of both hands, or of several persons, in one list.
  const auto rows_of = [&](const char* key, const char* first, const char* second) {
    std::string rows;
    for (int k = 0; k < 2 * kRows; ++k) {
      rows += fmt::format(
          R"({}{{"time": {:.2f}, "{}": "{}", "index_mcp": {:.3f}, "index_pip": {:.3f}}})",
          k > 0 ? ", " : "[", 0.01 * (k % kRows), key, k < kRows ? first : second, AngleDeg(k, 1),
          AngleDeg(k, 2));
    }
    return rows + "]";
  };
  ask("json_hands", rows_of("hand", "Left", "Right"), "--hand left or --hand right");
  shapes.push_back({"json_hand",
                    rows_of("hand", "Right", "Right"),
                    100,
                    "deg",
                    {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}}});
  shapes.push_back({"json_people",
                    rows_of("person", "A", "B"),
                    100,
                    "deg",
                    {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}}});
  shapes.push_back(
      {"json_persons",
       persons + "]}]}",
       100,
       "deg",
       {{"persons_frames_index_mcp", "index_mcp"}, {"persons_frames_index_pip", "index_pip"}}});
}

/// Values of one sensor a row, and names in several lines.
void AddLongAndTwoLevels(Shapes& shapes) {
  std::string turns = "time,sensor,value\n", behind = turns, pairs = "time,joint,angle,speed\n";
  const auto cells = [](int row, int i) {
    return fmt::format("{:.2f},{},{:.3f}", 0.01 * row, kFingers[i], AngleDeg(row, i));
  };
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < 5; ++i) {
      turns += cells(row, i) + "\n";
      pairs += cells(row, i) + fmt::format(",{:.3f}\n", Noise(row, i));
    }
  }
  for (int i = 0; i < 5; ++i) {
    for (int row = 0; row < kRows; ++row) behind += cells(row, i) + "\n";
  }
  const auto ask = [&](const char* name, const std::string& text, const char* question) {
    shapes.push_back({name, text});
    shapes.back().question = question;
    shapes.back().map_answers = false;
  };
  constexpr const char* kPivot = "pivot(index='time', columns='sensor', values='value')";
  ask("long_turns", turns, kPivot);
  ask("long_behind", behind, kPivot);
  ask("long_pairs", pairs,
      "column 2 'joint' names the sensor of each row; write a column for each");
  const auto two = [&](const char* name, const std::string& head, bool has_time) {
    const auto time = [=](int row) {
      return has_time ? fmt::format("{:.2f},", 0.01 * row) : std::string();
    };
    shapes.push_back({name, TwoJoints(head, time, AngleDeg), has_time ? 100.0 : 50.0, "deg"});
    for (const int joint : {0, 1}) {
      shapes.back().joints[std::to_string(joint + (has_time ? 2 : 1))] =
          joint == 0 ? "index_pip" : "middle_pip";
    }
  };
  two("levels_named", "finger,index,middle\njoint,pip,pip\ntime,,\n", true);
  two("levels_first", ",index,middle\ntime,pip,pip\n", true);
  two("levels", "index,middle\npip,pip\n", false);
}

/// Names and clocks of other languages and tools.
void AddNamesElsewhere(Shapes& shapes) {
  const auto fingers = [](const std::string& time, const std::vector<std::string>& names) {
    Table table;
    if (!time.empty()) table.Add(time, Clock(0.01));
    for (std::size_t i = 0; i < names.size(); ++i)
      table.Add(names[i], Degrees(static_cast<int>(i)));
    return table.Text(";");
  };
  const auto ask = [&](const char* name, std::string text, const char* question) {
    shapes.push_back({name, std::move(text)});
    shapes.back().question = question;
  };
  constexpr const char* kElsewhere = "columns 2 to 6 name fingers in another language";
  ask("names_it", fingers("time", {"pollice", "indice", "medio", "anulare", "mignolo"}),
      kElsewhere);
  ask("names_fr", fingers("time", {"pouce", "index", "majeur", "annulaire", "auriculaire"}),
      kElsewhere);
  ask("names_es", fingers("tiempo", {"pulgar", "índice", "medio", "anular", "menique"}),
      kElsewhere);
  ask("names_de",
      fingers("Zeit [s]", {"Daumen [°]", "Zeigefinger [°]", "Mittelfinger [°]", "Ringfinger [°]",
                           "Kleiner Finger [°]"}),
      kElsewhere);
  std::vector<std::string> rotations;
  for (const char* bone : {"1Proximal", "1Distal", "2Proximal", "2Distal"}) {
    for (const char axis : {'x', 'y', 'z'}) {
      rotations.push_back(fmt::format("RightDigit{}_rotation_{}", bone, axis));
    }
  }
  ask("names_rotations", fingers("time", rotations),
      "12 columns are rotations of bones about x, y and z");
  shapes.push_back(
      {"names_digits",
       fingers("time", {"RightDigit1Distal_flexion_deg", "RightDigit2Proximal_flexion_deg",
                        "RightDigit2Middle_flexion_deg"}),
       100,
       "deg",
       {{"RightDigit1Distal_flexion_deg", "thumb_ip"},
        {"RightDigit2Proximal_flexion_deg", "index_mcp"},
        {"RightDigit2Middle_flexion_deg", "index_pip"}}});
  const Joints two = {{"index_mcp", "index_mcp"}, {"index_pip", "index_pip"}};
  shapes.push_back({"clocks_unnamed",
                    TwoJoints(
                        "Unnamed: 0,index_mcp,index_pip\n",
                        [](int row) { return fmt::format("{:.2f},", 0.01 * row); }, AngleDeg),
                    100, "deg", two});
  shapes.push_back({"rises_unnamed",
                    TwoJoints(
                        "Unnamed: 0,index_mcp,index_pip\n",
                        [](int row) { return fmt::format("{},", row); }, AngleDeg),
                    50, "deg", two});
  GloveShape midnight = {"clocks_midnight", "", 100, "counts"};
  GloveShape log = {"clocks_esp_idf", "", 50, "counts"};
  for (int row = 0; row < kRows; ++row) {
    midnight.text += row < 50 ? fmt::format("23:59:59.{:02} -> ", 50 + row)
                              : fmt::format("00:00:00.{:02} -> ", row - 50);
    log.text += fmt::format("\x1b[0;32mI ({}) GLOVE: ", 1000 + 20 * row);
    for (int i = 0; i < 5; ++i) {
      const std::string value = Table::Cell(Counts(i, 1023)(row));
      midnight.text += (i > 0 ? "," : "") + value;
      log.text += fmt::format("{}{}={}", i > 0 ? ", " : "", kFingers[i], value);
    }
    midnight.text += "\n";
    log.text += "\x1b[0m\n";
  }
  for (int i = 0; i < 5; ++i) {
    midnight.joints[fmt::format("value_{}", i + 1)] = kFlex5[i];
    log.joints[kFingers[i]] = kFlex5[i];
  }
  shapes.push_back(midnight);
  shapes.push_back(log);
}

/// Units in names: those of angles, with a prefix, too, and others, which are no angles.
void AddUnits(Shapes& shapes) {
  const auto fingers = [](const std::string& unit, double per_deg, double zero) {
    Table table;
    table.Add("time", Clock(0.01));
    for (int i = 0; i < 5; ++i) {
      table.Add(kFingers[i] + unit, [=](int row) { return zero + per_deg * AngleDeg(row, i); });
    }
    return table.Text();
  };
  const auto add = [&](const std::string& unit, double per_deg, const char* question,
                       double zero = 0.0) {
    shapes.push_back({"unit" + unit, fingers(unit, per_deg, zero)});
    shapes.back().question = question;
  };
  constexpr const char* kNone = "no column looks like a sensor of a hand";
  add("_degC", 0.1, kNone, 30.0);
  add(" [°C]", 0.1, kNone, 30.0);
  add("_N", 0.2, kNone);
  add("_hPa", 1.0, kNone);
  add("_tension", 0.5, kNone);
  add("_Ohm", 100.0, "in a unit by their names whose angles are unknown");
  add("_kOhm", 0.7, "in a unit by their names whose angles are unknown", 25.0);
  add("_pF", 1.1, "in a unit by their names whose angles are unknown", 300.0);
  const auto right = [&](const std::string& unit, double per_deg, const char* name, double zero) {
    shapes.push_back({"unit" + unit, fingers(unit, per_deg, zero), 100, name});
    for (std::size_t i = 0; i < 5; ++i) shapes.back().joints[kFingers[i] + unit] = kFlex5[i];
  };
  Table mixed;
  mixed.Add("time", Clock(0.01)).Add("index_mcp_deg", Degrees(0)).Add("index_pip_rad", Radians(1));
  shapes.push_back({"unit_of_each", mixed.Text()});
  shapes.back().question = "column 2 [deg] and column 3 [rad] have different units";
  Table beside;
  beside.Add("time", Clock(0.01)).Add("index_mcp_deg", Degrees(0)).Add("index_pip", Radians(1));
  shapes.push_back({"unit_of_one", beside.Text()});
  shapes.back().question = "column 2 [deg] and column 3 [rad] have different units";
  right("_V", 0.02, "volts", 1.2);
  right("_mrad", 1e3 * kPi / 180.0, "mrad", 0.0);
}

/// Names that say more than the joint: a direction, a function, a tip; and values that are not
/// those of the profile that is named.
void AddContradictions(Shapes& shapes) {
  const auto ask = [&](const char* name, const std::string& text, const char* question) {
    shapes.push_back({name, text});
    shapes.back().question = question;
  };
  const auto fingers = [](const std::string& word, const std::function<Formula(int)>& value) {
    Table table;
    table.Add("time", Clock(0.02));
    for (int i = 0; i < 5; ++i) table.Add(kFingers[i] + word, value(i));
    return table;
  };
  constexpr const char* kOpening = "columns 2 to 6 rise as the finger opens, by their names";
  ask("opening_percent", fingers("_openness", Degrees).Text(), kOpening);
  ask("opening_deg", fingers("_extension_deg", Degrees).Text(), kOpening);
  constexpr const char* kOtherUnit = "in a unit by their names whose angles are unknown";
  const auto cosines = [](int sensor) {
    return [=](int row) { return std::cos(AngleDeg(row, sensor) * kPi / 180.0); };
  };
  const auto turns = [](int sensor) {
    return [=](int row) { return AngleDeg(row, sensor) / 360.0; };
  };
  ask("unit_cosines", fingers("_pip_cos", cosines).Text(), kOtherUnit);
  ask("unit_turns", fingers("_pip_turns", turns).Text(), kOtherUnit);
  ask("unit_resistance",
      fingers("_resistance", [](int sensor) { return Counts(sensor, 4e4); }).Text(), kOtherUnit);
  shapes.push_back({"tips", fingers("_tip_deg", Degrees).Text(), 50, "deg"});
  for (std::size_t i = 0; i < 5; ++i) {
    shapes.back().joints[kFingers[i] + "_tip_deg"] = kFingers[i] + (i == 0 ? "_ip" : "_dip");
  }
  Table encoders;
  encoders.Add("time_s", Clock(0.02));
  for (int i = 0; i < 16; ++i) encoders.Add(fmt::format("enc{}", i), Counts(i, 4095));
  ask("number_encoders", encoders.Text(), "16 sensors [counts], whose joints are unknown");
  Table pairs;  // as Delsys writes a clock for each sensor
  for (int i = 1; i <= 2; ++i) {
    pairs.Add(i == 1 ? "X [s]" : "X [s].1", Clock(0.001));
    pairs.Add(fmt::format("Avanti sensor {}: EMG {} [V]", i, i),
              [i](int row) { return 1e-4 * Noise(row, i); });
  }
  ask("muscles_own_clocks", pairs.Text(), "columns 2, 4: activities of muscles");
  ask("preset_deg", fingers("_a", Degrees).Text(),
      "where 5dt5 has 0 to 4095 in whole numbers: deg?; --unit counts if they are counts");
  shapes.back().options = {"--preset", "5dt5"};
  Table bytes;
  bytes.Add("time_s", Clock(0.02));
  int sensor = 0;
  for (const char* joint : {"ThumbMPJ", "ThumbIJ", "IndexMPJ", "IndexPIJ", "MiddleMPJ", "MiddlePIJ",
                            "RingMPJ", "RingPIJ", "PinkieMPJ", "PinkiePIJ"}) {
    bytes.Add(fmt::format("G_{}", joint), Counts(sensor++, 200));
  }
  ask("profile_bytes", bytes.Text(),
      "in whole numbers, where cyberglove_ros_calibrated has -120 to 160 with fractions");
}

}  // namespace

std::vector<GloveShape> GloveShapes() {
  Shapes shapes;
  AddPositionsAndAngles(shapes);
  AddMotionSensors(shapes);
  AddNamelessMotionSensor(shapes);
  AddDeadSensors(shapes);
  AddLists(shapes);
  AddTurned(shapes);
  AddWithoutHand(shapes);
  AddLabels(shapes);
  AddJointStates(shapes);
  AddOtherTools(shapes);
  AddTurnsAndSigns(shapes);
  AddNumbers(shapes);
  AddParts(shapes);
  AddRising(shapes);
  AddClocks(shapes);
  AddLedOn(shapes);
  AddUnits(shapes);
  AddNamesElsewhere(shapes);
  AddLongAndTwoLevels(shapes);
  AddContradictions(shapes);
  return shapes;
}

}  // namespace gauntlet::test
