#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "controller/filters/steady_gains.h"
#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {
namespace {

/// Words in which C and JavaScript differ where both have the same statements.
struct Language {
  std::string state;      // before a member of the state
  std::string constant;   // declares a number
  std::string variable;   // likewise, one that changes
  std::string counter;    // likewise, of a loop
  std::string magnitude;  // function
};
const Language kC = {"s->", "const double", "double", "int", "fabs"};
const Language kJavaScript = {"s.", "const", "let", "let", "Math.abs"};
const Language kPython = {"s.", "", "", "", "abs"};  // of statements without lists and loops

/// A filter in statements that take the sample x, as those of Gauntlet do, and return the filtered
/// value.
struct Code {
  std::vector<std::string> numbers = {};   // members of the state beside `started` and `held`
  std::vector<std::string> starting = {};  // those that are the first sample at the start
  int window = 0;                          // last samples that it keeps
  std::string early = {};                  // before `held` is the new sample
  std::string statements = {};
};

Code CodeOf(const controller::OneEuroConfig& config, const PlainFilter& filter,
            const Language& language) {
  constexpr std::string_view kTurn = "6.283185307179586";
  const bool raw = config.speed_from == controller::OneEuroConfig::SpeedFrom::kRaw;
  const std::string rate = LineNumber(filter.rate_hz);
  Code code{.numbers = {"y", "speed"}, .starting = {"y"}};
  if (raw)
    code.early = fmt::format("{0} change = x - {1}held;\n", language.constant, language.state);
  code.statements = fmt::format(
      R"({number} step = x - {s}y;
{s}speed += ({change} * {rate} - {s}speed) / (1 + {rate} / ({turn} * {derivative}));
{number} cutoff = {least} + {beta} * {abs}({s}speed);
{s}y += step * cutoff / (cutoff + {rate} / {turn});
return {s}y;
)",
      fmt::arg("number", language.constant), fmt::arg("s", language.state),
      fmt::arg("change", raw ? "change" : "step"), fmt::arg("rate", rate), fmt::arg("turn", kTurn),
      fmt::arg("derivative", LineNumber(config.derivative_cutoff_hz)),
      fmt::arg("least", LineNumber(config.min_cutoff_hz)),
      fmt::arg("beta", LineNumber(config.beta)), fmt::arg("abs", language.magnitude));
  return code;
}

Code CodeOf(const controller::ButterworthConfig& config, const PlainFilter& filter,
            const Language& language) {
  const controller::ButterworthFactors factors = controller::FactorsOf(config, filter.rate_hz);
  const char* const second_order = config.order > 1 ? ", v" : "";
  Code code{.statements = fmt::format("{} u = x, e{}, y;\n", language.variable, second_order)};
  if (config.order % 2 == 1) {
    code.numbers = code.starting = {"low"};
    code.statements += fmt::format(R"(e = u - {0}low, y = {0}low + {1} * e;
{0}low = 2 * y - {0}low, u = y;
)",
                                   language.state, LineNumber(factors.first_order_gain));
  }
  for (std::size_t i = 0; i < factors.sections.size(); ++i) {
    const auto& section = factors.sections[i];
    const std::string band = fmt::format("band{}", i + 1);
    const std::string low = fmt::format("low{}", i + 1);
    code.numbers.push_back(band);
    code.numbers.push_back(low);
    code.starting.push_back(low);
    code.statements += fmt::format(
        R"(e = u - {s}{low}, v = {a1} * {s}{band} + {a2} * e, y = {s}{low} + {a2} * {s}{band} + {a3} * e;
{s}{band} = 2 * v - {s}{band}, {s}{low} = 2 * y - {s}{low}, u = y;
)",
        fmt::arg("s", language.state), fmt::arg("low", low), fmt::arg("band", band),
        fmt::arg("a1", LineNumber(section.a1)), fmt::arg("a2", LineNumber(section.a2)),
        fmt::arg("a3", LineNumber(section.a3)));
  }
  if (config.start == controller::Start::kZero) code.starting.clear();
  code.statements += "return u;\n";
  return code;
}

Code CodeOf(const controller::MovingAverageConfig& config, const PlainFilter& /*filter*/,
            const Language& language) {
  return {.numbers = {"count", "next"},
          .window = config.window,
          .statements = fmt::format(
              R"({s}last[{index}{s}next] = x;
{s}next = {s}next + 1 < {window} ? {s}next + 1 : 0;
if ({s}count < {window}) {s}count += 1;
{variable} sum = 0;
for ({counter} i = 0; i < {s}count; i++) sum += {s}last[i];
return sum / {s}count;
)",
              fmt::arg("s", language.state), fmt::arg("index", &language == &kC ? "(int)" : ""),
              fmt::arg("window", config.window), fmt::arg("variable", language.variable),
              fmt::arg("counter", language.counter))};
}

/// Those with constant gains, as ConstantGains() describes them.
Code CodeOf(const auto& config, const PlainFilter& filter, const Language& language) {
  const auto gains = controller::ConstantGains(config, 1, filter.rate_hz);
  if (!gains) return {};
  const auto gain = [&](int i) { return LineNumber((*gains)(0, i)); };
  const bool has_speed = (*gains)(0, 1) != 0.0;
  const bool has_acceleration = (*gains)(0, 2) != 0.0;
  Code code{.numbers = {"y"}, .starting = {"y"}};
  const std::string& s = language.state;
  if (has_speed) code.numbers.emplace_back("v");
  if (has_acceleration) {
    code.numbers.emplace_back("a");
    code.statements += fmt::format("{0}y += {0}v + {0}a / 2;\n{0}v += {0}a;\n", s);
  } else if (has_speed) {
    code.statements += fmt::format("{0}y += {0}v;\n", s);
  }
  code.statements += fmt::format("{} e = x - {}y;\n", language.constant, s);
  code.statements += fmt::format("{}y += {} * e;\n", s, gain(0));
  if (has_speed) code.statements += fmt::format("{}v += {} * e;\n", s, gain(1));
  if (has_acceleration) code.statements += fmt::format("{}a += {} * e;\n", s, gain(2));
  code.statements += fmt::format("return {}y;\n", s);
  return code;
}
Code CodeOf(const PlainFilter& filter, const Language& language) {
  return std::visit([&](const auto& config) { return CodeOf(config, filter, language); },
                    filter.settings);
}

/// The statements as those of Python: no semicolons, nor words before a new name.
std::string AsPython(const std::string& statements) {
  std::string text;
  std::istringstream lines(statements);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with(';')) line.pop_back();
    text += line.substr(line.find_first_not_of(' ')) + "\n";
  }
  return text;
}

std::string Indented(const std::string& lines, int depth) {
  std::string text;
  bool at_begin = true;
  for (const char c : lines) {
    if (at_begin) text.append(static_cast<std::size_t>(depth), ' ');
    text += c;
    at_begin = c == '\n';
  }
  return text;
}

std::string Joined(const std::vector<std::string>& parts, std::string_view before,
                   std::string_view behind) {
  std::string text;
  for (const std::string& part : parts) text += fmt::format("{}{}{}", before, part, behind);
  return text;
}

std::string CLines(const PlainFilter& filter) {
  const Code code = CodeOf(filter, kC);
  if (code.statements.empty()) return "";
  std::string members = "held" + Joined(code.numbers, ", ", "");
  if (code.window > 0) members += fmt::format(", last[{}]", code.window);
  return fmt::format(
      R"(#include <math.h>

typedef struct {{ int started; double {}; }} Smoother;  /* one for each channel, = {{0}} at first */

/* Once for each sample; NaN is a missing one. */
double smooth(Smoother *s, double x) {{
  if (isnan(x)) {{ if (!s->started) return x; x = s->held; }}
  if (!s->started) {{ s->started = 1; {}s->held = x; }}
{}  s->held = x;
{}}}
)",
      members, Joined(code.starting, "s->", " = x; "), Indented(code.early, 2),
      Indented(code.statements, 2));
}

std::string JavaScriptLines(const PlainFilter& filter) {
  const Code code = CodeOf(filter, kJavaScript);
  if (code.statements.empty()) return "";
  std::string members = "started: false, held: NaN" + Joined(code.numbers, ", ", ": 0");
  if (code.window > 0) members += ", last: []";
  return fmt::format(
      R"(// Makes the filter of one channel: a function of the sample; NaN is a missing one.
function makeSmoother() {{
  const s = {{ {} }};
  return (x) => {{
    if (Number.isNaN(x)) {{ if (!s.started) return x; x = s.held; }}
    if (!s.started) {{ s.started = true; {}s.held = x; }}
{}    s.held = x;
{}  }};
}}
)",
      members, Joined(code.starting, "s.", " = x; "), Indented(code.early, 4),
      Indented(code.statements, 4));
}

std::string LeRobotLines(const PlainFilter& filter) {
  const Code code = CodeOf(filter, kPython);
  if (code.statements.empty()) return "";
  std::string members = "held=x";
  for (const std::string& number : code.numbers) {
    const bool starts = std::ranges::count(code.starting, number) > 0;
    members += fmt::format(", {}={}", number, starts ? "x" : "0.0");
  }
  return fmt::format(
      R"(import math
from dataclasses import dataclass, field
from types import SimpleNamespace

from lerobot.processor import ProcessorStepRegistry, RobotActionProcessorStep

@ProcessorStepRegistry.register("smooth_action")
@dataclass
class SmoothAction(RobotActionProcessorStep):
    """Once for each frame, at the rate above. keys: of the action, as "index.pos"; none: all."""

    keys: list[str] = field(default_factory=list)
    states: dict = field(default_factory=dict, init=False, repr=False)

    def action(self, action):
        return {{**action, **{{key: self.smooth(key, float(action[key])) for key in self.keys or action}}}}

    def smooth(self, key, x):
        s = self.states.get(key)
        if math.isnan(x):
            if s is None:
                return x
            x = s.held
        if s is None:
            s = self.states[key] = SimpleNamespace({})
{}        s.held = x
{}
    def reset(self):
        self.states.clear()

    def get_config(self):
        return {{"keys": self.keys}}

    def transform_features(self, features):
        return features
)",
      members, Indented(AsPython(code.early), 8), Indented(AsPython(code.statements), 8));
}

const std::vector<std::string_view> kKinds = {
    controller::ExponentialConfig::kKind,  controller::OneEuroConfig::kKind,
    controller::ButterworthConfig::kKind,  controller::MovingAverageConfig::kKind,
    controller::AlphaBetaConfig::kKind,    controller::AlphaBetaGammaConfig::kKind,
    controller::KalmanSteadyConfig::kKind, controller::NoFilterConfig::kKind};

}  // namespace

Library PlainC() {
  return {.name = "c",
          .package = "C99, no library",
          .comment = "//",
          .kinds = kKinds,
          .differences = {"On an AVR (Arduino Uno) double is a float of 24 bits.",
                          "Call it at the rate above, also where a sample is missing."},
          .lines = CLines,
          .like = nullptr};
}

Library LeRobot() {
  return {.name = "lerobot",
          .package = "lerobot 0.4.4 (PyPI)",
          .comment = "#",
          .kinds = {controller::ExponentialConfig::kKind, controller::OneEuroConfig::kKind,
                    controller::AlphaBetaConfig::kKind, controller::AlphaBetaGammaConfig::kKind,
                    controller::KalmanSteadyConfig::kKind},
          .differences = {"A step of a RobotProcessorPipeline of actions. Its unit is that of the "
                          "robot's actions (degrees, or -100 to 100).",
                          "It has no rate: a loop of another fps needs other settings.",
                          "reset() of the pipeline lets it begin anew: call it for each episode."},
          .lines = LeRobotLines,
          .like = nullptr};
}

Library PlainJavaScript() {
  return {.name = "javascript",
          .package = "JavaScript, no library",
          .comment = "//",
          .kinds = kKinds,
          .differences = {"Call it at the rate above, also where a sample is missing: "
                          "requestAnimationFrame has the rate of the screen."},
          .lines = JavaScriptLines,
          .like = nullptr};
}

}  // namespace gauntlet::sim
