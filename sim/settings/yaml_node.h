#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// Place in a text, counted from 0.
struct TextPlace {
  int line = -1;  // below 0: it stands in no text
  int column = -1;

  bool is_known() const { return line >= 0; }
};

/// A value of a YAML text with all that is below it.
///
/// It never changes: copies share what they hold, on any number of threads, and a tree that differs
/// from another in one value shares with it all that lies beside the way to that value.
class YamlNode {
 public:
  using Entry = std::pair<YamlNode, YamlNode>;  // key and value

  /// Undefined: what is not there.
  YamlNode() = default;
  static YamlNode Null(TextPlace place = {});
  static YamlNode Scalar(std::string text, std::string tag = {}, TextPlace place = {});
  static YamlNode Sequence(std::vector<YamlNode> items, TextPlace place = {});
  /// In the order of the text, which may give a key twice.
  static YamlNode Map(std::vector<Entry> entries, TextPlace place = {});

  bool IsDefined() const { return data_ != nullptr; }
  bool IsNull() const;
  bool IsScalar() const;
  bool IsSequence() const;
  bool IsMap() const;

  /// The text of a scalar; empty for all others.
  const std::string& text() const;
  const std::string& tag() const;
  TextPlace place() const;
  /// Those of a sequence; none for all others.
  const std::vector<YamlNode>& items() const;
  /// Those of a map; none for all others.
  const std::vector<Entry>& entries() const;

  /// True for the same part of the same tree, or of two that share it.
  bool Is(const YamlNode& other) const { return data_ == other.data_; }

 private:
  struct Data;
  explicit YamlNode(Data data);

  std::shared_ptr<const Data> data_;
};

/// The value of a key; undefined where the group is no map, or has no such key. It lives as long as
/// the group.
const YamlNode& ChildOf(const YamlNode& group, std::string_view key);

/// The part of the tree that a path of keys leads to, as far as the tree has it. It lives as long
/// as the tree.
const YamlNode& NodeAt(const YamlNode& root, std::string_view path);

/// The map with another value for a key that it has.
YamlNode WithChild(const YamlNode& map, std::string_view key, const YamlNode& value);

/// The map without a key; of one that is given twice, without the first.
YamlNode WithoutChild(const YamlNode& map, std::string_view key);

}  // namespace gauntlet::sim
