#include "sim/settings/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "controller/number.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

using controller::SettingError;

constexpr std::size_t kMostBytes = 4'000'000;
constexpr std::size_t kMostValues = 200'000;
constexpr std::size_t kMostLevels = 64;
constexpr std::size_t kLongestPlace = 100;

/// With the item that stands alone where a list is expected named like the first of a list.
std::string WithoutFirstItems(std::string path) {
  constexpr std::string_view kFirst = "[0]";
  for (std::size_t at = 0; (at = path.find(kFirst, at)) != std::string::npos;) {
    path.erase(at, kFirst.size());
  }
  return path;
}

/// The longest of the paths that is `path` or a group around it.
template <class Value>
const Value* Nearest(const std::map<std::string, Value>& paths, const std::string& path) {
  const Value* nearest = nullptr;
  std::size_t longest = 0;
  for (const auto& [group, value] : paths) {
    if (!group.empty() && !IsAtOrBelow(WithoutFirstItems(path), WithoutFirstItems(group))) continue;
    if (nearest != nullptr && group.size() < longest) continue;
    nearest = &value;
    longest = group.size();
  }
  return nearest;
}

std::string PlaceInFile(const std::filesystem::path& file, TextPlace place) {
  return fmt::format("{}:{}:{}", file.string(), place.line + 1, place.column + 1);
}

}  // namespace

bool IsAtOrBelow(const std::string& path, const std::string& group) {
  return path == group || path.starts_with(group + ".") || path.starts_with(group + "[");
}

UserError AtPlace(std::string place, const SettingError& error) {
  return UserError({.place = std::move(place), .key = error.key(), .problem = error.problem()});
}

std::string OverridePlace(std::string_view text) {
  return OneLine("--set " + std::string(text), kLongestPlace);
}

const std::string* YamlSource::OverrideOf(const std::string& path) const {
  return Nearest(overrides, path);
}

const std::filesystem::path& YamlSource::FileOf(const std::string& path) const {
  const std::filesystem::path* nearest = Nearest(included, path);
  return nearest == nullptr ? file : *nearest;
}

std::string YamlSource::PlaceOf(const YamlNode& node, const std::string& path) const {
  if (const std::string* text = OverrideOf(path)) return OverridePlace(*text);
  if (node.place().is_known()) return PlaceInFile(FileOf(path), node.place());
  for (const auto& [key, text] : overrides) {  // made on the way to what an override sets
    if (!groups.contains(path) && IsAtOrBelow(key, path)) return OverridePlace(text);
  }
  const TextPlace* group = Nearest(groups, path);
  return group == nullptr ? FileOf(path).string() : PlaceInFile(FileOf(path), *group);
}

UserError YamlSource::At(const YamlNode& node, const SettingError& error) const {
  return UserError({.place = PlaceOf(node, error.key()),
                    .key = OneLine(error.key(), kLongestPlace),
                    .problem = error.problem()});
}

std::string ReadYamlText(const std::filesystem::path& file) {
  return LimitedText(InputFile(file), kMostBytes);
}

namespace {

/// Throws at a place of the text, which is a file or the value of a --set.
using FailAt = std::function<void(TextPlace, const std::string& problem)>;

TextPlace PlaceOfByte(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte);
  const std::size_t line_begin = before.rfind('\n') + 1;  // 0 if there is none
  return {.line = static_cast<int>(std::ranges::count(before, '\n')),
          .column = static_cast<int>(byte - line_begin)};
}

/// Errors: by `fail`, at the first byte that no text has.
void CheckBytes(std::string_view text, const FailAt& fail) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    fail(PlaceOfByte(text, 0), "is UTF-16, must be saved as UTF-8");
  }
  if (const auto bad = FirstBadByte(text)) {
    fail(PlaceOfByte(text, *bad),
         fmt::format("the byte {} is not UTF-8", OneLine(text.substr(*bad, 1))));
  }
  const auto control = std::ranges::find_if(text, [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t') ||
           c == '\x7f';
  });
  if (control != text.end()) {
    const std::size_t byte = control - text.begin();
    fail(PlaceOfByte(text, byte),
         fmt::format("has the control character {}", OneLine(text.substr(byte, 1))));
  }
}

TextPlace PlaceOf(const YAML::Mark& mark) { return {.line = mark.line, .column = mark.column}; }

/// Puts the tree of a document together, and stops at what would be too deep, too large or endless.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const FailAt& fail, YamlIncludes includes, std::size_t most_values)
      : fail_(fail), includes_(includes), most_values_(most_values) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) fail_(PlaceOf(mark), "a second document begins here, there must be one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    AddLeaf(YamlNode::Null(PlaceOf(mark)), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    if (tag != kIncludeTag || includes_ == YamlIncludes::kRefused) RefuseTag(mark, tag);
    AddLeaf(YamlNode::Scalar(text, tag, PlaceOf(mark)), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::ranges::find(open_, anchor, &Group::anchor) != open_.end()) {
      fail_(PlaceOf(mark), "stands inside what it stands for");
    }
    const Anchored& anchored = anchored_[anchor];
    Count(PlaceOf(mark), anchored.values);
    Keep(anchored.node);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor);
  }
  void OnSequenceEnd() override {
    Group group = Close();
    Add(YamlNode::Sequence(std::move(group.parts), group.place), group.anchor,
        values_ - group.values_before);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor);
  }
  void OnMapEnd() override {
    Group group = Close();
    std::vector<YamlNode::Entry> entries;
    for (std::size_t i = 0; i + 1 < group.parts.size(); i += 2) {  // a key, its value
      entries.emplace_back(std::move(group.parts[i]), std::move(group.parts[i + 1]));
    }
    Add(YamlNode::Map(std::move(entries), group.place), group.anchor,
        values_ - group.values_before);
  }

  /// The document; that of an empty one is null.
  const YamlNode& root() const { return root_; }

 private:
  struct Group {
    YAML::anchor_t anchor = YAML::NullAnchor;
    TextPlace place;
    std::size_t values_before = 0;
    std::vector<YamlNode> parts;
  };
  struct Anchored {
    YamlNode node;
    std::size_t values = 0;
  };

  void Count(TextPlace place, std::size_t values) {
    values_ += values;
    if (values_ > most_values_) fail_(place, fmt::format("has more than {} values", most_values_));
  }
  void Keep(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
    } else {
      open_.back().parts.push_back(std::move(node));
    }
  }
  void Open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    RefuseTag(mark, tag);
    if (open_.size() == kMostLevels) {
      fail_(PlaceOf(mark), fmt::format("is nested deeper than {} levels", kMostLevels));
    }
    open_.push_back(
        {.anchor = anchor, .place = PlaceOf(mark), .values_before = values_, .parts = {}});
    Count(PlaceOf(mark), 1);
  }
  Group Close() {
    Group group = std::move(open_.back());
    open_.pop_back();
    return group;
  }
  /// `values`: its own and those below it, where an alias stands for it.
  void Add(YamlNode node, YAML::anchor_t anchor, std::size_t values) {
    if (anchor != YAML::NullAnchor) anchored_[anchor] = {.node = node, .values = values};
    Keep(std::move(node));
  }
  void AddLeaf(YamlNode node, YAML::anchor_t anchor) {
    Count(node.place(), 1);
    Add(std::move(node), anchor, 1);
  }
  /// Those of YAML itself say what is known anyhow.
  void RefuseTag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?" || tag == "!" || tag.starts_with("tag:yaml.org,2002:")) return;
    if (tag == kIncludeTag) fail_(PlaceOf(mark), std::string(kMisplacedInclude));
    fail_(PlaceOf(mark), "has a tag, tags have no meaning here");
  }

  const FailAt& fail_;
  YamlIncludes includes_;
  std::size_t most_values_;
  int documents_ = 0;
  std::size_t values_ = 0;
  std::vector<Group> open_;
  std::map<YAML::anchor_t, Anchored> anchored_;
  YamlNode root_ = YamlNode::Null();
};

/// Errors: by `fail`.
YamlNode Parse(const std::string& text, YamlIncludes includes, std::size_t most_values,
               const FailAt& fail) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder(fail, includes, most_values);
    while (parser.HandleNextDocument(builder)) {
    }
    return builder.root();
  } catch (const YAML::Exception& problem) {
    // Behind a colon some have a part of the text.
    fail(PlaceOf(problem.mark), problem.msg.substr(0, problem.msg.find(':')));
    throw;
  }
}

YamlNode ParseChecked(std::string_view text, YamlIncludes includes, const FailAt& fail) {
  CheckBytes(text, fail);
  return Parse(std::string(text), includes, kMostValues, fail);
}

}  // namespace

YamlNode ParseYaml(const std::filesystem::path& file, std::string_view text,
                   YamlIncludes includes) {
  YamlNode root =
      ParseChecked(text, includes, [&file](TextPlace place, const std::string& problem) {
        throw UserError({.place = PlaceInFile(file, place), .problem = problem});
      });
  if (!root.IsMap()) {
    throw UserError({.place = file.string() + ":1:1", .problem = "must be a map of keys"});
  }
  return root;
}

YamlNode ParseOwnYaml(std::string_view text) {
  return Parse(std::string(text), YamlIncludes::kRefused, std::numeric_limits<std::size_t>::max(),
               [](TextPlace, const std::string& problem) { throw std::logic_error(problem); });
}

YamlNode ParseYamlFile(const std::filesystem::path& file) {
  return ParseYaml(file, ReadYamlText(file));
}

namespace {

/// An item of a list is `filter.1`, or `filter[1]` as messages have it.
std::vector<std::string> SplitPath(std::string_view path) {
  std::vector<std::string> keys(1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t end = path[i] == '[' ? path.find_first_not_of("0123456789", i + 1) : i;
    if (path[i] == '.') {
      keys.emplace_back();
    } else if (end > i + 1 && end < path.size() && path[end] == ']') {
      keys.emplace_back(path.substr(i + 1, end - i - 1));
      i = end;
    } else {
      keys.back() += path[i];
    }
  }
  return keys;
}

/// An override may change a controller but not invent one: a misspelt name would only add a row.
void RejectUnknownController(const YamlNode& root, const std::string& text,
                             const std::vector<std::string>& keys) {
  if (keys.size() < 2 || keys[0] != "controllers") return;
  const YamlNode& controllers = ChildOf(root, "controllers");
  if (!controllers.IsMap()) return;  // the reader says so
  std::vector<std::string> names;
  for (const auto& entry : controllers.entries()) names.push_back(entry.first.text());
  if (std::ranges::find(names, keys[1]) != names.end()) return;
  throw UserError({.place = OverridePlace(text),
                   .key = "controllers." + Shown(keys[1]),
                   .problem = "unknown controller" + Suggestion(keys[1], names)});
}

/// Puts one override over a tree.
class Override {
 public:
  Override(std::string place, YamlSource& source) : place_(std::move(place)), source_(source) {}

  /// A copy of `node` with `value` at the end of the path of keys; follows the reader's shorthands.
  YamlNode With(const YamlNode& node, std::span<const std::string> keys, const YamlNode& value) {
    if (keys.empty()) return value;
    if (node.place().is_known()) source_.groups[path_] = node.place();
    return node.IsSequence() ? WithItem(node, keys, value) : WithKey(node, keys, value);
  }

  /// The path that With() went, as the reader has it.
  const std::string& path() const { return path_; }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw UserError({.place = place_, .problem = problem});
  }

 private:
  YamlNode WithItem(const YamlNode& list, std::span<const std::string> keys,
                    const YamlNode& value) {
    const std::string& key = keys[0];
    std::vector<YamlNode> items = list.items();
    const auto item = controller::ParseWholeNumber(key, 0, std::ssize(items) - 1);
    if (!item && (controller::ParseNumber(key) || items.size() != 1)) FailAtItem(list, key);
    YamlNode& changed = items[item.value_or(0)];
    path_ += fmt::format("[{}]", item.value_or(0));
    changed = With(changed, item ? keys.subspan(1) : keys, value);
    return YamlNode::Sequence(std::move(items));
  }

  [[noreturn]] void FailAtItem(const YamlNode& list, const std::string& key) const {
    if (list.items().empty()) Fail(fmt::format("{} is an empty list", Shown(path_)));
    Fail(fmt::format("{} is a list of {}: an item is named by its number, 0 to {}, not by {}",
                     Shown(path_), list.items().size(), list.items().size() - 1, Shown(key)));
  }

  YamlNode WithKey(const YamlNode& node, std::span<const std::string> keys, const YamlNode& value) {
    path_ += path_.empty() ? keys[0] : "." + keys[0];
    std::vector<YamlNode::Entry> entries = node.entries();
    if (node.IsScalar()) entries.emplace_back(YamlNode::Scalar("kind"), node);
    const auto found = std::ranges::find_if(entries, [&keys](const YamlNode::Entry& entry) {
      return entry.first.IsScalar() && entry.first.text() == keys[0];
    });
    if (found != entries.end()) {
      found->second = With(found->second, keys.subspan(1), value);
    } else {
      entries.emplace_back(YamlNode::Scalar(keys[0]),
                           With(YamlNode::Null(), keys.subspan(1), value));
    }
    return YamlNode::Map(std::move(entries));
  }

  std::string place_;
  YamlSource& source_;
  std::string path_;
};

/// The keys of a path. Errors: by `override`.
std::vector<std::string> KeysOf(std::string_view path, const Override& override) {
  std::vector<std::string> keys = SplitPath(path);
  if (std::ranges::find(keys, "") != keys.end()) override.Fail("has an empty key");
  if (keys.size() > kMostLevels) {
    override.Fail(fmt::format("has more than {} keys", kMostLevels));
  }
  return keys;
}

}  // namespace

std::string PutOver(YamlNode& root, const std::string& path, const YamlNode& value,
                    const std::string& place, YamlSource& source) {
  Override override(place, source);
  root = override.With(root, KeysOf(path, override), value);
  return override.path();
}

void ApplyOverride(YamlNode& root, const std::string& text, YamlSource& source) {
  Override override(OverridePlace(text), source);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) override.Fail("must be key.path=value");
  const std::vector<std::string> keys = KeysOf(std::string_view(text).substr(0, equals), override);
  RejectUnknownController(root, text, keys);
  const YamlNode value =
      ParseChecked(std::string_view(text).substr(equals + 1), YamlIncludes::kRefused,
                   [&override](TextPlace, const std::string& problem) { override.Fail(problem); });
  root = override.With(root, keys, value);
  const std::string path = override.path();
  std::erase_if(source.overrides,
                [&path](const auto& earlier) { return IsAtOrBelow(earlier.first, path); });
  source.overrides[path] = text;
}

}  // namespace gauntlet::sim
