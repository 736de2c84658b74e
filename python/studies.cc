#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/arrays.h"
#include "python/bindings.h"
#include "python/elsewhere.h"
#include "python/long_call.h"
#include "python/own_filters.h"
#include "python/results.h"
#include "python/sources.h"
#include "sim/answers/compare/finish_study.h"
#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/base/stop.h"
#include "sim/base/threads.h"
#include "sim/results/runs.h"
#include "sim/show/pages/front_chart.h"
#include "sim/show/pages/score_table.h"
#include "sim/show/pages/study_folder_files.h"
#include "sim/study/made_with.h"
#include "sim/study/trial_table/study_database.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

struct StudyRequest {
  SettingsSource scenario;
  std::vector<std::string> overrides;
  std::vector<std::string> controllers;
  bool comparison = false;
  int seeds = 0;  // 0: of a comparison, as the program
  int jobs = 0;
  std::string causes = "auto";
  std::string out;  // empty: no files
  sim::TraceFormats formats = {};
  OwnFilters own_filters = {};
};

using Finished = std::shared_ptr<sim::FinishedStudy>;

sim::Scenario ReadScenario(const sim::ScenarioSource& source, const StudyRequest& request,
                           LongWork& work) {
  sim::Scenario scenario = sim::ParseScenario(source);
  const std::string lost = sim::KeepControllers(request.controllers, scenario);
  if (!lost.empty()) {
    work.Remark(
        fmt::format("the baseline {} is not among the controllers: the rule for scenarios "
                    "that name none decides",
                    lost));
  }
  return scenario;
}

int SeedsOf(const StudyRequest& request, const sim::Scenario& scenario) {
  if (request.seeds > 0) return request.seeds;
  return request.comparison ? sim::SeedsOfComparison(scenario) : 1;
}

/// Runs some trials of a comparison, on one thread, into a study.db.
void RunTrialsOfPart(const StudyRequest& request, const PartRequest& part) {
  const sim::ScenarioSource source = ScenarioSourceOf(request.scenario, request.overrides);
  sim::Scenario scenario = sim::ParseScenario(source);
  sim::KeepControllers(request.controllers, scenario);
  const int seeds = SeedsOf(request, scenario);
  const sim::Study study = sim::PrepareStudy(source, std::move(scenario));
  sim::StudyDatabase database(part.database, study, {.seeds = seeds});
  sim::RunSomeTrials(study,
                     {.seeds = seeds,
                      .progress = [](double, int) { return !sim::StopAsked(); },
                      .keep_first_traces = false,
                      .causes = sim::CauseSeedsOf(request.causes),
                      .store = &database},
                     part.range);
  if (const auto not_kept = database.Finish()) throw sim::RunError(*not_kept);
}

/// Runs a study in the same steps as `gauntlet run` and `compare`.
void RunStudy(const StudyRequest& request, ExecutorParts* elsewhere, LongWork& work,
              sim::FinishedStudy& finished) {
  const OwnFiltersOfCall own_filters(request.own_filters, elsewhere ? elsewhere->call() : "");
  const sim::CauseSeeds causes = sim::CauseSeedsOf(request.causes);
  const sim::ScenarioSource source = ScenarioSourceOf(request.scenario, request.overrides);
  sim::Scenario scenario = ReadScenario(source, request, work);
  const int seeds = SeedsOf(request, scenario);
  finished.comparison = request.comparison;
  finished.choices =
      sim::ChoicesText({.set = request.overrides, .controllers = request.controllers});
  if (!request.out.empty()) sim::SetSignalFolder(request.out);
  finished.study = sim::PrepareStudy(source, std::move(scenario));
  for (const std::string& line : sim::WarningsOf(finished.study)) work.Remark(line);
  const auto finish = [&] {
    return sim::FinishStudy(
        {.seeds = seeds,
         .jobs = sim::JobsOrCores(request.jobs),
         .causes = causes,
         .progress = [&](double done, int all) { return work.Progress(done, all); },
         .note = [&](const std::string& line) { work.Remark(line); },
         .remark = [&](const std::string& line) { work.Remark(line); },
         .elsewhere = elsewhere},
        finished);
  };
  std::optional<std::string> not_kept;
  if (request.out.empty()) {
    finish();
  } else {
    if (!request.comparison && sim::HoldsComparison(request.out)) {
      work.Remark(request.out +
                  " contained a comparison; this run replaces its scores, page and trace");
    }
    sim::OutputFolder folder(request.out);
    finished.folder = folder.path();
    sim::OutputFiles files = sim::FilesOfStudy(finished);
    not_kept = finish();
    sim::WriteStudyFolder(finished, request.formats, false, files);
    folder.Keep();
  }
  for (const std::string& line : sim::Failures(finished.summary, finished.result.seeds.size())) {
    work.Remark("warning: " + line);
  }
  if (not_kept) throw sim::RunError(*not_kept);
}

std::pair<Finished, std::vector<std::string>> Run(const StudyRequest& request,
                                                  const py::object& executor,
                                                  const py::object& on_progress) {
  auto finished = std::make_shared<sim::FinishedStudy>();
  const std::unique_ptr<ExecutorParts> parts = PartsOf(executor);
  ExecutorParts* const elsewhere = parts.get();
  std::vector<std::string> remarks = RunLong(
      on_progress, [&](LongWork& work) { RunStudy(request, elsewhere, work, *finished); },
      elsewhere);
  return {std::move(finished), std::move(remarks)};
}

py::dict TextOf(const sim::FinishedStudy& finished) {
  py::dict dict;
  AddText(sim::ScoreText(finished, false), sim::ScoreText(finished, true), dict);
  return dict;
}

/// What a column of a signal is.
constexpr const char* ColumnOf(sim::TraceColumns columns) {
  constexpr const char* kNames[] = {"channel", "joint",  "motor",  "cable", "object", "pose",
                                    "force",   "digits", "sensor", "link",  "axis"};
  return kNames[static_cast<std::size_t>(columns)];
}

/// The signals of a controller in the first seed, by name: (array, names of columns, unit, what a
/// column is).
py::dict TraceOf(const Finished& finished, std::size_t controller) {
  const sim::Study& study = finished->study;
  const sim::Trace& trace = finished->result.first_traces.at(controller);
  const bool has_links = trace.sample_age_s.cols() > 0;
  const sim::TraceColumnNames names(study.channel_names(), *study.hand, has_links);
  py::dict signals;
  sim::ForEachSignal(trace, [&](const auto& signal, const auto& matrix) {
    if (matrix.cols() == 0) return;
    signals[py::str(std::string(signal.name))] =
        py::make_tuple(ViewOf(matrix, finished), names.Of(signal.columns), std::string(signal.unit),
                       ColumnOf(signal.columns));
  });
  return signals;
}

/// Signals that all controllers share, likewise.
py::dict SharedSignalsOf(const Finished& finished) {
  const sim::GloveSignal& glove = *finished->result.first_glove;
  py::dict signals;
  const char* const channel = ColumnOf(sim::TraceColumns::kChannels);
  signals["counts"] =
      py::make_tuple(ViewOf(glove.counts, finished), glove.channel_names, "counts", channel);
  signals["true_angle_rad"] =
      py::make_tuple(ViewOf(glove.true_angle_rad, finished), glove.channel_names, "rad", channel);
  signals["reference_angle_rad"] = py::make_tuple(
      ViewOf(finished->result.first_reference_rad, finished), finished->study.hand->joint_names(),
      "rad", ColumnOf(sim::TraceColumns::kJoints));
  return signals;
}

}  // namespace

void BindStudies(py::module_& module) {
  py::class_<sim::FinishedStudy, Finished>(module, "FinishedStudy")
      .def_property_readonly(
          "name", [](const sim::FinishedStudy& self) { return self.study.scenario.name; })
      .def_property_readonly(
          "controllers",
          [](const sim::FinishedStudy& self) { return self.result.controller_names; })
      .def_property_readonly(
          "tick_rate_hz",
          [](const sim::FinishedStudy& self) { return self.result.first_glove->tick_rate_hz; })
      .def_property_readonly(
          "sample_rate_hz",
          [](const sim::FinishedStudy& self) { return self.result.first_glove->rate_hz; })
      .def("scores_json", [](const sim::FinishedStudy& self) { return sim::ScoresJson(self); })
      .def("scores_csv", [](const sim::FinishedStudy& self) { return sim::ScoresCsv(self.result); })
      .def("resolved_scenario",
           [](const sim::FinishedStudy& self) { return sim::ResolvedScenario(self); })
      .def("report_page",
           [](const sim::FinishedStudy& self) { return sim::StudyPage(self, false); })
      .def("figure",
           [](const sim::FinishedStudy& self) { return sim::ControllersFrontFile(self.summary); })
      .def("texts", &TextOf)
      .def("trace",
           [](const Finished& self, std::size_t controller) { return TraceOf(self, controller); })
      .def("shared_signals", [](const Finished& self) { return SharedSignalsOf(self); });
  module.def(
      "run_study",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::vector<std::string>& controllers,
         bool comparison, int seeds, int jobs, const std::string& causes, const std::string& out,
         bool csv, bool mcap, bool allow_programs, const py::dict& filters,
         const py::object& executor, const py::object& on_progress) {
        return Run({.scenario = {file, text},
                    .overrides = overrides,
                    .controllers = controllers,
                    .comparison = comparison,
                    .seeds = seeds,
                    .jobs = jobs,
                    .causes = causes,
                    .out = out,
                    .formats = {.csv = csv, .mcap = mcap},
                    .own_filters = {allow_programs, OwnObjectsOf(filters)}},
                   executor, on_progress);
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("controllers"),
      py::arg("comparison"), py::arg("seeds"), py::arg("jobs"), py::arg("causes"), py::arg("out"),
      py::arg("csv"), py::arg("mcap"), py::arg("allow_programs"), py::arg("filters"),
      py::arg("executor"), py::arg("on_progress"));
  module.def(
      "run_trials",
      [](const std::string& file, const std::optional<std::string>& text,
         const std::vector<std::string>& overrides, const std::vector<std::string>& controllers,
         int seeds, const std::string& causes, bool allow_programs, const py::dict& filters,
         const std::string& call, std::int64_t first, std::int64_t end,
         const std::string& database) {
        RunPartOf(call, {allow_programs, OwnObjectsOf(filters)}, [&] {
          RunTrialsOfPart({.scenario = {file, text},
                           .overrides = overrides,
                           .controllers = controllers,
                           .comparison = true,
                           .seeds = seeds,
                           .causes = causes,
                           .out = {}},
                          {{first, end}, database});
        });
      },
      py::arg("file"), py::arg("text"), py::arg("overrides"), py::arg("controllers"),
      py::arg("seeds"), py::arg("causes"), py::arg("allow_programs"), py::arg("filters"),
      py::arg("call"), py::arg("first"), py::arg("end"), py::arg("database"));
}

}  // namespace gauntlet::python
