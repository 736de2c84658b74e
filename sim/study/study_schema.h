#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/base/error.h"

namespace gauntlet::sim {

// What `study.db` is, for all who write it: the tables are in study_schema.cc, one set for
// comparisons and sweeps; sim/study/README.md shows how to ask them.

/// The name of the row of score that is the mean over all joints, motors or cables.
constexpr std::string_view kSummaryChannel = "summary";

/// Why SQLite did not do something, and what helps.
enum class Trouble { kLock, kDamage, kFullDisk, kOther };
Trouble TroubleOf(const SQLite::Exception& error);

/// The user's mistake about this file, with what to do about it.
UserError NotUsable(const std::filesystem::path& file, std::string_view what);

/// What SQLite would say less clearly, or too late: a folder in its place, a path that is too long.
/// Errors: UserError.
void CheckDatabasePlace(const std::filesystem::path& file);

bool HasTables(SQLite::Database& database);
/// In one transaction. Errors: SQLite::Exception.
void MakeTables(SQLite::Database& database);
/// Errors: UserError if the file is of another version, or somebody or something changed its
/// tables; SQLite::Exception.
void CheckTables(const std::filesystem::path& file, SQLite::Database& database);

/// What distinguishes a trial from all others, as the columns of its row.
struct TrialColumns {
  std::string_view study;
  std::string_view controller;
  std::string_view settings;
  std::int64_t seed = 0;
};
/// To the first four places of a statement.
void Bind(const TrialColumns& columns, SQLite::Statement& statement);
/// With its scores; nothing if there is none. Errors: SQLite::Exception.
void RemoveTrial(const TrialColumns& columns, SQLite::Database& database);

/// What the constructor of a database says of an SQLite error, as an exception that names the file.
[[noreturn]] void ThrowCannotOpen(const std::filesystem::path& file,
                                  const SQLite::Exception& error);

/// The text of a column, as long as its row is.
inline std::string_view TextOf(const SQLite::Column& column) {
  return {column.getText(), static_cast<std::size_t>(column.getBytes())};
}

}  // namespace gauntlet::sim
