#include "sim/hand/mjcf_element.h"

#include <expat.h>
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"

namespace gauntlet::sim {
namespace {

/// A comment of MJCF may hold "--", which XML forbids and the engine reads. Line ends stay.
void BlankComments(std::string& text) {
  for (std::size_t begin = text.find("<!--"); begin != std::string::npos;
       begin = text.find("<!--", begin)) {
    const std::size_t close = text.find("-->", begin + 4);
    const std::size_t end = close == std::string::npos ? text.size() : close + 3;
    for (; begin < end; ++begin) {
      if (text[begin] != '\n') text[begin] = ' ';
    }
  }
}

/// Line that the parser has reached. Newer releases of expat deprecate this function for one of 64
/// bits, which older ones lack.
int LineOf(XML_Parser parser) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  return static_cast<int>(XML_GetCurrentLineNumber(parser));
#pragma GCC diagnostic pop
}

/// Elements that the callbacks of the parser build. They must not throw.
struct Builder {
  XML_Parser parser;
  const std::filesystem::path& file;
  MjcfElement root = {};
  std::vector<MjcfElement*> open = {};
  bool has_doctype = false;

  static void Start(void* user, const XML_Char* name, const XML_Char** attributes) {
    auto& self = *static_cast<Builder*>(user);
    MjcfElement* element = &self.root;
    if (!self.open.empty()) element = &self.open.back()->children.emplace_back();
    element->name = name;
    element->file = self.file;
    element->line = LineOf(self.parser);
    for (; *attributes != nullptr; attributes += 2) {
      element->attributes.emplace_back(attributes[0], attributes[1]);
    }
    self.open.push_back(element);
  }
  static void End(void* user, const XML_Char*) { static_cast<Builder*>(user)->open.pop_back(); }
  static void Doctype(void* user, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    auto& self = *static_cast<Builder*>(user);
    self.has_doctype = true;
    XML_StopParser(self.parser, XML_FALSE);
  }
};

std::string Escaped(const std::string& value) {
  std::string text;
  for (const char letter : value) {
    switch (letter) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += letter;
    }
  }
  return text;
}

/// The element without its children. Returns whether it has some, and so needs an end.
bool AppendBegin(const MjcfElement& element, std::string& text) {
  text += '<' + element.name;
  for (const auto& [name, value] : element.attributes) {
    text += fmt::format(" {}=\"{}\"", name, Escaped(value));
  }
  text += element.children.empty() ? "/>" : ">";
  return !element.children.empty();
}

void Append(const MjcfElement& element, const std::filesystem::path& file, int& line,
            std::string& text) {
  for (; element.file == file && line < element.line; ++line) text += '\n';
  if (!AppendBegin(element, text)) return;
  for (const MjcfElement& child : element.children) Append(child, file, line, text);
  text += fmt::format("</{}>", element.name);
}

void AppendIndented(const MjcfElement& element, std::size_t depth, std::string& text) {
  const std::string indent(2 * depth, ' ');
  text += indent;
  const bool has_children = AppendBegin(element, text);
  text += '\n';
  if (!has_children) return;
  for (const MjcfElement& child : element.children) AppendIndented(child, depth + 1, text);
  text += fmt::format("{}</{}>\n", indent, element.name);
}

}  // namespace

const std::string* MjcfElement::Find(std::string_view attribute) const {
  const auto found =
      std::ranges::find(attributes, attribute, [](const auto& a) { return a.first; });
  return found == attributes.end() ? nullptr : &found->second;
}

void MjcfElement::Set(std::string_view attribute, const std::string& value) {
  Remove(attribute);
  attributes.emplace_back(attribute, value);
}

void MjcfElement::Remove(std::string_view attribute) {
  std::erase_if(attributes, [&](const auto& a) { return a.first == attribute; });
}

std::string MjcfElement::Place() const { return fmt::format("{}:{}", file.string(), line); }

MjcfElement ReadMjcf(const std::filesystem::path& file) {
  std::string text = LimitedText(InputFile(file), kMostModelBytes);
  BlankComments(text);
  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                       &XML_ParserFree);
  if (parser == nullptr) throw RunError("not enough memory for the hand's model");
  Builder builder{.parser = parser.get(), .file = file};
  XML_SetUserData(parser.get(), &builder);
  XML_SetElementHandler(parser.get(), &Builder::Start, &Builder::End);
  XML_SetStartDoctypeDeclHandler(parser.get(), &Builder::Doctype);
  if (XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) !=
      XML_STATUS_OK) {
    throw UserError(
        {.place = fmt::format("{}:{}", file.string(), LineOf(parser.get())),
         .problem =
             builder.has_doctype
                 ? std::string("DOCTYPE is not allowed in a model")
                 : fmt::format("is no XML: {}", XML_ErrorString(XML_GetErrorCode(parser.get())))});
  }
  return std::move(builder.root);
}

std::string MjcfText(const MjcfElement& root) {
  std::string text;
  int line = 1;
  Append(root, root.file, line, text);
  return text += '\n';
}

std::string IndentedMjcfText(const MjcfElement& root) {
  std::string text;
  AppendIndented(root, 0, text);
  return text;
}

}  // namespace gauntlet::sim
