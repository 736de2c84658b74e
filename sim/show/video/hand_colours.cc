#include "sim/show/video/hand_colours.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/quantile.h"
#include "sim/score/motors.h"
#include "sim/show/video/palette.h"

namespace gauntlet::sim {
namespace {

constexpr double kUsualShare = 0.98;  // of all errors: the others have the full colour, too
constexpr int kMostLookedAt = 2000;   // samples of each joint
constexpr double kFullErrors_deg[] = {1, 2, 5, 10, 15, 20, 30, 45, 60, 90};

int BodyOf(const HandModel& hand, int joint) {
  return hand.model().jnt_bodyid[hand.joints()[joint].joint];
}

/// So that the shape of a link is still seen.
Color Pale(const Color& color) {
  constexpr double kWhite = 0.2;
  const auto part = [](double value) { return std::lerp(value, 1.0, kWhite); };
  return {part(color.red), part(color.green), part(color.blue)};
}

double LargestTension_n(const VideoInput& input) {
  double largest_n = 0.0;
  for (const VideoPane& pane : input.panes) {
    if (pane.tension_n == nullptr || pane.tension_n->size() == 0) continue;
    largest_n = std::max(largest_n, pane.tension_n->maxCoeff());
    TrimSignals();
  }
  return largest_n;
}

double Error_rad(const VideoInput& input, const VideoPane& pane, int sample, int joint) {
  return std::abs((*pane.hand_angle_rad)(sample, joint) - (*input.true_angle_rad)(sample, joint));
}

double FullError_deg(const VideoInput& input) {
  std::vector<double> errors_rad;
  for (const VideoPane& pane : input.panes) {
    const int samples = static_cast<int>(pane.hand_angle_rad->rows());
    const int step = 1 + samples / kMostLookedAt;
    for (const int joint : MeasuredJointsOf(input)) {
      for (int sample = 0; sample < samples; sample += step) {
        const double error_rad = Error_rad(input, pane, sample, joint);
        if (std::isfinite(error_rad)) errors_rad.push_back(error_rad);
      }
      TrimSignals();
    }
  }
  if (errors_rad.empty()) return kFullErrors_deg[0];
  const double usual_deg = kDegPerRad * Quantile(std::move(errors_rad), kUsualShare);
  const auto* full_deg = std::ranges::lower_bound(kFullErrors_deg, usual_deg);
  return full_deg == std::end(kFullErrors_deg) ? *std::rbegin(kFullErrors_deg) : *full_deg;
}

}  // namespace

Color ColourOfPane(const VideoInput& input, int pane) {
  return ColourOfSeries(input.panes[pane].series);
}

ColourScale ColourScaleOf(const VideoInput& input) {
  return {.largest_tension_n = LargestTension_n(input), .full_error_deg = FullError_deg(input)};
}

HandColours::HandColours(const VideoInput& input, const HandModel& hand, const ColourScale& scale)
    : input_(input),
      hand_(hand),
      scale_(scale),
      measured_joints_(MeasuredJointsOf(input)),
      has_measured_joint_(static_cast<std::size_t>(hand.model().nbody), false) {
  for (const std::string& cable : hand.cable_names()) {
    tendon_of_cable_.push_back(mj_name2id(&hand.model(), mjOBJ_TENDON, cable.c_str()));
  }
  for (const int joint : measured_joints_) has_measured_joint_[BodyOf(hand, joint)] = true;
}

SceneColours HandColours::Of(int pane, int sample) {
  ShareOfPull(input_.panes[pane], sample);
  ShareOfError(input_.panes[pane], sample);
  // Hands over each other are told apart by their colours.
  return {.cable_share = cable_share_,
          .link_share = link_share_,
          .link = input_.overlay ? Pale(ColourOfPane(input_, pane)) : palette::kJointError};
}

void HandColours::ShareOfPull(const VideoPane& pane, int sample) {
  cable_share_.clear();
  if (pane.tension_n == nullptr || !(scale_.largest_tension_n > 0.0)) return;
  cable_share_.assign(hand_.model().ntendon, 0.0f);
  for (std::size_t cable = 0; cable < tendon_of_cable_.size(); ++cable) {
    const double tension_n = (*pane.tension_n)(sample, static_cast<Eigen::Index>(cable));
    // Slack by the rule of slack_share.
    if (tendon_of_cable_[cable] < 0 || !(tension_n > kSlackTension_n)) continue;
    cable_share_[tendon_of_cable_[cable]] =
        static_cast<float>(tension_n / scale_.largest_tension_n);
  }
}

bool HandColours::Counts(std::size_t measured, int sample) const {
  if (input_.counted.empty()) return true;
  return std::ranges::any_of(input_.counted[measured], [sample](const TickRange& range) {
    return range.begin <= sample && sample < range.end;
  });
}

void HandColours::ShareOfError(const VideoPane& pane, int sample) {
  const mjModel& model = hand_.model();
  link_share_.assign(model.nbody, 0.0f);
  for (std::size_t i = 0; i < measured_joints_.size(); ++i) {
    const int joint = measured_joints_[i];
    const double error_deg = kDegPerRad * Error_rad(input_, pane, sample, joint);
    if (!(error_deg > 0.0) || !Counts(i, sample)) continue;
    float& share = link_share_[BodyOf(hand_, joint)];
    share = std::max(share, static_cast<float>(std::min(1.0, error_deg / scale_.full_error_deg)));
  }
  for (int body = 1; body < model.nbody; ++body) {  // parents come first
    if (!has_measured_joint_[body]) link_share_[body] = link_share_[model.body_parentid[body]];
  }
}

}  // namespace gauntlet::sim
