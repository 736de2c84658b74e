// How long the page and questions take of a study.db with a million scores: the table of
// docs/evidence/measurements.md.
//
//   sweep_measurements FOLDER [CELLS]     makes FOLDER/study.db, unless it is there
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>

#include "sim/answers/sweep/response.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/base/random.h"
#include "sim/show/pages/pages.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

constexpr int kSeeds = 8;

double Processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
auto Timed(const char* what, const Work& work) {
  const double start = Processor_s();
  auto result = work();
  fmt::print("{:<40} {:6.2f} s\n", what, Processor_s() - start);
  return result;
}

SweepPlan PlanOf(const std::filesystem::path& folder, int cells) {
  const std::filesystem::path file = folder / "million.yaml";
  std::ofstream(file) << "question: How long does it take?\nscenario: " << SourceDir()
                      << "/scenarios/hold_still.yaml\ncontrollers: [tuned_kalman]\nseeds: "
                      << kSeeds << "\nphysics: false\ndesign: random\ncells: " << cells
                      << "\naxes:\n"
                         "  - {key: controllers.tuned_kalman.filter.q, low: 1e-6, high: 1, "
                         "spacing: log}\n"
                         "  - {key: event.delay_ms, low: 0, high: 100}\n"
                         "scores: [tracking_rmse_deg, delay_ms, jitter_rms_deg, peak_error_deg]\n";
  return LoadSweepPlan(file);
}

int Fill(const SweepPlan& plan, SweepDatabase& database) {
  RandomStream random(1, "scores");
  database.AddStudy("made up", "");
  for (std::int64_t cell = 0; cell < plan.cell_count(); ++cell) {
    SweepCellRecord record{.number = cell,
                           .controller = "tuned_kalman",
                           .study = "made up",
                           .settings = fmt::format("{:064x}", cell),
                           .motions = {},
                           .problem = {}};
    for (int i = 0; i < kSeeds; ++i) {
      TrialOutcome outcome;
      outcome.scores.summary.assign(Metrics().size(), 0.0);
      for (const std::size_t metric : plan.metrics)
        outcome.scores.summary[metric] = random.Uniform();
      database.Keep({"made up", record.controller, record.settings, 1 + i}, outcome);
      record.motions.push_back(i);
    }
    const std::vector<std::string> values = plan.ValuesOf(cell);
    database.AddCell(record,
                     {{plan.file.axes[0].key, values[0]}, {plan.file.axes[1].key, values[1]}});
  }
  database.Flush();
  return 0;
}

void Measure(const std::filesystem::path& folder, int cells) {
  std::filesystem::create_directories(folder);
  const SweepPlan plan = PlanOf(folder, cells);
  const std::filesystem::path file = folder / "study.db";
  SweepDatabase database(file, "made up", plan.metrics);
  if (database.TrialCount() == 0) Timed("filling it", [&] { return Fill(plan, database); });
  const CellRange all{0, plan.cell_count()};
  const auto size = static_cast<double>(std::filesystem::file_size(file));
  fmt::print("{} trials, {} scores, {:.0f} bytes a trial\n", database.TrialCount(),
             database.TrialCount() * 4, size / static_cast<double>(database.TrialCount()));
  const SweepSummary summary =
      Timed("summary and cells.csv", [&] { return SummariseSweep(plan, database, all); });
  Timed("page", [&] {
    return SweepPage(plan, database, all, summary, ReadResponse(plan, database, all)).size();
  });
  SQLite::Database reader(file.string());
  Timed("mean of a score per cell, by SQL", [&] {
    SQLite::Statement query(reader,
                            "SELECT number, avg(value) FROM cell_scores WHERE metric = 'delay_ms' "
                            "GROUP BY number ORDER BY 2 LIMIT 10");
    int rows = 0;
    while (query.executeStep()) ++rows;
    return rows;
  });
}

}  // namespace
}  // namespace gauntlet::sim

int main(int count, char** arguments) {
  if (count < 2) return 2;
  gauntlet::sim::Measure(arguments[1], count > 2 ? std::stoi(arguments[2]) : 31250);
  return 0;
}
