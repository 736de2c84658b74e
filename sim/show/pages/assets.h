#pragma once

#include <string_view>

/// Files of sim/show/pages/assets and of Debian's libjs-dygraphs and libjs-three, built into the
/// program by embed_assets.cmake so that a report needs nothing beside it.
namespace gauntlet::sim::assets {

// Pages with {{places}} to fill. All begin with head.html, which has `title`, `kind`, `style`, and
// `sources` of scripts and media as a content security policy names them.
extern const std::string_view kPageHtml;
extern const std::string_view kStyle;  // page.css, to stand behind PaletteCss()
inline constexpr const char* kScriptSources = "script-src 'unsafe-inline'; ";
extern const std::string_view kScript;       // all *.js of the folder, in the order of CMake's list
extern const std::string_view kCellsHtml;    // the page of a sweep, of tuning and of robust
extern const std::string_view kPlainHtml;    // a page without scripts
extern const std::string_view kCellsStyle;   // cells.css, to stand behind kStyle
extern const std::string_view kCellsScript;  // what it needs of *.js
extern const std::string_view kLiveHtml;     // the page of a running session
extern const std::string_view kLiveStyle;    // live.css, to stand behind kStyle
extern const std::string_view kLiveScript;   // what it needs of *.js
extern const std::string_view kPlotStyle;    // dygraph.min.css
extern const std::string_view kPlotLibrary;  // dygraph.min.js
extern const std::string_view kReplayLibrary;  // three.min.js and its OrbitControls.js

}  // namespace gauntlet::sim::assets
