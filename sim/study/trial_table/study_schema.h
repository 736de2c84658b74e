#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <string_view>

#include "sim/base/error.h"

namespace gauntlet::sim {

// The format of `study.db`, one set of tables for comparisons and sweeps, as described in
// docs/reference/output-files.md.

/// The name of the row of score that is the mean over all joints, motors or cables.
constexpr std::string_view kSummaryChannel = "summary";

constexpr std::string_view kLockedByAnother =
    "another program (or its network folder) keeps it locked";

/// Why SQLite did not do something, and what helps.
enum class Trouble { kLock, kDamage, kFullDisk, kOther };
Trouble TroubleOf(const SQLite::Exception& error);

/// The user's mistake about this file, with what to do about it.
UserError NotUsable(const std::filesystem::path& file, std::string_view what);

/// SQLite would refuse these less clearly, or too late: a symbolic link or a folder in place of the
/// file or of its journal, a journal that names a file to be removed, a path that is too long.
/// Errors: UserError.
void CheckDatabasePlace(const std::filesystem::path& file);
/// Without links in the path of its folder: a database is opened with OPEN_NOFOLLOW, which refuses
/// a link anywhere. Absolute, since SQLite reads `file:..` as an address.
std::filesystem::path InRealFolder(const std::filesystem::path& file);

bool HasTables(SQLite::Database& database);
/// In one transaction. Errors: SQLite::Exception.
void MakeTables(SQLite::Database& database);
/// Errors: UserError if the file is of another version, or another program changed its
/// tables; SQLite::Exception.
void CheckTables(const std::filesystem::path& file, SQLite::Database& database);

/// Throws the error of SQLite while a database is opened as an error that names the file.
[[noreturn]] void ThrowCannotOpen(const std::filesystem::path& file,
                                  const SQLite::Exception& error);

}  // namespace gauntlet::sim
