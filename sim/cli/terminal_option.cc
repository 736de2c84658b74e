#include "sim/cli/terminal_option.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

constexpr int kUsualWidth = 80;
constexpr int kNarrowest = 40;     // less is taken for a mistake of the terminal
constexpr int kLongestText = 100;  // longer lines are hard to read

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

int TerminalWidth() {
  constexpr int kWidest = 1'000'000;
  int width = controller::ParseWholeNumber(Environment("COLUMNS"), 1, kWidest).value_or(0);
  winsize size{};
  if (width <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  return width <= 0 ? kUsualWidth : std::max(width, kNarrowest);
}

}  // namespace

TerminalStyle StyleOf(const TerminalOptions& options) {
  const std::size_t width = TerminalWidth();
  const bool coloured_terminal = isatty(STDOUT_FILENO) != 0 && Environment("NO_COLOR").empty();
  return {.width = std::min<std::size_t>(width, kLongestText),
          .table_width = options.wide ? TerminalStyle::kNoLimit : width,
          .colour = options.colour == "always" || (options.colour == "auto" && coloured_terminal)};
}

}  // namespace gauntlet::sim
