#pragma once

#include <string>

#include "sim/show/pages/headline.h"

namespace gauntlet::sim {

/// A page without scripts: an answer, a table, and sections with pictures or further tables.
struct PlainPageParts {
  PageHead head;
  std::string heading;   // of the table
  std::string table;     // HTML
  std::string sections;  // HTML
};

/// The page of these parts, self-contained as ReportPage() is. All text is escaped.
std::string PlainPage(const PlainPageParts& parts);

}  // namespace gauntlet::sim
