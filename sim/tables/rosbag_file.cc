#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/message_file.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// A query whose rows are taken one after the other.
class Query {
 public:
  Query(sqlite3* database, const std::string& text) : database_(database) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database, text.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
      FailAsDamaged(OneLine(sqlite3_errmsg(database), 80));
    }
    statement_.reset(statement);
  }

  void Bind(int place, std::int64_t value) { sqlite3_bind_int64(statement_.get(), place, value); }
  bool Next() {
    const int result = sqlite3_step(statement_.get());
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE) FailAsDamaged(OneLine(sqlite3_errmsg(database_), 80));
    return false;
  }
  std::int64_t Number(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  std::string_view Bytes(int column) const {
    const void* const bytes = sqlite3_column_blob(statement_.get(), column);
    const int size = sqlite3_column_bytes(statement_.get(), column);
    return bytes == nullptr
               ? std::string_view()
               : std::string_view(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
  }

 private:
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement_{nullptr, &sqlite3_finalize};
};

std::string UriOf(const fs::path& file) {
  std::string uri = "file:";
  for (const char letter : fs::absolute(file).string()) {
    const bool is_plain = letter != '%' && letter != '?' && letter != '#';
    uri += is_plain ? std::string(1, letter)
                    : fmt::format("%{:02x}", static_cast<unsigned char>(letter));
  }
  return uri + "?mode=ro&immutable=1";
}

class RosbagFile : public MessageFile {
 public:
  explicit RosbagFile(const fs::path& file) {
    InputFile(file);
    fs::path log = file;
    log += "-wal";
    std::error_code missing;
    if (const auto bytes = fs::file_size(log, missing); !missing && bytes > 0) {
      throw UserError(fmt::format(
          "has messages in {} that are not in it yet; sqlite3 FILE \"pragma wal_checkpoint\" adds "
          "them",
          OneLine(log.filename().string(), 80)));
    }
    sqlite3* database = nullptr;
    const int opened = sqlite3_open_v2(UriOf(file).c_str(), &database,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (opened != SQLITE_OK) throw UserError("cannot be opened");
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_exec(database, "PRAGMA temp_store = MEMORY", nullptr, nullptr, nullptr);
    const bool has_topics = HasTable("topics"), has_messages = HasTable("messages");
    if (!has_topics || !has_messages) {
      throw UserError("is a database of SQLite without the tables of a ROS 2 bag");
    }
    ReadTopics();
  }

  void ForEachMessage(std::size_t topic, const Visit& visit) override {
    Query rows(database_.get(),
               "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp, id");
    rows.Bind(1, ids_[topic]);
    while (rows.Next()) visit(rows.Number(0), rows.Bytes(1));
  }

 private:
  bool HasTable(const std::string& name) {
    return Query(database_.get(),
                 "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = '" + name + "'")
        .Next();
  }

  void ReadTopics() {
    std::map<std::string, std::pair<std::string, std::string>> definitions;
    if (HasTable("message_definitions")) {
      Query rows(database_.get(),
                 "SELECT topic_type, encoding, encoded_message_definition FROM "
                 "message_definitions");
      while (rows.Next()) {
        definitions[std::string(rows.Bytes(0))] = {std::string(rows.Bytes(1)),
                                                   std::string(rows.Bytes(2))};
      }
    }
    std::map<std::int64_t, std::size_t> places;
    std::map<std::string, std::size_t> by_name;
    Query rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    while (rows.Next()) {
      Topic topic;
      topic.name = rows.Bytes(1);
      topic.type = rows.Bytes(2);
      topic.encoding = rows.Bytes(3);
      if (const auto found = definitions.find(topic.type); found != definitions.end()) {
        std::tie(topic.schema_encoding, topic.schema) = found->second;
      }
      const auto [same, is_new] = by_name.try_emplace(topic.name, topics_.size());
      if (!is_new) {
        topics_[same->second].problem = topic.problem = "its messages are of several types";
      }
      places[rows.Number(0)] = topics_.size();
      ids_.push_back(rows.Number(0));
      topics_.push_back(std::move(topic));
    }
    Query counts(database_.get(),
                 "SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages GROUP BY "
                 "topic_id");
    while (counts.Next()) {
      const auto found = places.find(counts.Number(0));
      if (found == places.end()) FailAsDamaged("a message has an unknown topic");
      Topic& topic = topics_[found->second];
      topic.messages = static_cast<std::uint64_t>(counts.Number(1));
      topic.first_ns = counts.Number(2);
      topic.last_ns = counts.Number(3);
    }
  }

  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, &sqlite3_close};
  std::vector<std::int64_t> ids_;  // of the topics
};

}  // namespace

std::unique_ptr<MessageFile> OpenRosbag(const fs::path& file) {
  return std::make_unique<RosbagFile>(file);
}

}  // namespace gauntlet::sim
