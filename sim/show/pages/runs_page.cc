#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/limited_text.h"
#include "sim/base/output_file.h"
#include "sim/results/html_text.h"
#include "sim/results/runs.h"
#include "sim/show/figure/panel.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Means of a controller or a setting. Units: ms, deg RMS.
struct Place {
  double delay_ms = 0.0;
  double jitter_deg = 0.0;
  bool is_answer = false;
};

double NumberIn(const Json& scores, const char* key) {
  if (!scores.is_object() || !scores.contains(key)) return kNaN;
  const Json& value = scores.at(key);
  if (value.is_object()) return NumberIn(value, "mean");
  return value.is_number() ? value.get<double>() : kNaN;
}

void AddPlace(const Json& scores, bool is_answer, std::vector<Place>& places) {
  const Place place{NumberIn(scores, "delay_ms"), NumberIn(scores, "jitter_rms_deg"), is_answer};
  if (std::isfinite(place.delay_ms) && std::isfinite(place.jitter_deg)) places.push_back(place);
}

/// Controllers of scores.json; else settings of the page's data. None where a file is missing, too
/// large or another.
std::vector<Place> PlacesOf(const fs::path& folder) {
  std::vector<Place> places;
  std::error_code error;
  try {
    if (fs::exists(folder / "scores.json", error)) {
      const Json json = Json::parse(LimitedText(folder / "scores.json", kMostScoreBytes));
      const Json& recommended = json.at("verdict").at("recommended");
      for (const Json& controller : json.at("controllers")) {
        AddPlace(controller.at("summary"), controller.at("name") == recommended, places);
      }
      return places;
    }
    const std::string page = LimitedText(folder / "report.html", kMostEditableBytes);
    constexpr std::string_view kData = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = page.find(kData);
    if (begin == std::string::npos) return {};
    const std::size_t end = page.find("</script>", begin);
    const Json points = Json::parse(
        std::string_view(page).substr(begin + kData.size(), end - begin - kData.size()));
    if (!points.is_array()) return {};
    for (const Json& point : points) AddPlace(point.at("scores"), places.empty(), places);
  } catch (const JsonError&) {
    return {};
  } catch (const UserError&) {
    return {};
  }
  return places;
}

std::string PictureOf(const std::vector<Place>& places) {
  if (places.empty()) return "";
  Extent delays, jitters;
  jitters.Include(0.0);
  for (const Place& place : places) {
    delays.Include(place.delay_ms);
    jitters.Include(place.jitter_deg);
  }
  delays.Widen(0.1);
  jitters.high += 0.1 * jitters.high;
  Figure figure{190.0, 104.0, "run", "Jitter over delay of each controller or setting"};
  const FigureBox area = {8.0, 18.0, 186.0, 84.0};
  const Panel panel(area, {delays}, {jitters});
  figure.Line({area.left, area.bottom}, {area.right, area.bottom}, {"axis"});
  figure.Line({area.left, area.top}, {area.left, area.bottom}, {"axis"});
  for (const bool is_answer : {false, true}) {
    for (const Place& place : places) {
      if (place.is_answer != is_answer) continue;
      figure.Dot(
          panel.At(place.delay_ms, place.jitter_deg), is_answer ? 5.0 : 3.5,
          {.css = is_answer ? "chosen" : "",
           .said = fmt::format("{:.3g} ms, {:.3g} deg RMS", place.delay_ms, place.jitter_deg)});
    }
  }
  figure.Text({area.right, area.bottom + 16.0}, Anchor::kEnd, "delay");
  figure.Text({0.0, 11.0}, Anchor::kStart, "jitter");
  return SvgOf(figure);
}

/// A relative address of a file; bytes that mean something there are escaped.
std::string UrlOf(const fs::path& file) {
  std::string url;
  for (const char c : file.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain =
        std::isalnum(byte) != 0 || std::string_view("/._-~").find(c) != std::string_view::npos;
    url += is_plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return url;
}

std::string ItemOf(const Run& run, const fs::path& folder) {
  std::error_code error;
  std::string name = EscapeHtml(run.folder.string());
  const fs::path page = run.folder / "report.html";
  if (fs::is_regular_file(page, error)) {
    const fs::path link = fs::proximate(page, folder, error);
    name = fmt::format("<a href=\"{}\">{}</a>", EscapeHtml(UrlOf(link)), name);
  }
  const std::string choices =
      run.choices.empty()
          ? ""
          : fmt::format("<p class=\"note\"><code>{}</code></p>\n", EscapeHtml(run.choices));
  return fmt::format(
      "<li>\n<div><h3>{}</h3>\n<p class=\"note\">{}</p>\n{}<p>{}</p>\n<p class=\"note small\">{} · "
      "{}</p></div>\n{}</li>\n",
      name, EscapeHtml(run.question), choices, EscapeHtml(run.answer), run.written,
      SizeText(run.bytes), PictureOf(PlacesOf(run.folder)));
}

}  // namespace

std::string RunsPage(const std::vector<Run>& runs, const fs::path& folder) {
  std::string items;
  std::uintmax_t bytes = 0;
  for (const Run& run : runs) {
    items += ItemOf(run, folder);
    bytes += run.bytes;
  }
  PageHead head{.kind = "Gauntlet list runs", .title = "Runs", .facts = "The newest first."};
  head.numbers = {{.name = "output folders", .value = fmt::to_string(runs.size())},
                  {.name = "size", .value = SizeText(bytes)}};
  if (!runs.empty()) {
    head.numbers.insert(head.numbers.begin() + 1,
                        {.name = "newest", .value = runs.front().written});
  }
  return PlainPage({.head = std::move(head),
                    .heading = "Answers",
                    .table = runs.empty() ? "<p class=\"note\">None.</p>\n"
                                          : "<ul class=\"runs\">\n" + items + "</ul>\n",
                    .sections = ""});
}

void WriteRunsPage(const std::vector<Run>& runs, const fs::path& page) {
  RefuseInput(page);
  MakeDirectoryOf(page);
  WriteOutputFile(page, RunsPage(runs, page.has_parent_path() ? page.parent_path() : "."));
}

}  // namespace gauntlet::sim
