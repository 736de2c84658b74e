// Measures verdicts: how often a comparison is wrong whose truth is known. The table of
// docs/evidence/judgements.md.

#include <fmt/core.h>

#include <string>
#include <string_view>

#include "tests/comparison/simulated_comparisons.h"

namespace {

using namespace gauntlet::sim;

struct Repetitions {
  int motions;
  int noises;
};

std::string Percent(double share) { return fmt::format("{:.1f}", 100.0 * share); }

void PrintHead(const char* title) {
  fmt::print("\n{}\n", title);
  fmt::print(
      "| repetitions | scatter | over D | coverage | false step | false equal | either | "
      "equal: equal | slight: equal / step | clear: step |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|\n");
}

void PrintRow(const ComparisonsShape& shape) {
  const ComparisonsOutcome outcome = SimulateComparisons(shape);
  const auto& [equal, slight, clear] = outcome.of_truth;
  fmt::print("| {} | {} | {:g} | {} | {} | {} | {} | {} | {} / {} | {} |\n",
             shape.motions == 1 ? fmt::format("{}", shape.noises)
                                : fmt::format("{} x {}", shape.motions, shape.noises),
             shape.scatter == Scatter::kNormal ? "normal" : "skewed", shape.scatter_size,
             Percent(outcome.coverage), Percent(outcome.false_better_worse),
             Percent(outcome.false_equal), Percent(outcome.false_verdict), Percent(equal.equal),
             Percent(slight.equal), Percent(slight.right), Percent(clear.right));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  ComparisonsShape shape;
  if (argc > 1) shape.studies = std::stoi(argv[1]);
  constexpr Repetitions kRepetitions[] = {{1, 2},  {1, 3}, {1, 4}, {1, 8}, {1, 16},
                                          {1, 32}, {2, 2}, {4, 2}, {8, 2}, {16, 2}};
  struct Case {
    const char* title;
    Truth truth;
    double scatter_size;
  };
  // The last two are the hardest for "better" and "worse", and for "equal".
  constexpr Case kCases[] = {
      {"Equal, slightly and clearly different, a third each", Truth::kMixed, 0.3},
      {"The same with more scatter", Truth::kMixed, 1.0},
      {"The same with most scatter", Truth::kMixed, 3.0},
      {"All equal", Truth::kEqual, 3.0},
      {"All equal, or different by what just matters", Truth::kAtLimit, 0.3}};
  for (const auto& [title, truth, scatter_size] : kCases) {
    if (argc > 2 && std::string_view(title).find(argv[2]) == std::string_view::npos) continue;
    PrintHead(title);
    shape.truth = truth;
    shape.scatter_size = scatter_size;
    for (const Scatter scatter : {Scatter::kNormal, Scatter::kSkewed}) {
      shape.scatter = scatter;
      for (const auto& [motions, noises] : kRepetitions) {
        shape.motions = motions;
        shape.noises = noises;
        PrintRow(shape);
      }
    }
  }
}
