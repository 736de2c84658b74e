#include "sim/settings/libraries/like_filter.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/settings/input_unit.h"
#include "sim/settings/yaml_reader.h"

namespace gauntlet::sim {
namespace {

/// The keys of such a filter.
struct LikeKeys {
  LikeSettings& settings;
  std::string kind = {};
  std::string library = {};
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Text({.key = "kind", .help = "", .required = true}, kind);
    visitor.Text({.key = "like", .help = "", .required = true}, library);
    visitor.Texts({"channels", ""}, channels);
    settings.Visit(visitor);
  }
};

/// The error at the key of the filter, or at the filter for a key that is not there.
UserError AtKey(const YamlNode& node, const std::string& path, const YamlSource& source,
                const controller::SettingError& error) {
  const YamlNode& key = ChildOf(node, error.key());
  return source.At(key.IsDefined() ? key : node,
                   controller::SettingError(path.empty() ? error.key() : path + "." + error.key(),
                                            error.problem()));
}

/// Errors: SettingError for a unit that no signal of a controller has.
void RefuseCoordinates(std::string_view unit) {
  if (unit != "m") return;
  throw controller::SettingError(
      "unit",
      "is m, of coordinates: those are filtered before they are angles. Filter the file with "
      "gauntlet filter, and compare the result with compare FILE --add RESULT");
}

const Library& LibraryOf(const std::string& name) {
  const Library& library = FindLibrary(name);
  if (library.like != nullptr) return library;
  throw controller::SettingError("like", name +
                                             " has no settings that can be read; its filters are "
                                             "those of Gauntlet (gauntlet export --for)");
}

YamlNode WithoutLike(const YamlNode& node) {
  std::vector<YamlNode::Entry> kept;
  for (const auto& entry : node.entries()) {
    const std::string& key = entry.first.text();
    if (key == "kind" || key == "channels") kept.push_back(entry);
  }
  return YamlNode::Map(std::move(kept), node.place());
}

}  // namespace

controller::FilterSettings LikeFilter::At(double rate_hz, std::string_view unit,
                                          const YamlSource& source) const {
  try {
    controller::FilterSettings own = settings->At(rate_hz);
    const std::string given = settings->unit();
    if (settings->DependsOnUnit().empty() || unit.empty() || given == unit) return own;
    RefuseCoordinates(given);
    if (given == "counts" || unit == "counts") {
      throw controller::SettingError("unit",
                                     fmt::format("is {}, must be {}, that of the signal", given,
                                                 unit == "counts" ? "counts" : "deg or rad"));
    }
    return WithInputUnit(own, given == "rad" ? kDegPerRad : kRadPerDeg);
  } catch (const controller::SettingError& error) {
    throw AtKey(node, path, source, error);
  }
}

std::optional<LikeFilter> ExtractLikeFilter(YamlNode& filter, std::string path,
                                            const YamlSource& source) {
  if (!ChildOf(filter, "like").IsDefined()) return {};
  LikeFilter like{.path = std::move(path), .node = filter, .settings = {}};
  try {
    const Library& library = LibraryOf(ChildOf(filter, "like").text());
    like.settings = library.like();
    LikeKeys keys{.settings = *like.settings};
    YamlReader reader(filter, like.path, source);
    keys.Visit(reader);
    reader.RejectUnknownKeys();
    if (keys.kind != library.like_kind) {
      throw controller::SettingError(
          "kind", fmt::format("is {}, must be {}", keys.kind, library.like_kind));
    }
    if (!like.settings->DependsOnUnit().empty() && like.settings->unit().empty()) {
      throw controller::SettingError("unit",
                                     fmt::format("must be given: {} of the signal (deg, rad, "
                                                 "counts or m)",
                                                 like.settings->DependsOnUnit()));
    }
    if (!like.path.empty()) RefuseCoordinates(like.settings->unit());  // else a stream has it
  } catch (const controller::SettingError& error) {
    throw AtKey(filter, like.path, source, error);
  }
  filter = WithoutLike(filter);
  return like;
}

}  // namespace gauntlet::sim
