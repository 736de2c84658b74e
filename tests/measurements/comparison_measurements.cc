// Measures verdicts: how often a comparison is wrong whose truth is known. The table of
// docs/evidence/judgements.md.

#include <fmt/core.h>

#include <span>
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

void PrintHead() {
  fmt::print(
      "| replicates | values | coverage | false step | false equal | other scores | equal: found "
      "equal | slight: found equal | clear: found better or worse |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
}

void PrintRow(const ComparisonsShape& shape) {
  const ComparisonsOutcome outcome = SimulateComparisons(shape);
  const auto& [equal, slight, clear] = outcome.of_truth;
  const auto share_of = [](const ComparisonsOutcome::Verdicts& of, double part) {
    return of.right + of.equal + of.undecided + of.wrong == 0.0 ? "-" : Percent(part);
  };
  fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
             shape.motions == 1 ? fmt::format("{}", shape.noises)
                                : fmt::format("{} x {}", shape.motions, shape.noises),
             shape.scatter == Scatter::kNormal ? "normal" : "skewed", Percent(outcome.coverage),
             Percent(outcome.false_better_worse), Percent(outcome.false_equal),
             Percent(outcome.false_other), share_of(equal, equal.equal),
             share_of(slight, slight.equal), share_of(clear, clear.right));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  ComparisonsShape shape;
  if (argc > 1) shape.studies = std::stoi(argv[1]);
  constexpr Repetitions kNormal[] = {{1, 2}, {1, 4}, {1, 8}, {1, 32}, {2, 2}, {8, 2}, {16, 2}};
  constexpr Repetitions kSkewed[] = {{1, 8}, {1, 16}, {1, 32}, {8, 2}};
  struct Case {
    const char* title;
    Truth truth;
    double scatter_size;
  };
  // The last two are the hardest for "better" and "worse", and for "equal".
  constexpr Case kCases[] = {
      {"a third each equal, slightly (0.2 to 0.8 D) and clearly (1.5 to 4 D) different; scatter "
       "0.3 D",
       Truth::kMixed, 0.3},
      {"the same; scatter 1 D", Truth::kMixed, 1.0},
      {"the same; scatter 3 D", Truth::kMixed, 3.0},
      {"all equal; scatter 3 D", Truth::kEqual, 3.0},
      {"all equal, or different by D; scatter 0.3 D", Truth::kAtLimit, 0.3}};
  PrintHead();
  for (const auto& [title, truth, scatter_size] : kCases) {
    if (argc > 2 && std::string_view(title).find(argv[2]) == std::string_view::npos) continue;
    fmt::print("| **{}** | | | | | | | | |\n", title);
    shape.truth = truth;
    shape.scatter_size = scatter_size;
    for (const Scatter scatter : {Scatter::kNormal, Scatter::kSkewed}) {
      shape.scatter = scatter;
      for (const auto& [motions, noises] :
           scatter == Scatter::kNormal ? std::span<const Repetitions>(kNormal) : kSkewed) {
        shape.motions = motions;
        shape.noises = noises;
        PrintRow(shape);
      }
    }
  }
}
