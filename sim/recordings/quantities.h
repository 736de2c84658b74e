#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/table_statistics.h"

namespace gauntlet::sim {

/// Unit of the values of sensors.
enum class RawUnit { kCounts, kShare, kDegrees, kRadians, kMilliradians, kVolts, kUnknown };
std::string_view NameOf(RawUnit unit);

/// Quantity that a column of a file has.
enum class Quantity {
  kText,
  kNothing,  // no values
  kTime,
  kRate,    // or interval of rows
  kNumber,  // of a row, episode, person or packet
  kLabel,
  kOrientation,
  kAcceleration,
  kAngularRate,
  kMagneticField,
  kPosition,
  kVelocity,
  kForce,
  kCurrent,
  kTemperature,
  kBattery,
  kMuscle,
  kQuality,  // confidence, validity, errors
  kCommand,
  kUnknown,
  kSensor,  // of a hand: angles, or counts, shares and volts of bend sensors
};
/// "a time", "an acceleration", ..
std::string_view NameOf(Quantity quantity);

/// A column and what is known of its values.
struct ColumnEvidence {
  std::string name = {};
  bool is_text = false;
  bool is_time = false;  // is the time of the rows, or a part of it
  ColumnStatistics statistics = {};
};

/// Facts about the columns of a family that rules look at.
struct FamilyFacts {
  std::vector<std::string> words = {};  // common to all names; no fingers, joints, axes, numbers
  std::string_view axes = {};           // "xyz", "xy", "wxyz" or "rpy" of names; empty: none
  bool names_fingers = false;           // or parts of the arm
  bool names_arm = false;
  bool names_joints = false;  // mcp, pip .. or the position of a joint
  std::size_t columns = 0;
  std::size_t moving = 0;  // columns with more than one value
  bool is_text = false;
  bool is_empty = false;
  bool is_whole = true;     // only whole numbers
  bool is_counting = true;  // whole numbers that rise by 0 or 1, and seldom start anew
  double low = 0.0;         // of the moving columns, without their rarest values
  double high = 0.0;
  double reach = 0.0;            // largest magnitude
  double least_reach = 0.0;      // of a column
  std::size_t full_percent = 0;  // columns from exactly 0 to exactly 100
  std::size_t turns = 0;         // steps of about 360
  double turning_span = 0.0;     // highest less lowest value of a column with such steps
};

/// Columns of one kind: the same stem of the name and the same quantity.
struct ColumnFamily {
  std::string stem = {};                  // common part of the names
  std::string side = {};                  // left, right or empty
  std::vector<std::size_t> columns = {};  // in the order of their numbers, else of the file
  FamilyFacts facts = {};
  Quantity quantity = Quantity::kUnknown;
  RawUnit unit = RawUnit::kUnknown;  // of sensors
  bool is_assumed = false;           // the unit is a guess by the size of the numbers
  std::string_view rule = {};        // key of the rule that decided
  std::string_view why = {};
};

/// Groups the columns of a table into families and decides the quantity of each by QuantityRules().
/// Each column is in one family.
std::vector<ColumnFamily> FindFamilies(std::span<const ColumnEvidence> columns);

/// The family of these columns, which are known to be sensors of a hand.
ColumnFamily FamilyOfSensors(std::span<const ColumnEvidence> columns,
                             const std::vector<std::size_t>& sensors);

/// A rule: families of these facts have this quantity. The first rule that holds decides.
struct QuantityRule {
  std::string_view key;
  Quantity quantity;
  RawUnit unit;
  bool is_assumed;
  std::string_view words;  // one of them is in the names; empty: any names
  bool (*holds)(const FamilyFacts& facts);
  std::string_view reason;
  std::string_view source;
};
std::span<const QuantityRule> QuantityRules();

}  // namespace gauntlet::sim
