#include "sim/show/figure/figure.h"

#include <fmt/format.h>

#include <array>

#include "sim/show/figure/palette.h"

namespace gauntlet::sim {
namespace {

/// Advance of the printable ASCII characters, from the space on. Units: 1/1000 of the size of
/// letters.
constexpr std::array kAdvances = {
    318,  401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,  //
    636,  636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531,  //
    1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,  //
    603,  787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500,  //
    500,  613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,  //
    635,  635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838};
constexpr int kOtherAdvance = 838;

bool ContinuesCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

/// Units: 1/1000 of the letters' size.
int AdvanceOf(char byte) {
  if (ContinuesCharacter(byte)) return 0;
  const auto place = static_cast<std::size_t>(static_cast<unsigned char>(byte)) - 32;
  return place < kAdvances.size() ? kAdvances[place] : kOtherAdvance;
}

}  // namespace

Ink InkOfPoint(std::size_t point, std::string css, std::string attributes) {
  return {.css = std::move(css),
          .attributes = fmt::format(" data-point=\"{}\"{}", point, attributes)};
}

Ink InkOfSeries(std::size_t series, std::string css, std::string said) {
  return {.css = std::move(css),
          .said = std::move(said),
          .attributes = fmt::format(" style=\"--series: {}\"", CssOfSeries(series))};
}

FigureBox Figure::Inside(const FigureLayout& layout) const {
  return {layout.left, layout.top, width_px - layout.right, height_px - layout.bottom};
}

void Figure::Text(FigurePoint at, Anchor anchor, const std::string& text, const Ink& ink) {
  FigureShape& shape = Add(kText, {at}, ink);
  shape.text = text;
  shape.anchor = anchor;
}

void Figure::UpwardText(FigurePoint at, const std::string& text, const Ink& ink) {
  Text(at, Anchor::kMiddle, text, ink);
  shapes.back().kind = kUpwardText;
}

double TextWidth(std::string_view text, double letters_px) {
  int advance = 0;
  for (const char byte : text) advance += AdvanceOf(byte);
  return 1e-3 * letters_px * advance;
}

std::string FittedText(const std::string& text, double width_px, double letters_px) {
  if (TextWidth(text, letters_px) <= width_px) return text;
  std::string shown = text;
  while (!shown.empty() && TextWidth(shown + "…", letters_px) > width_px) {
    while (ContinuesCharacter(shown.back())) shown.pop_back();
    shown.pop_back();
  }
  return shown + "…";
}

}  // namespace gauntlet::sim
