#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// An element of an MJCF file, with its place.
struct MjcfElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<MjcfElement> children;
  std::filesystem::path file;
  int line = 0;

  /// The value of an attribute; null if it has none.
  const std::string* Find(std::string_view attribute) const;
  void Set(std::string_view attribute, const std::string& value);
  void Remove(std::string_view attribute);
  /// `hand.xml:12`.
  std::string Place() const;
};

/// The root element of an XML file. Comments are left out.
/// Errors: UserError with file and line for text that is no XML.
MjcfElement ReadMjcf(const std::filesystem::path& file);

/// Text of the element. Elements of its own file stand in their old lines, as far as elements of
/// other files leave them.
std::string MjcfText(const MjcfElement& root);

/// Text of the element for people: each element in a line of its own.
std::string IndentedMjcfText(const MjcfElement& root);

}  // namespace gauntlet::sim
