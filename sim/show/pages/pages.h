#pragma once

#include <filesystem>
#include <string>
#include <vector>

// The pages that commands write, but report.html (report_page.h): a function each, in a file each.

namespace gauntlet::sim {

class SweepDatabase;
struct Audit;
struct CellRange;
struct ChainResult;
struct IdentifiedChain;
struct Inspection;
struct LiveSetup;
struct Response;
struct RobustPlan;
struct RobustResult;
struct Run;
struct Study;
struct StudyFolder;
struct SweepPlan;
struct SweepSummary;
struct TunedKind;
struct TunePlan;
struct TuneResult;
struct Validation;

/// Page of `gauntlet sweep`.
std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const Response& response);

/// Page of `gauntlet tune`: a point is a setting that was tried.
std::string TunePage(const TunePlan& plan, const TuneResult& result);

/// Page of `gauntlet tune --all`: the fronts of all kinds of filters in one picture. A point is a
/// setting that was tried.
std::string TunePage(const TunePlan& plan, const std::vector<TunedKind>& kinds);

/// Page of `gauntlet robust`, with a tornado for each score. The command that repeats a hand begins
/// with the scenario as it was resolved, which lies beside the page.
std::string RobustPage(const RobustPlan& plan, SweepDatabase& database, const RobustResult& result);

/// One page of several output folders: settings that differ, and the primary scores of every
/// controller side by side. A change is marked as in DifferenceText(), against the first folder.
/// Shapes: at least two folders.
std::string FoldersPage(std::vector<StudyFolder> folders);

/// A page without scripts over finished output folders: name, date, question, answer, size, and
/// jitter against delay as a small picture, from the numbers of each folder. Names link to the
/// pages of the folders, as seen from `folder`, where the page will stand.
std::string RunsPage(const std::vector<Run>& runs, const std::filesystem::path& folder);

/// Writes it, with its folder. Errors: UserError for a file that was read; RunError.
void WriteRunsPage(const std::vector<Run>& runs, const std::filesystem::path& page);

/// An inspection as a page without scripts: the health of the sensors, the worst first, with what
/// to do; the joints with unit and assumptions; a small picture of each channel over time.
std::string InspectionPage(const Inspection& inspection);

/// Findings of gauntlet audit as a page without scripts: the verdict, the delay of each part with
/// its range over the data set, the table, the offset and the delay of each part and episode as
/// heat maps, and for each part the stretch in which the angle is farthest from its command.
std::string AuditPage(const Audit& audit);

/// Findings of gauntlet identify as a page without scripts: the table of the terminal, and for each
/// part of the log, over the command, what was measured beside what the model makes of the same
/// command; in the stretch of a few seconds in which it moves most, and the difference over the
/// whole log but its first second. Of several episodes, these are of the held-out one with the most
/// motion. `file`: name of the file of the chain, without folders.
std::string ChainPage(const ChainResult& result, const IdentifiedChain& chain,
                      const std::string& file);

/// Findings of gauntlet identify --validate as a page without scripts: the table of the terminal,
/// and for each part the measured angle beside the simulated one where it moves most, and their
/// difference.
std::string ValidationPage(const Validation& validation);

/// The page of a running session: the hand with the wearer's posture and that of a second
/// controller, running scores, the last seconds of the curves, the time of the stages, queues and
/// watchdog, and the choice of the controller. It has no measurements of its own:
/// `GET events` gives them, `POST switch` asks for a controller and `POST mark` marks that the hand
/// is still, all beside the page and with the token of its address. Scripts bear `nonce`, for the
/// content security policy. `recording`: file of the samples, empty if there is none.
std::string LivePage(const Study& study, const LiveSetup& setup, const std::string& recording,
                     const std::string& nonce);

}  // namespace gauntlet::sim
