#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "python/bindings.h"
#include "python/elsewhere.h"
#include "python/long_call.h"
#include "python/own_filters.h"
#include "python/results.h"
#include "python/sources.h"
#include "sim/answers/sweep/sweep_plan.h"
#include "sim/answers/sweep/sweep_run.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/answers/tune/tune_all.h"
#include "sim/answers/tune/tune_bench.h"
#include "sim/answers/tune/tune_memo.h"
#include "sim/answers/tune/tune_request.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/base/stop.h"
#include "sim/base/threads.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/show/pages/pages.h"
#include "sim/study/study.h"
#include "sim/study/trial_table/sweep_database.h"
#include "sim/study/trial_table/trial_table.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

/// {"json", "csv", "page", "controllers": {name: YAML}, "text", "html", "tables", "remarks"}.
py::dict Tune(const sim::TuneRequest& request, const SettingsSource& scenario,
              const std::vector<std::string>& overrides, int jobs, const OwnFilters& own_filters,
              const py::object& executor, const py::object& on_progress) {
  const std::unique_ptr<ExecutorParts> parts = PartsOf(executor);
  ExecutorParts* const elsewhere = parts.get();
  std::optional<sim::TuneMemo> memo;
  sim::TunePlan plan;
  std::vector<sim::TunedKind> kinds;
  std::optional<sim::TuneResult> result;
  std::string json, csv, page;
  sim::ResultText text, verbose;
  const auto run = [&](LongWork& work) {
    const OwnFiltersOfCall scope(own_filters, elsewhere ? elsewhere->call() : "");
    plan = sim::PlanOf(request, ScenarioSourceOf(scenario, overrides));
    sim::CheckProgramsOf(plan.scenario, {plan.controller});
    double most = 0.0;
    const auto progress = [&](double done, double all) {
      most = std::max(most, done);
      return work.Progress(most, all);
    };
    if (elsewhere != nullptr && !request.all) plan.elsewhere = elsewhere;
    if (elsewhere != nullptr && request.all) {
      plan.memo = &memo.emplace(plan);
      sim::AwaitKinds(plan, *elsewhere, progress);
    }
    const auto conclude = [&](const auto& found) {
      json = sim::TuneJson(plan, found);
      csv = sim::TuneCsv(plan, found);
      page = sim::TunePage(plan, found);
      text = sim::TuneText(plan, found, false);
      verbose = sim::TuneText(plan, found, true);
    };
    if (request.all) {
      kinds = sim::TuneAll(plan, sim::JobsOrCores(jobs), progress);
      if (!kinds.front().has_answer()) {
        throw sim::RunError("no kind of filter has an answer: " + kinds.front().result.problem);
      }
      conclude(kinds);
    } else {
      conclude(result.emplace(sim::Tune(plan, sim::JobsOrCores(jobs), progress)));
    }
  };
  const std::vector<std::string> remarks = RunLong(on_progress, run, elsewhere);
  py::dict controllers;
  if (result) controllers[py::str(plan.controller)] = sim::ControllerYaml(result->controller);
  for (const sim::TunedKind& tuned : kinds) {
    if (!tuned.has_answer()) continue;
    controllers[py::str(tuned.kind)] = sim::ControllerYaml(tuned.result.controller);
  }
  py::dict dict;
  dict["json"] = json;
  dict["csv"] = csv;
  dict["page"] = page;
  dict["controllers"] = controllers;
  dict["remarks"] = remarks;
  AddText(text, verbose, dict);
  return dict;
}

/// Searches some kinds of filters, on one thread, into a file for sim::TuneMemo.
void RunKindsOfPart(const sim::TuneRequest& request, const SettingsSource& scenario,
                    const std::vector<std::string>& overrides, const PartRequest& part) {
  sim::TunePlan plan = sim::PlanOf(request, ScenarioSourceOf(scenario, overrides));
  sim::TuneMemo memo(plan);
  plan.memo = &memo;
  sim::TuneSomeKinds(plan, part.range);
  memo.Write(part.database);
}

/// Runs some trials of one setting of a search, on one thread, into a study.db.
void RunSettingOfPart(const sim::TuneRequest& request, const SettingsSource& scenario,
                      const std::vector<std::string>& overrides,
                      const std::vector<std::string>& about, const PartRequest& part) {
  const sim::TunePlan plan = sim::PlanOf(request, ScenarioSourceOf(scenario, overrides));
  sim::RunTrialsOfSetting(plan, about, part.range, part.database);
}

sim::SweepPlan SweepPlanOf(const SettingsSource& study, const sim::SweepOverrides& overrides) {
  if (study.text) return sim::ParseSweepPlan(study.file, *study.text, overrides);
  return sim::LoadSweepPlan(sim::ReadyFile(study.file, "studies", "study"), overrides);
}

/// Runs some cells of a sweep, on one thread, into a study.db.
void RunCellsOfPart(const SettingsSource& study, const sim::SweepOverrides& overrides,
                    const PartRequest& part) {
  const sim::SweepPlan plan = SweepPlanOf(study, overrides);
  sim::SweepDatabase database(part.database, sim::HashOfSweep(plan), plan.metrics);
  sim::RunSweep(plan, database,
                {.cells = {part.range.first, part.range.end},
                 .progress = [](double, double) { return !sim::StopAsked(); }});
}

/// {"json", "csv", "text", "html", "tables", "remarks"}; `out` gets the files of `gauntlet
/// sweep`.
py::dict Sweep(const SettingsSource& study, const sim::SweepOverrides& overrides, int jobs,
               const std::string& out, const OwnFilters& own_filters, const py::object& executor,
               const py::object& on_progress) {
  std::string json, csv;
  sim::ResultText text, verbose;
  const std::unique_ptr<ExecutorParts> parts = PartsOf(executor);
  ExecutorParts* const elsewhere = parts.get();
  const auto run = [&](LongWork& work) {
    const OwnFiltersOfCall scope(own_filters, elsewhere ? elsewhere->call() : "");
    const sim::SweepPlan plan = SweepPlanOf(study, overrides);
    sim::CheckProgramsOf(plan.scenario, plan.file.controllers);
    sim::SetSignalFolder(out);
    const std::string hash = sim::HashOfSweep(plan);
    sim::OutputFolder folder(out);
    sim::OutputFiles files(
        {.folder = folder.path(),
         .command = "sweep",
         .choices = sim::ChoicesText({.set = overrides.set}),
         .results = {"report.html", "cells.csv", sim::kAnswerFile, sim::kVerboseAnswerFile}});
    sim::SweepDatabase database(folder.path() / "study.db", hash, plan.metrics);
    const sim::CellRange cells = sim::ShardOf(plan, 1, 1);
    try {
      sim::RunSweep(plan, database,
                    {.jobs = sim::JobsOrCores(jobs),
                     .cells = cells,
                     .progress = [&](double done, double all) { return work.Progress(done, all); },
                     .remark = [&](const std::string& line) { work.Remark(line); },
                     .elsewhere = elsewhere});
    } catch (const sim::Cancelled&) {
      database.Flush();
      throw sim::Cancelled{sim::KeptIn(folder.path() / "study.db")};
    }
    const sim::Response response = sim::ReadResponse(plan, database, cells);
    const sim::SweepSummary summary =
        sim::WriteCellsCsv(plan, database, cells, [&csv](std::string_view piece) { csv += piece; });
    files.Write([&](const std::filesystem::path& place) {
      sim::WriteOutputFile(place / "cells.csv", csv);
      sim::WriteOutputFile(place / "report.html",
                           sim::SweepPage(plan, database, cells, summary, response));
      sim::WriteAnswer(place, sim::SweepText(plan, summary, response, false),
                       sim::SweepText(plan, summary, response, true));
    });
    files.Commit();
    folder.Keep();
    if (summary.results == 0) {
      throw sim::RunError("no setting has scores: " + summary.first_problem);
    }
    sim::WriteSweepJson(plan, database, cells, summary,
                        [&json](std::string_view piece) { json += piece; });
    text = sim::SweepText(plan, summary, response, false);
    verbose = sim::SweepText(plan, summary, response, true);
  };
  const std::vector<std::string> remarks = RunLong(on_progress, run, elsewhere);
  py::dict dict;
  dict["json"] = json;
  dict["csv"] = csv;
  dict["remarks"] = remarks;
  AddText(text, verbose, dict);
  return dict;
}

}  // namespace

void BindSearches(py::module_& module) {
  module.def(
      "tune",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::string& controller,
         const std::vector<std::string>& free, const std::string& minimise,
         const std::vector<std::string>& subject_to, int seeds, int held_out, int evaluations,
         bool all, bool filter_only, int jobs, bool allow_programs, const py::dict& filters,
         const py::object& executor, const py::object& on_progress) {
        return Tune({.controller = controller,
                     .free = free,
                     .minimise = minimise,
                     .subject_to = subject_to,
                     .seeds = seeds,
                     .held_out = held_out,
                     .evaluations = evaluations,
                     .all = all,
                     .filter_only = filter_only},
                    {file, text}, overrides, jobs, {allow_programs, OwnObjectsOf(filters)},
                    executor, on_progress);
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("controller"),
      py::arg("free"), py::arg("minimise"), py::arg("subject_to"), py::arg("seeds"),
      py::arg("held_out"), py::arg("evaluations"), py::arg("all"), py::arg("filter_only"),
      py::arg("jobs"), py::arg("allow_programs"), py::arg("filters"), py::arg("executor"),
      py::arg("on_progress"));
  module.def(
      "run_kinds",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::string& controller,
         const std::string& minimise, const std::vector<std::string>& subject_to, int seeds,
         int held_out, int evaluations, bool filter_only, bool allow_programs,
         const py::dict& filters, const std::string& call, std::int64_t first, std::int64_t end,
         const std::string& database) {
        RunPartOf(call, {allow_programs, OwnObjectsOf(filters)}, [&] {
          RunKindsOfPart({.controller = controller,
                          .free = {},
                          .minimise = minimise,
                          .subject_to = subject_to,
                          .seeds = seeds,
                          .held_out = held_out,
                          .evaluations = evaluations,
                          .all = true,
                          .filter_only = filter_only},
                         {file, text}, overrides, {{first, end}, database});
        });
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("controller"),
      py::arg("minimise"), py::arg("subject_to"), py::arg("seeds"), py::arg("held_out"),
      py::arg("evaluations"), py::arg("filter_only"), py::arg("allow_programs"), py::arg("filters"),
      py::arg("call"), py::arg("first"), py::arg("end"), py::arg("database"));
  module.def(
      "run_setting",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::string& controller,
         const std::vector<std::string>& free, bool filter_only, bool allow_programs,
         const std::vector<std::string>& about, const py::dict& filters, const std::string& call,
         std::int64_t first, std::int64_t end, const std::string& database) {
        RunPartOf(call, {allow_programs, OwnObjectsOf(filters)}, [&] {
          RunSettingOfPart({.controller = controller,
                            .free = free,
                            .subject_to = {},
                            .filter_only = filter_only},
                           {file, text}, overrides, about, {{first, end}, database});
        });
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("controller"),
      py::arg("free"), py::arg("filter_only"), py::arg("allow_programs"), py::arg("about"),
      py::arg("filters"), py::arg("call"), py::arg("first"), py::arg("end"), py::arg("database"));
  module.def(
      "sweep",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::optional<int>& seeds,
         bool filter_only, int jobs, const std::string& out, bool allow_programs,
         const py::dict& filters, const py::object& executor, const py::object& on_progress) {
        return Sweep({file, text}, {.seeds = seeds, .filter_only = filter_only, .set = overrides},
                     jobs, out, {allow_programs, OwnObjectsOf(filters)}, executor, on_progress);
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("seeds"),
      py::arg("filter_only"), py::arg("jobs"), py::arg("out"), py::arg("allow_programs"),
      py::arg("filters"), py::arg("executor"), py::arg("on_progress"));
  module.def(
      "run_cells",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::optional<int>& seeds,
         bool filter_only, bool allow_programs, const py::dict& filters, const std::string& call,
         std::int64_t first, std::int64_t end, const std::string& database) {
        RunPartOf(call, {allow_programs, OwnObjectsOf(filters)}, [&] {
          RunCellsOfPart({file, text},
                         {.seeds = seeds, .filter_only = filter_only, .set = overrides},
                         {{first, end}, database});
        });
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("seeds"),
      py::arg("filter_only"), py::arg("allow_programs"), py::arg("filters"), py::arg("call"),
      py::arg("first"), py::arg("end"), py::arg("database"));
}

}  // namespace gauntlet::python
