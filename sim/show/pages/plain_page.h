#pragma once

#include <string>

namespace gauntlet::sim {

/// A page without scripts: a verdict, a table, and sections with pictures or further tables.
struct PlainPageParts {
  std::string kind;
  std::string title;
  std::string question;
  std::string verdict;
  std::string facts;
  std::string heading;   // of the table
  std::string table;     // HTML
  std::string sections;  // HTML
};

/// The page of these parts, self-contained as ReportPage() is. All text is escaped.
std::string PlainPage(const PlainPageParts& parts);

}  // namespace gauntlet::sim
