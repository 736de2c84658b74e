#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/program.h"

/// A page in a real browser, for tests; chromium is too large a package to ask of everybody who
/// builds, so they skip where it is not.
namespace gauntlet::test {

/// Runs first in the page: whatever goes wrong is kept. (There is no video beside it.)
inline constexpr const char* kListen = R"(<script>
  window.problems = [];
  window.addEventListener("error", (e) => {
    if (e.target.tagName !== "VIDEO") problems.push(String(e.message));
  }, true);
  window.addEventListener("securitypolicyviolation", (e) => problems.push(e.violatedDirective));
  for (const kind of ["error", "warn"]) {
    console[kind] = (...words) => problems.push(words.join(" "));
  }
</script>)";

/// For scripts that save: `await saved(button)` is the text of the file that a button saves, and
/// `leave(seen)` gives what a script saw to UsePage().
inline constexpr const char* kSaved = R"(<script>
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  let files = [];
  // What is saved can be read at once: the browser's virtual time does not wait for a real blob.
  window.Blob = class { constructor(parts, {type}) { this.type = type; this.text = parts.join(""); } };
  HTMLCanvasElement.prototype.toBlob = function (take) {
    take(new Blob([this.toDataURL()], {type: "image/png"}));
  };
  URL.createObjectURL = (blob) => { files.push(blob); return "about:blank"; };
  HTMLAnchorElement.prototype.click = () => {};
  const saved = async (button) => {
    files = [];
    button.click();
    for (let i = 0; i < 50000 && files.length === 0; ++i) await wait(1);
    return files[0]?.text;
  };
  const leave = (seen) =>
    document.documentElement.setAttribute("data-seen", encodeURIComponent(JSON.stringify(seen)));
  window.addEventListener("unhandledrejection", (e) => leave({problems: [String(e.reason.stack)]}));
</script>)";

inline bool HasBrowser() { return RunProgram({"sh", "-c", "command -v chromium"}).exit_code == 0; }

inline std::string Decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    out += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
    i += 2;
  }
  return out;
}

/// How many pages the page has on paper (US letter, as the browser prints without a printer).
inline int PagesOnPaper(const std::string& page) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "report.html") << page;
  const std::string paper = (folder.path() / "paper.pdf").string();
  const ProgramResult result =
      RunProgram({"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                  "--disable-background-networking", "--disable-dev-shm-usage",
                  "--user-data-dir=" + (folder.path() / "profile").string(),
                  "--virtual-time-budget=10000", "--no-pdf-header-footer",
                  "--print-to-pdf=" + paper, "file://" + (folder.path() / "report.html").string()});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  std::ostringstream bytes;
  bytes << std::ifstream(paper, std::ios::binary).rdbuf();
  const std::string text = bytes.str();
  const std::string mark = "/Count ";  // of pages below a node of their tree; the root has the most
  int pages = 0;
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
    pages = std::max(pages, std::stoi(text.substr(at + mark.size(), 6)));
  }
  return pages;
}

/// What `script`, which runs last in the page, leaves as encoded JSON in the attribute data-seen.
inline nlohmann::json UsePage(const std::string& page, const std::string& script, int width_px) {
  const TemporaryDirectory folder;
  const std::size_t head = page.find("<title>");
  const std::size_t end = page.rfind("</body>");
  std::ofstream(folder.path() / "report.html")
      << page.substr(0, head) << kListen << page.substr(head, end - head) << script
      << page.substr(end);
  const ProgramResult result = RunProgram(
      {"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
       "--disable-background-networking", "--disable-dev-shm-usage", "--mute-audio",
       "--user-data-dir=" + (folder.path() / "profile").string(),
       "--window-size=" + std::to_string(width_px) + ",900", "--virtual-time-budget=1000000",
       "--force-prefers-reduced-motion",  // nothing plays by itself, in virtual time without end
       "--dump-dom", "file://" + (folder.path() / "report.html").string()});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  const std::string mark = "data-seen=\"";
  const std::size_t begin = result.standard_output.find(mark);
  if (begin == std::string::npos) {
    ADD_FAILURE() << "the page did not run:\n" << result.standard_error;
    return {};
  }
  const std::size_t from = begin + mark.size();
  return nlohmann::json::parse(
      Decoded(result.standard_output.substr(from, result.standard_output.find('"', from) - from)));
}

}  // namespace gauntlet::test
