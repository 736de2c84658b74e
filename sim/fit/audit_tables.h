#pragma once

#include <string>

#include "sim/fit/audit.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// "50 episodes, 612.3 s at 30 Hz"
std::string ExtentText(const Audit& audit);

/// Usable for training or not, what to mend first, and the threshold's reason. `recommended`: fit,
/// fix or unusable. `others`: where the faults are that the first sentence does not name.
Verdict VerdictOf(const Audit& audit, const std::string& others = "--verbose");

/// The table with all parts, all faults, and ignored columns.
ResultText AuditFindings(const Audit& audit);
/// Verdict and table in at most 25 lines; parts without a fault may be left out of the table.
/// `verbose`: AuditFindings() behind the verdict.
ResultText AuditText(const Audit& audit, bool verbose);

std::string AuditJson(const Audit& audit);

}  // namespace gauntlet::sim
