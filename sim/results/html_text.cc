#include "sim/results/html_text.h"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>

#include "sim/base/json.h"

namespace gauntlet::sim {
namespace {

/// With the places where a text may be broken.
std::string HtmlOfText(const std::string& text) {
  std::string out;
  for (const char c : EscapeHtml(text)) {
    out += c == kBreak ? "<br>" : c == kSoftBreak ? "<wbr>" : std::string(1, c);
  }
  return out;
}

std::string_view ClassOf(const ResultColumn& column, char mark) {
  if (mark == '*') return " class=\"good\"";
  if (mark == '!') return " class=\"warn\"";
  return column.is_words ? " class=\"words\"" : "";
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string JsonForScript(const Json& json) {
  const std::string text = json.dump(-1, Json::InvalidText::kReplaced);
  std::string out;
  out.reserve(text.size());
  // Outside of strings JSON has none of these three, so an escape is always in its place.
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else if (c == '>') {
      out += "\\u003e";
    } else if (c == '&') {
      out += "\\u0026";
    } else {
      out += c;
    }
  }
  return out;
}

std::string FillTemplate(std::string_view page,
                         const std::map<std::string, std::string, std::less<>>& values) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{");
    const std::size_t close = page.find("}}", open);
    if (open == std::string_view::npos || close == std::string_view::npos) break;
    out += page.substr(0, open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto value = values.find(name);
    if (value == values.end()) {
      throw std::logic_error("page template: no value for " + std::string(name));
    }
    out += value->second;
    page.remove_prefix(close + 2);
  }
  return out += page;
}

std::string HtmlOf(const ResultTable& table) {
  std::string head;
  std::size_t heads = 0;
  for (const ResultColumn& column : table.columns) {
    if (column.heading.empty()) continue;
    const char* side = heads++ < table.names || column.is_words ? " class=\"words\"" : "";
    const std::string unit =
        column.unit.empty() ? "" : fmt::format(" <small>{}</small>", EscapeHtml(column.unit));
    head += fmt::format("<th scope=\"col\"{}>{}{}</th>", side, HtmlOfText(column.heading), unit);
  }
  std::string rows;
  for (const ResultRow& row : table.rows) {
    std::size_t names = 0;
    rows += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (table.columns[c].heading.empty()) continue;
      const std::string mark = row[c].mark == ' ' || table.columns[c].is_words
                                   ? ""
                                   : EscapeHtml(std::string(1, row[c].mark));
      const std::string text = HtmlOfText(row[c].text) + mark;
      rows += names < table.names
                  ? fmt::format("<th scope=\"row\">{}</th>", text)
                  : fmt::format("<td{}>{}</td>", ClassOf(table.columns[c], row[c].mark), text);
      ++names;
    }
    rows += "</tr>\n";
  }
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"Table\"><table "
      "class=\"result\">\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      head, rows);
}

namespace {

/// Lines of a text in one paragraph, but for warnings, which stand out by themselves.
void AddParagraphs(const std::string& text, std::string& out) {
  std::string lines;
  const auto end_paragraph = [&](const char* kind) {
    if (!lines.empty()) out += fmt::format("<p class=\"{}\">{}</p>\n", kind, HtmlOfText(lines));
    lines.clear();
  };
  std::istringstream all(text);
  for (std::string line; std::getline(all, line, kBreak);) {
    const bool warns = line.starts_with("Warning: ");
    if (warns) end_paragraph("note");
    lines += (lines.empty() ? "" : std::string(1, kBreak)) + line;
    if (warns) end_paragraph("note warn");
  }
  end_paragraph("note");
}

}  // namespace

std::string HtmlOf(const ResultText& result) {
  std::string out;
  for (const auto& part : result) {
    if (const auto* table = std::get_if<ResultTable>(&part)) {
      if (!table->rows.empty()) out += HtmlOf(*table);
    } else if (const auto* lines = std::get_if<CommandLines>(&part)) {
      out += fmt::format("<pre tabindex=\"0\">{}</pre>\n", EscapeHtml(lines->text));
    } else if (const auto& text = std::get<std::string>(part); !text.empty()) {
      AddParagraphs(text, out);
    }
  }
  return out;
}

}  // namespace gauntlet::sim
