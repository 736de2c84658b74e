#include "sim/settings/yaml_node.h"

#include <algorithm>

#include "controller/assert.h"
#include "controller/number.h"

namespace gauntlet::sim {
namespace {

enum class Kind { kNull, kScalar, kSequence, kMap };

auto FindKey(const std::vector<YamlNode::Entry>& entries, std::string_view key) {
  return std::ranges::find_if(entries,
                              [key](const auto& entry) { return entry.first.text() == key; });
}

}  // namespace

struct YamlNode::Data {
  Kind kind = Kind::kNull;
  TextPlace place = {};
  std::string text = {};
  std::string tag = {};
  std::vector<YamlNode> items = {};
  std::vector<Entry> entries = {};

  static const Data kNothing;
};

const YamlNode::Data YamlNode::Data::kNothing;

YamlNode::YamlNode(Data data) : data_(std::make_shared<const Data>(std::move(data))) {}

YamlNode YamlNode::Null(TextPlace place) {
  return YamlNode(Data{.kind = Kind::kNull, .place = place});
}

YamlNode YamlNode::Scalar(std::string text, std::string tag, TextPlace place) {
  return YamlNode(
      Data{.kind = Kind::kScalar, .place = place, .text = std::move(text), .tag = std::move(tag)});
}

YamlNode YamlNode::Sequence(std::vector<YamlNode> items, TextPlace place) {
  return YamlNode(Data{.kind = Kind::kSequence, .place = place, .items = std::move(items)});
}

YamlNode YamlNode::Map(std::vector<Entry> entries, TextPlace place) {
  return YamlNode(Data{.kind = Kind::kMap, .place = place, .entries = std::move(entries)});
}

bool YamlNode::IsNull() const { return IsDefined() && data_->kind == Kind::kNull; }
bool YamlNode::IsScalar() const { return IsDefined() && data_->kind == Kind::kScalar; }
bool YamlNode::IsSequence() const { return IsDefined() && data_->kind == Kind::kSequence; }
bool YamlNode::IsMap() const { return IsDefined() && data_->kind == Kind::kMap; }

const std::string& YamlNode::text() const {
  return IsDefined() ? data_->text : Data::kNothing.text;
}
const std::string& YamlNode::tag() const { return IsDefined() ? data_->tag : Data::kNothing.tag; }
TextPlace YamlNode::place() const { return IsDefined() ? data_->place : TextPlace{}; }
const std::vector<YamlNode>& YamlNode::items() const {
  return IsDefined() ? data_->items : Data::kNothing.items;
}
const std::vector<YamlNode::Entry>& YamlNode::entries() const {
  return IsDefined() ? data_->entries : Data::kNothing.entries;
}

const YamlNode& ChildOf(const YamlNode& group, std::string_view key) {
  static const YamlNode kUndefined;
  const auto found = FindKey(group.entries(), key);
  return found == group.entries().end() ? kUndefined : found->second;
}

const YamlNode& NodeAt(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find_first_of(".[]"), path.size());
    const std::string_view key = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    if (key.empty()) continue;  // between ] and .
    const YamlNode* next = &ChildOf(*node, key);
    const auto index = controller::ParseWholeNumber(key, 0, std::ssize(node->items()) - 1);
    if (index) next = &node->items()[*index];
    if (!next->IsDefined()) break;
    node = next;
  }
  return *node;
}

YamlNode WithChild(const YamlNode& map, std::string_view key, const YamlNode& value) {
  std::vector<YamlNode::Entry> entries = map.entries();
  const auto found = static_cast<std::size_t>(FindKey(entries, key) - entries.begin());
  GAUNTLET_ASSERT(found < entries.size());
  entries[found].second = value;
  return YamlNode::Map(std::move(entries), map.place());
}

YamlNode WithoutChild(const YamlNode& map, std::string_view key) {
  std::vector<YamlNode::Entry> entries = map.entries();
  if (const auto found = FindKey(entries, key); found != entries.end()) entries.erase(found);
  return YamlNode::Map(std::move(entries), map.place());
}

}  // namespace gauntlet::sim
