#include "sim/show/pages/plain_page.h"

#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"

namespace gauntlet::sim {

std::string PlainPage(const PlainPageParts& parts) {
  return FillTemplate(assets::kPlainHtml, {{"kind", EscapeHtml(parts.kind)},
                                           {"title", EscapeHtml(parts.title)},
                                           {"question", EscapeHtml(parts.question)},
                                           {"verdict", EscapeHtml(parts.verdict)},
                                           {"facts", EscapeHtml(parts.facts)},
                                           {"heading", EscapeHtml(parts.heading)},
                                           {"table", parts.table},
                                           {"sections", parts.sections},
                                           {"sources", ""},
                                           {"style", PaletteCss() + std::string(assets::kStyle) +
                                                         std::string(assets::kCellsStyle)}});
}

}  // namespace gauntlet::sim
