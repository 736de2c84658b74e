#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

namespace gauntlet::sim {

/// One SVG for a page of cells, piece by piece. Classes are those of cells.css.
class Drawing {
 public:
  /// `said` is what it shows, for those who do not see it.
  Drawing(double width, double height, std::string_view kind, const std::string& said);

  template <class... Values>
  void Add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Values>(values)...);
  }
  /// `anchor` is start, middle or end.
  void Text(double x, double y, std::string_view anchor, const std::string& text,
            std::string_view style = "");
  void Line(double x1, double y1, double x2, double y2, std::string_view style);

  std::string Done() const { return fmt::to_string(out_) + "</svg>\n"; }

 private:
  fmt::memory_buffer out_;
};

/// Not longer than a label may be.
std::string Shortened(const std::string& text, std::size_t most);

}  // namespace gauntlet::sim
