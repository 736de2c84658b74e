#include "sim/show/pages/plain_page.h"

#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"

namespace gauntlet::sim {

std::string PlainPage(const PlainPageParts& parts) {
  return FillTemplate(assets::kPlainHtml, {{"kind", EscapeHtml(parts.head.kind)},
                                           {"title", EscapeHtml(parts.head.title)},
                                           {"head", HtmlOf(parts.head)},
                                           {"heading", EscapeHtml(parts.heading)},
                                           {"table", parts.table},
                                           {"sections", parts.sections},
                                           {"sources", ""},
                                           {"style", PaletteCss() + std::string(assets::kStyle) +
                                                         std::string(assets::kCellsStyle)}});
}

}  // namespace gauntlet::sim
