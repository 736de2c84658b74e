#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "sim/base/json.h"
#include "sim/fit/audit.h"
#include "sim/fit/fit_tables.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostRows = 12;   // of the table for a person
constexpr std::size_t kFirstRows = 8;   // shown of more
constexpr std::size_t kMostFaults = 3;  // of the first sentence
constexpr std::size_t kMostLooks = 2;
constexpr double kGrave = 2.0;  // severity of what is wrong with the whole data set

/// As a table calls the commands of a part.
std::string WordOf(const std::string& kind) {
  static const std::map<std::string, std::string> kWords = {
      {"target", "targets"},         {"copy", "copies"},
      {"next_row", "next row"},      {"later_row", "later row"},
      {"earlier_row", "row before"}, {"velocity", "speeds"},
      {"mixed", "partly copies"},    {"ahead", "behind angle"},
      {"opposite", "opposite"},      {"other_part", "another part's"},
      {"unrelated", "unrelated"},    {"still", "still"},
      {"command_still", "still"},    {"angle_still", "targets?"},
      {"missing", "missing"}};
  const auto found = kWords.find(kind);
  return found == kWords.end() ? kind : found->second;
}

/// Commands that say nothing of how the hand follows, but are no fault of a joint.
bool IsOtherKind(const AuditedPart& part) { return !part.is_target() && part.kind != "still"; }

double SeverityOf(const AuditedPart& part) {
  if (IsOtherKind(part)) return 10.0;
  return part.faults.empty() ? 0.0 : part.faults.front().severity;
}

std::vector<const AuditedPart*> AllParts(const Audit& audit) {
  std::vector<const AuditedPart*> parts;
  for (const AuditedPart& part : audit.parts) parts.push_back(&part);
  return parts;
}

/// The parts, the one with the worst fault first.
std::vector<const AuditedPart*> ByFault(const Audit& audit) {
  std::vector<const AuditedPart*> parts = AllParts(audit);
  std::ranges::stable_sort(parts, [](const AuditedPart* a, const AuditedPart* b) {
    return SeverityOf(*a) > SeverityOf(*b);
  });
  return parts;
}

/// "offset", "offset +1"
std::string FaultsText(const AuditedPart& part) {
  if (part.faults.empty()) return "";
  std::string key = part.faults.front().key;
  std::ranges::replace(key, '_', ' ');
  return part.faults.size() == 1 ? key : fmt::format("{} +{}", key, part.faults.size() - 1);
}

ResultTable TableOf(const Audit& audit, const std::vector<const AuditedPart*>& parts,
                    bool verbose) {
  const std::string& unit = audit.unit;
  const bool any_fault =
      std::ranges::any_of(parts, [](const AuditedPart* part) { return !part->faults.empty(); });
  const auto value = [any = std::ranges::any_of(audit.parts, &AuditedPart::is_target)](
                         const char* heading, bool shown = true) {
    return any && shown ? heading : "";
  };
  ResultTable table{.columns = {{"part", "part"},
                                ResultColumn("kind", "commands").Words(),
                                IntervalColumn("delay_ms", value("delay (95 % CI)"), "ms"),
                                {"delay_low_ms"},
                                {"delay_high_ms"},
                                {"offset_" + unit, value("offset"), unit},
                                IntervalColumn("gain", value("gain"), ""),
                                {"rest_error_" + unit, value("at rest", verbose), unit + " RMS"},
                                {"residual_rms_" + unit, value("residual", verbose), unit + " RMS"},
                                {"travel_" + unit},
                                ResultColumn("", any_fault ? "fault" : "").Words()}};
  double most_travel = 0.0;
  for (const AuditedPart* const part : parts) most_travel = std::max(most_travel, part->travel);
  const int digits = most_travel > 10.0 ? 2 : most_travel > 1.0 ? 3 : 4;
  constexpr double kWide_ms = 3.0;  // of the interval: its tenths mean nothing
  for (const AuditedPart* const part : parts) {
    const bool is_wide = part->delay_ms.high - part->delay_ms.low > kWide_ms;
    // A unit of its own stands behind the value.
    const auto in_unit = [&](double quantity) {
      ResultCell cell = FixedCell(quantity, digits);
      if (part->unit == unit || !std::isfinite(quantity)) return cell;
      return ResultCell{cell.values, fmt::format("{:.3g} {}", quantity, part->unit)};
    };
    ResultCell gain = FixedCell(part->gain.value, 2);
    gain.values = {part->gain.value, part->gain.low, part->gain.high};
    table.rows.push_back({ResultCell(part->name),
                          {{part->kind}, WordOf(part->kind)},
                          IntervalCell(part->delay_ms, is_wide ? 0 : 1),
                          ResultCell(part->delay_low_ms),
                          ResultCell(part->delay_high_ms),
                          in_unit(part->offset),
                          std::move(gain),
                          in_unit(part->rest_error),
                          in_unit(part->residual),
                          ResultCell(part->travel),
                          ResultCell::Text(FaultsText(*part))});
  }
  return table;
}

/// "all 6 parts", "wrist", "wrist and thumb", "thumb, index, middle and 3 others"
std::string PartsText(const std::vector<std::string>& names, std::size_t all) {
  return names.size() == all && all > 1 ? fmt::format("all {} parts", all) : FirstNames(names);
}

/// "the commands of all 6 parts are copies of the angles: ..", from "its commands are copies of its
/// angles: ..".
std::string SentenceOf(const std::string& parts, std::string text) {
  constexpr std::string_view kCommands = "its commands ";
  if (text.starts_with(kCommands)) {
    text = "the commands of " + parts + " " + text.substr(kCommands.size());
  } else {
    text = parts + ": " + text;
  }
  for (auto at = text.find("its "); at != std::string::npos; at = text.find("its ", at)) {
    text.replace(at, 3, "the");
  }
  return text;
}

/// One sentence on commands of other kinds for all parts of a kind, the largest first.
std::vector<std::string> KindSentences(const Audit& audit, bool still) {
  struct Group {
    std::string key, text;
    std::vector<std::string> names;
  };
  std::vector<Group> groups;
  for (const AuditedPart& part : audit.parts) {
    if (part.is_target() || (part.kind == "still") != still) continue;
    // Rows of episodes may differ a little: one text stands for all of a kind.
    const bool is_own = part.kind == "mixed" || part.kind == "other_part" ||
                        part.kind == "unrelated" || part.kind == "ahead" || still;
    std::string key = is_own ? part.kind_text : part.kind;
    auto found = std::ranges::find(groups, key, &Group::key);
    if (found == groups.end()) {
      groups.push_back({std::move(key), part.kind_text, {}});
      found = groups.end() - 1;
    }
    found->names.push_back(part.name);
  }
  std::ranges::stable_sort(groups, std::ranges::greater(),
                           [](const Group& group) { return group.names.size(); });
  std::vector<std::string> sentences;
  for (const Group& group : groups) {
    sentences.push_back(SentenceOf(PartsText(group.names, audit.parts.size()), group.text));
  }
  return sentences;
}

/// "a; b; c; and 3 more (--verbose)"
std::string FirstOf(std::vector<std::string> sentences, const std::string& others_at,
                    std::size_t most = kMostFaults) {
  const std::size_t count = sentences.size();
  if (count > most) {
    sentences.resize(most);
    sentences.push_back(fmt::format("and {} more ({})", count - most, others_at));
  }
  return fmt::format("{}", fmt::join(sentences, "; "));
}

std::string DelaysText(const Audit& audit) {
  std::vector<double> delays_ms;
  std::size_t targets = 0;
  for (const AuditedPart& part : audit.parts) {
    targets += part.is_target() ? 1 : 0;
    if (std::isfinite(part.delay_ms.value)) delays_ms.push_back(part.delay_ms.value);
  }
  if (targets == 0) return "";
  const std::string follow = audit.parts.size() == 1
                                 ? "The part follows its target"
                                 : fmt::format("{} of {} parts follow{} targets", targets,
                                               audit.parts.size(), targets == 1 ? "s" : "");
  if (delays_ms.empty()) return follow + ", none with a clear delay.";
  return fmt::format(
      "{}{}, with a delay of {} ms.", follow,
      delays_ms.size() == targets ? "" : fmt::format(", {} clearly", delays_ms.size()),
      RangeText(delays_ms, 0));
}

/// A fault and the parts that have it, to the letter.
struct GroupedFault {
  const AuditFault* fault = nullptr;
  std::vector<std::string> names = {};
};

std::vector<GroupedFault> GroupedFaults(const Audit& audit) {
  std::vector<GroupedFault> groups;
  for (const AuditedPart* const part : ByFault(audit)) {
    for (const AuditFault& fault : part->faults) {
      const auto same = std::ranges::find_if(
          groups, [&](const GroupedFault& group) { return group.fault->text == fault.text; });
      if (same != groups.end()) {
        same->names.push_back(part->name);
      } else {
        groups.push_back({&fault, {part->name}});
      }
    }
  }
  return groups;
}

Verdict WithWarnings(const Audit& audit, Verdict verdict) {
  for (const AuditFault& fault : audit.faults) {
    if (fault.severity <= kGrave) verdict.AddWarning(fault.key, fault.text + ".");
  }
  verdict.AddWarning("unit", audit.unit_note);
  return verdict;
}

}  // namespace

std::string ExtentText(const Audit& audit) {
  const std::string extent = fmt::format("{:.1f} s at {:.4g} Hz", audit.duration_s, audit.rate_hz);
  return audit.episodes.size() == 1 ? extent
                                    : fmt::format("{} episodes, {}", audit.episodes.size(), extent);
}

Verdict VerdictOf(const Audit& audit, const std::string& others_at) {
  Verdict verdict;
  std::vector<std::string> fix = KindSentences(audit, false);
  std::vector<std::string> look;
  bool has_offset = false;
  for (const GroupedFault& group : GroupedFaults(audit)) {
    has_offset |= group.fault->key == "offset";
    const std::string parts = PartsText(group.names, audit.parts.size());
    (group.fault->severity < 1.0 ? look : fix)
        .push_back(parts + (group.names.size() > 1 ? ": each " : " ") + group.fault->text);
  }
  for (const AuditFault& fault : audit.faults) {
    if (fault.severity > kGrave) fix.insert(fix.begin(), fault.text);
  }
  for (const AuditedPart& part : audit.parts) {
    if (!HasNoDelay(part.delay_ms.low, part.delay_ms.high, audit.rate_hz)) continue;
    look.push_back(part.name + " has no delay: its commands may be made of its angles");
  }
  const std::vector<std::string> still = KindSentences(audit, true);
  if (std::ranges::none_of(audit.parts, &AuditedPart::is_target)) {
    verdict.recommended = "unusable";
    if (fix.empty()) fix = still;
    verdict.AddReason("kind", fmt::format("Not usable as targets: {}.", FirstOf(fix, others_at)));
    return WithWarnings(audit, std::move(verdict));
  }
  if (fix.empty()) {
    verdict.recommended = "fit";
    verdict.AddReason("fit", "Fit for training. " + DelaysText(audit));
  } else {
    verdict.recommended = "fix";
    verdict.AddReason("fix", fmt::format("Fix first: {}.", FirstOf(fix, others_at)));
    verdict.AddReason("delay", DelaysText(audit));
  }
  if (!look.empty()) {
    verdict.AddReason("look", fmt::format("Look at: {}.", FirstOf(look, others_at, kMostLooks)));
  }
  for (const std::string& sentence : still) verdict.AddReason("still", sentence + ".");
  if (has_offset || verdict.recommended == "fit") {
    verdict.AddReason(
        "threshold",
        fmt::format("{} {:g} % of the motion{}.",
                    has_offset ? "Offsets count above" : "No offset is above",
                    100.0 * kOffsetOfTravel, has_offset ? ": a policy is wrong by as much" : ""));
  }
  return WithWarnings(audit, std::move(verdict));
}

ResultText AuditFindings(const Audit& audit) {
  ResultText text = {TableOf(audit, AllParts(audit), true)};
  for (const AuditedPart& part : audit.parts) {
    if (IsOtherKind(part)) AddLine(SentenceOf(part.name, part.kind_text) + ".", text);
    for (const AuditFault& fault : part.faults) {
      AddLine(part.name + " " + fault.text + ".", text);
    }
  }
  if (!audit.ignored.empty()) {
    AddLine(fmt::format("Ignored columns: {}.", fmt::join(audit.ignored, ", ")), text);
  }
  return text;
}

ResultText AuditText(const Audit& audit, bool verbose) {
  const std::size_t count = audit.parts.size();
  ResultText text = {fmt::format("{}: {}, {} part{}", audit.name, ExtentText(audit), count,
                                 count == 1 ? "" : "s")};
  AddVerdict(VerdictOf(audit), text);
  if (verbose) {
    std::ranges::move(AuditFindings(audit), std::back_inserter(text));
    return text;
  }
  std::vector<const AuditedPart*> shown = AllParts(audit);
  if (count > kMostRows) {
    shown = ByFault(audit);
    shown.resize(kFirstRows);
  }
  text.emplace_back(TableOf(audit, shown, false));
  if (count == shown.size()) return text;
  std::vector<double> delays_ms;
  for (const AuditedPart& part : audit.parts) {
    if (std::ranges::find(shown, &part) == shown.end() && std::isfinite(part.delay_ms.value)) {
      delays_ms.push_back(part.delay_ms.value);
    }
  }
  AddLine(
      fmt::format("{} other parts{} (--verbose lists them).", count - kFirstRows,
                  delays_ms.empty() ? "" : fmt::format(": delay {} ms", RangeText(delays_ms, 1))),
      text);
  return text;
}

namespace {

/// Values by keys of another unit.
Json InUnit(const Json& values, const std::string& from, const std::string& to) {
  Json result = Json::object();
  for (const auto& [key, value] : values.items()) {
    const bool has_unit = key.ends_with("_" + from);
    result[has_unit ? key.substr(0, key.size() - from.size()) + to : key] = value;
  }
  return result;
}

Json JsonOfFaults(const std::vector<AuditFault>& faults) {
  Json list = Json::array();
  for (const AuditFault& fault : faults) list.push_back({{"key", fault.key}, {"text", fault.text}});
  return list;
}

}  // namespace

std::string AuditJson(const Audit& audit) {
  Json parts = JsonOf(TableOf(audit, AllParts(audit), true));
  for (std::size_t i = 0; i < audit.parts.size(); ++i) {
    const AuditedPart& part = audit.parts[i];
    if (part.unit != audit.unit) parts[i] = InUnit(parts[i], audit.unit, part.unit);
    parts[i]["unit"] = part.unit;
    parts[i]["kind_text"] = part.kind_text;
    parts[i]["delay_stays"] = part.delay_stays;
    parts[i]["faults"] = JsonOfFaults(part.faults);
    parts[i]["episodes"] = Json::array();
    for (std::size_t e = 0; e < part.episodes.size(); ++e) {
      const AuditedEpisode& one = part.episodes[e];
      parts[i]["episodes"].push_back({{"episode", audit.episodes[e]},
                                      {"delay_ms", one.delay_ms},
                                      {"offset_" + part.unit, one.offset},
                                      {"error_rms_" + part.unit, one.residual},
                                      {"from_s", one.from_s},
                                      {"to_s", one.to_s}});
    }
  }
  const Json json = {{"log", audit.name},
                     {"episodes", audit.episodes.size()},
                     {"duration_s", audit.duration_s},
                     {"rate_hz", audit.rate_hz},
                     {"angle_unit", audit.unit == "deg" ? "deg" : "unknown"},
                     {"verdict", JsonOf(VerdictOf(audit))},
                     {"faults", JsonOfFaults(audit.faults)},
                     {"parts", parts}};
  return json.dump(2) + "\n";
}

}  // namespace gauntlet::sim
