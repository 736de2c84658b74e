#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/bindings.h"
#include "python/long_call.h"
#include "python/results.h"
#include "sim/base/text.h"
#include "sim/fit/audit.h"
#include "sim/fit/chain_episodes.h"
#include "sim/fit/chain_log.h"
#include "sim/fit/identified_hand.h"
#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/inspect/inspection_tables.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

/// {"json", "page", "chain_yaml", "servo_yaml", "text", "html", "tables", "remarks"}.
py::dict Identify(const std::string& log, const sim::HandLogOptions& options, bool held,
                  const py::object& on_progress) {
  std::optional<sim::IdentifiedHand> found;
  std::string page;
  const std::vector<std::string> remarks = RunLong(on_progress, [&](LongWork& work) {
    sim::ChainEpisodes episodes = sim::LoadHandLog(log, options);
    for (sim::ChainLog& episode : episodes.logs) episode.held = held;
    found = sim::IdentifyHand(std::move(episodes),
                              [&](int done, int all) { work.Progress(done, all); });
    page = sim::ChainPage(found->result, found->chain, "chain.yaml");
    const sim::ChainLog& shown = found->result.log();
    if (!shown.columns_ignored.empty()) {
      work.Remark(fmt::format("{}: ignored columns that are no command, angle or motor: {}",
                              shown.name, fmt::join(shown.columns_ignored, ", ")));
    }
    if (shown.values_missing > 0) {
      work.Remark(fmt::format("{}: {} missing values, straight lines go over them", shown.name,
                              shown.values_missing));
    }
  });
  const std::string name = "chain.yaml";
  py::dict dict;
  dict["json"] = sim::ChainJson(found->result, sim::VerdictOf(found->result, found->chain, name));
  dict["page"] = page;
  dict["chain_yaml"] = found->chain_yaml;
  dict["servo_yaml"] = found->servo_yaml;
  dict["remarks"] = remarks;
  AddText(sim::ChainAnswer(found->result, found->chain, name, false),
          sim::ChainAnswer(found->result, found->chain, name, true), dict);
  return dict;
}

/// {"json", "page", "text", "html", "tables", "remarks"}.
py::dict AuditOf(const std::string& log, const sim::ChainLogOptions& options,
                 const py::object& on_progress) {
  std::optional<sim::Audit> audit;
  std::string page;
  const std::vector<std::string> remarks = RunLong(on_progress, [&](LongWork& work) {
    constexpr int kParts = 1000;
    audit = sim::AuditLog(log, options, [&](double share) {
      work.Progress(static_cast<int>(share * kParts), kParts);
    });
    page = sim::AuditPage(*audit);
    if (!audit->ignored.empty()) {
      work.Remark(
          fmt::format("{}: ignored columns: {}", audit->name, fmt::join(audit->ignored, ", ")));
    }
  });
  py::dict dict;
  dict["json"] = sim::AuditJson(*audit);
  dict["page"] = page;
  dict["remarks"] = remarks;
  AddText(sim::AuditText(*audit, false), sim::AuditText(*audit, true), dict);
  return dict;
}

/// {"json", "question", "starter_map", "text", "html", "tables", "remarks"}.
py::dict Inspect(const std::string& file, const sim::InspectionOptions& options,
                 const py::object& on_progress) {
  sim::Inspection inspection;
  const std::vector<std::string> remarks =
      RunLong(on_progress, [&](LongWork&) { inspection = sim::Inspect(file, options); });
  const bool has_columns = inspection.layout.columns > 0;
  py::dict dict;
  dict["json"] = sim::InspectionJson(inspection);
  dict["question"] = inspection.question;
  dict["starter_map"] = inspection.Sensors().empty() ? "" : sim::StarterMap(inspection);
  dict["remarks"] = remarks;
  sim::ResultText text = {has_columns ? sim::SummaryOf(inspection) : inspection.question};
  sim::ResultText verbose = text;
  if (has_columns) {
    text.emplace_back(sim::ColumnsTable(inspection, false));
    verbose.emplace_back(sim::ColumnsTable(inspection, true));
  } else {
    text.emplace_back(sim::TopicsTable(inspection.topics));
    verbose = text;
  }
  AddText(text, verbose, dict);
  return dict;
}

}  // namespace

void BindLogs(py::module_& module) {
  module.def(
      "identify",
      [](const std::string& log, const std::string& controller, bool from_wearer,
         const std::string& array, const std::string& map, const std::string& unit,
         const std::optional<int>& episode, double rate_hz, const std::string& command,
         const std::string& state, bool held, const py::object& on_progress) {
        return Identify(log,
                        {.controller = controller,
                         .from_wearer = from_wearer,
                         .table = {.array = array,
                                   .map = map,
                                   .unit = unit,
                                   .episode = episode,
                                   .rate_hz = rate_hz,
                                   .command = command,
                                   .state = state}},
                        held, on_progress);
      },
      py::arg("log"), py::arg("controller"), py::arg("from_wearer"), py::arg("array"),
      py::arg("map"), py::arg("unit"), py::arg("episode"), py::arg("rate_hz"), py::arg("command"),
      py::arg("state"), py::arg("held"), py::arg("on_progress"));
  module.def(
      "audit",
      [](const std::string& log, const std::string& array, const std::string& command,
         const std::string& state, const std::string& map, const std::string& unit,
         const std::optional<int>& episode, double rate_hz, const py::object& on_progress) {
        return AuditOf(log,
                       {.array = array,
                        .map = map,
                        .unit = unit,
                        .episode = episode,
                        .rate_hz = rate_hz,
                        .command = command,
                        .state = state},
                       on_progress);
      },
      py::arg("log"), py::arg("array"), py::arg("command"), py::arg("state"), py::arg("map"),
      py::arg("unit"), py::arg("episode"), py::arg("rate_hz"), py::arg("on_progress"));
  module.def(
      "inspect",
      [](const std::string& file, double rate_hz, const std::string& array,
         const std::string& preset, const std::string& hand, const std::string& map,
         const std::string& unit, const std::string& time_unit,
         const std::optional<std::pair<std::size_t, std::size_t>>& columns,
         const py::object& on_progress) {
        return Inspect(file,
                       {.rate_hz = rate_hz,
                        .array = array,
                        .map = map,
                        .time_unit = time_unit,
                        .joints = {.preset = preset, .hand = hand, .unit = unit},
                        .columns = columns},
                       on_progress);
      },
      py::arg("file"), py::arg("rate_hz"), py::arg("array"), py::arg("preset"), py::arg("hand"),
      py::arg("map"), py::arg("unit"), py::arg("time_unit"), py::arg("columns"),
      py::arg("on_progress"));
}

}  // namespace gauntlet::python
