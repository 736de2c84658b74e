#pragma once

#include <map>
#include <string>
#include <string_view>

#include "sim/results/table_text.h"

namespace gauntlet::sim {

class Json;

/// Text as it stands between tags or in a quoted attribute of HTML: & < > " ' are escaped.
std::string EscapeHtml(std::string_view text);

/// JSON that may stand inside <script>: no `<`, `>` or `&` is left, so nothing in it can end the
/// element or open a comment. Bytes that are not UTF-8 become the replacement character.
std::string JsonForScript(const Json& json);

/// `page` with every `{{name}}` replaced by its value, in one pass: what a value holds is never
/// looked at again. Errors: std::logic_error for a name without a value.
std::string FillTemplate(std::string_view page,
                         const std::map<std::string, std::string, std::less<>>& values);

/// A table that scrolls by itself where the page is too narrow; the columns with a heading.
std::string HtmlOf(const ResultTable& table);
/// Paragraphs, tables and commands, one behind the other.
std::string HtmlOf(const ResultText& result);

}  // namespace gauntlet::sim
