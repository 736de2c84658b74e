#include "sim/settings/yaml_tree.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <functional>
#include <span>
#include <sstream>
#include <vector>

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

std::string PlaceInFile(const std::filesystem::path& file, const YAML::Mark& mark) {
  return fmt::format("{}:{}:{}", file.string(), mark.line + 1, mark.column + 1);
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

std::string YamlSource::PlaceOf(const YAML::Node& node, const std::string& path) const {
  if (const std::string* text = OverrideOf(path)) return OverridePlace(*text);
  const YAML::Mark mark = node.Mark();
  if (!mark.is_null()) return PlaceInFile(FileOf(path), mark);
  for (const auto& [key, text] : overrides) {  // made on the way to what an override sets
    if (!groups.contains(path) && IsAtOrBelow(key, path)) return OverridePlace(text);
  }
  const YAML::Mark* group = Nearest(groups, path);
  return group == nullptr ? FileOf(path).string() : PlaceInFile(FileOf(path), *group);
}

UserError YamlSource::At(const YAML::Node& node, const SettingError& error) const {
  return UserError({.place = PlaceOf(node, error.key()),
                    .key = OneLine(error.key(), kLongestPlace),
                    .problem = error.problem()});
}

std::string ReadYamlText(const std::filesystem::path& file) {
  const auto fail = [&file](const std::string& problem) {
    throw UserError({.place = file.empty() ? "''" : file.string(), .problem = problem});
  };
  const auto fail_at_reading = [&fail](int error) {
    if (error == EINTR) throw Cancelled();  // it waited for the other end of a pipe
    if (error == ENOENT) fail("no such file");
    if (error == EISDIR) fail("is a folder, must be a scenario file");
    fail(fmt::format("cannot be read: {}", std::strerror(error)));
  };
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_at_reading(errno);
  std::string text(kMostBytes + 1, '\0');
  std::size_t size = 0;
  ssize_t got = 1;
  while (got > 0 && size < text.size()) {
    got = read(descriptor, text.data() + size, text.size() - size);
    if (got > 0) size += static_cast<std::size_t>(got);
  }
  const int error = errno;
  close(descriptor);
  if (got < 0) fail_at_reading(error);
  if (size > kMostBytes) {
    fail(fmt::format("has more than {} MB, is no scenario file", kMostBytes / 1'000'000));
  }
  text.resize(size);
  return text;
}

namespace {

/// Throws at a place of the text, which is a file or the value of a --set.
using FailAt = std::function<void(const YAML::Mark&, const std::string& problem)>;

YAML::Mark MarkOf(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte);
  const std::size_t line_begin = before.rfind('\n') + 1;  // 0 if there is none
  YAML::Mark mark;
  mark.pos = static_cast<int>(byte);
  mark.line = static_cast<int>(std::ranges::count(before, '\n'));
  mark.column = static_cast<int>(byte - line_begin);
  return mark;
}

/// Errors: by `fail`, at the first byte that no text has.
void CheckBytes(std::string_view text, const FailAt& fail) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    fail(MarkOf(text, 0), "is UTF-16, must be saved as UTF-8");
  }
  if (const auto bad = FirstBadByte(text)) {
    fail(MarkOf(text, *bad),
         fmt::format("the byte {} is not UTF-8", OneLine(text.substr(*bad, 1))));
  }
  const auto control = std::ranges::find_if(text, [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t') ||
           c == '\x7f';
  });
  if (control != text.end()) {
    const std::size_t byte = control - text.begin();
    fail(MarkOf(text, byte),
         fmt::format("has the control character {}", OneLine(text.substr(byte, 1))));
  }
}

/// Sees a document go by without keeping it, and stops at what would be too deep, too large or
/// endless as a tree.
class BoundsCheck final : public YAML::EventHandler {
 public:
  BoundsCheck(const FailAt& fail, YamlIncludes includes) : fail_(fail), includes_(includes) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) fail_(mark, "a second document begins here, there must be one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { Leaf(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string&) override {
    if (tag != kIncludeTag || includes_ == YamlIncludes::kRefused) RefuseTag(mark, tag);
    Leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::ranges::find(open_, anchor, &Group::anchor) != open_.end()) {
      fail_(mark, "stands inside what it stands for");
    }
    Count(mark, values_of_[anchor]);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor);
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor);
  }
  void OnMapEnd() override { Close(); }

 private:
  struct Group {
    YAML::anchor_t anchor = YAML::NullAnchor;
    std::size_t values_before = 0;
  };

  void Count(const YAML::Mark& mark, std::size_t values) {
    values_ += values;
    if (values_ > kMostValues) fail_(mark, fmt::format("has more than {} values", kMostValues));
  }
  void Leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    Count(mark, 1);
    if (anchor != YAML::NullAnchor) values_of_[anchor] = 1;
  }
  void Open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    RefuseTag(mark, tag);
    if (open_.size() == kMostLevels) {
      fail_(mark, fmt::format("is nested deeper than {} levels", kMostLevels));
    }
    open_.push_back({anchor, values_});
    Count(mark, 1);
  }
  void Close() {
    const Group group = open_.back();
    open_.pop_back();
    if (group.anchor != YAML::NullAnchor) values_of_[group.anchor] = values_ - group.values_before;
  }
  /// Those of YAML itself say what is known anyhow.
  void RefuseTag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?" || tag == "!" || tag.starts_with("tag:yaml.org,2002:")) return;
    if (tag == kIncludeTag) fail_(mark, std::string(kMisplacedInclude));
    fail_(mark, fmt::format("has the tag {}, tags have no meaning here", Shown(tag)));
  }

  const FailAt& fail_;
  YamlIncludes includes_;
  int documents_ = 0;
  std::size_t values_ = 0;
  std::vector<Group> open_;
  std::map<YAML::anchor_t, std::size_t> values_of_;
};

YAML::Node ParseChecked(std::string_view text, YamlIncludes includes, const FailAt& fail) {
  CheckBytes(text, fail);
  const std::string copy(text);
  try {
    std::istringstream stream(copy);
    YAML::Parser parser(stream);
    BoundsCheck bounds(fail, includes);
    while (parser.HandleNextDocument(bounds)) {
    }
    return YAML::Load(copy);
  } catch (const YAML::Exception& problem) {
    fail(problem.mark, Shown(problem.msg));
    throw;
  }
}

}  // namespace

YAML::Node ParseYaml(const std::filesystem::path& file, std::string_view text,
                     YamlIncludes includes) {
  YAML::Node root =
      ParseChecked(text, includes, [&file](const YAML::Mark& mark, const std::string& problem) {
        throw UserError({.place = PlaceInFile(file, mark), .problem = problem});
      });
  if (!root.IsMap()) {
    throw UserError({.place = file.string() + ":1:1", .problem = "must be a map of keys"});
  }
  return root;
}

YAML::Node ParseYamlFile(const std::filesystem::path& file) {
  return ParseYaml(file, ReadYamlText(file));
}

YAML::Node ChildOf(const YAML::Node& group, std::string_view key) {
  if (group.IsMap()) {
    for (const auto& entry : group) {
      if (entry.first.Scalar() == key) return entry.second;
    }
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node NodeAt(const YAML::Node& root, std::string_view path) {
  YAML::Node node = root;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find_first_of(".[]"), path.size());
    const std::string_view key = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    if (key.empty()) continue;  // between ] and .
    YAML::Node next(YAML::NodeType::Undefined);
    std::size_t index = 0;
    if (node.IsSequence() &&
        std::from_chars(key.data(), key.data() + key.size(), index).ec == std::errc()) {
      if (index < node.size()) next.reset(node[index]);
    } else {
      next.reset(ChildOf(node, key));
    }
    if (!next.IsDefined()) break;
    node.reset(next);
  }
  return node;
}

namespace {

std::vector<std::string> SplitPath(std::string_view path) {
  std::vector<std::string> keys(1);
  for (const char c : path) {
    if (c == '.') {
      keys.emplace_back();
    } else {
      keys.back() += c;
    }
  }
  return keys;
}

/// An override may change a controller but not invent one: a misspelt name would only add a row.
void RejectUnknownController(const YAML::Node& root, const std::string& text,
                             const std::vector<std::string>& keys) {
  if (keys.size() < 2 || keys[0] != "controllers") return;
  const YAML::Node controllers = NodeAt(root, "controllers");
  if (!controllers.IsMap()) return;  // the reader says so
  std::vector<std::string> names;
  for (const auto& entry : controllers) names.push_back(entry.first.Scalar());
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
  YAML::Node With(const YAML::Node& node, std::span<const std::string> keys,
                  const YAML::Node& value) {
    if (keys.empty()) return value;
    if (!node.Mark().is_null()) source_.groups[path_] = node.Mark();
    return node.IsSequence() ? WithItem(node, keys, value) : WithKey(node, keys, value);
  }

  /// The path that With() went, as the reader has it.
  const std::string& path() const { return path_; }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw UserError({.place = place_, .problem = problem});
  }

 private:
  YAML::Node WithItem(const YAML::Node& list, std::span<const std::string> keys,
                      const YAML::Node& value) {
    const std::string& key = keys[0];
    std::size_t item = 0;
    if (key.find_first_not_of("0123456789") == std::string::npos) {
      const auto [rest, error] = std::from_chars(key.data(), key.data() + key.size(), item);
      if (error != std::errc() || item >= list.size()) FailAtItem(list, key);
      keys = keys.subspan(1);
    } else if (list.size() != 1) {
      FailAtItem(list, key);
    }
    path_ += fmt::format("[{}]", item);
    YAML::Node copy(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < list.size(); ++i) {
      copy.push_back(i == item ? With(list[i], keys, value) : list[i]);
    }
    return copy;
  }

  [[noreturn]] void FailAtItem(const YAML::Node& list, const std::string& key) const {
    if (list.size() == 0) Fail(fmt::format("{} is an empty list", Shown(path_)));
    Fail(fmt::format("{} is a list of {}: an item is named by its number, 0 to {}, not by {}",
                     Shown(path_), list.size(), list.size() - 1, Shown(key)));
  }

  YAML::Node WithKey(const YAML::Node& node, std::span<const std::string> keys,
                     const YAML::Node& value) {
    path_ += path_.empty() ? keys[0] : "." + keys[0];
    YAML::Node group(YAML::NodeType::Map);
    if (node.IsScalar()) group.force_insert("kind", node);
    if (node.IsMap()) group.reset(node);
    YAML::Node copy(YAML::NodeType::Map);
    bool found = false;
    for (const auto& entry : group) {
      const bool is_it = !found && entry.first.IsScalar() && entry.first.Scalar() == keys[0];
      copy.force_insert(entry.first,
                        is_it ? With(entry.second, keys.subspan(1), value) : entry.second);
      found = found || is_it;
    }
    if (!found) copy.force_insert(keys[0], With(YAML::Node(), keys.subspan(1), value));
    return copy;
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

std::string PutOver(YAML::Node& root, const std::string& path, const YAML::Node& value,
                    const std::string& place, YamlSource& source) {
  Override override(place, source);
  root.reset(override.With(root, KeysOf(path, override), value));
  return override.path();
}

void ApplyOverride(YAML::Node& root, const std::string& text, YamlSource& source) {
  Override override(OverridePlace(text), source);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) override.Fail("must be key.path=value");
  const std::vector<std::string> keys = KeysOf(std::string_view(text).substr(0, equals), override);
  RejectUnknownController(root, text, keys);
  const YAML::Node value = ParseChecked(
      std::string_view(text).substr(equals + 1), YamlIncludes::kRefused,
      [&override](const YAML::Mark&, const std::string& problem) { override.Fail(problem); });
  root.reset(override.With(root, keys, value));
  const std::string path = override.path();
  std::erase_if(source.overrides,
                [&path](const auto& earlier) { return IsAtOrBelow(earlier.first, path); });
  source.overrides[path] = text;
}

}  // namespace gauntlet::sim
