#include "sim/settings/identified_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <variant>

#include "controller/prediction/horizon.h"

namespace gauntlet::sim {
namespace {

/// None if the chain does not contain the part's delay.
std::optional<double> HorizonOfPart(const IdentifiedChain& chain, const std::string& name) {
  const auto part = std::ranges::find(chain.parts, name, &IdentifiedPart::part);
  if (part == chain.parts.end()) return std::nullopt;
  return chain.horizon_ms[static_cast<std::size_t>(part - chain.parts.begin())];
}

double HorizonOfChannel(const IdentifiedChain& chain, const std::string& channel,
                        const controller::JointMapConfig& joint_map) {
  if (const std::optional<double> own = HorizonOfPart(chain, channel)) return *own;
  double sum = 0.0;
  int count = 0;
  for (const controller::JointSource& source : joint_map.joints) {
    if (std::ranges::find(source.channels, channel) == source.channels.end()) continue;
    const std::optional<double> of_joint = HorizonOfPart(chain, source.joint);
    if (!of_joint) continue;
    sum += *of_joint;
    ++count;
  }
  if (count == 0) throw controller::SettingError("chain", "has nothing for channel " + channel);
  return sum / count;
}

}  // namespace

void IdentifiedPart::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({"part", "joint or motor"}, part);
  visitor.Numbers({"delay_ms", "shift in time; value, low and high end of 95 %"}, delay_ms);
  visitor.Numbers({"dead_time_ms", "until anything happens"}, dead_time_ms);
  visitor.Numbers({"lag_ms", "delay of slow motions besides"}, lag_ms);
  visitor.Numbers({"natural_frequency_hz", "of the second-order lag"}, natural_frequency_hz);
  visitor.Numbers({"damping_ratio", "of the second-order lag"}, damping_ratio);
  visitor.Numbers({"gain", "angle per command"}, gain);
  visitor.Numbers({"offset_deg", "angle at command 0"}, offset_deg);
  visitor.Numbers({"speed_limit_deg_s", "largest speed; empty if none is seen"}, speed_limit_deg_s);
  visitor.Numbers({"hysteresis_deg", "width of the loop between up and down"}, hysteresis_deg);
  visitor.Numbers({"motor_hysteresis_deg", "its part in the motor's own way"},
                  motor_hysteresis_deg);
  visitor.Numbers({"lost_motion_deg", "its part behind the motor"}, lost_motion_deg);
  visitor.Number({"residual_rms_deg", "what the model leaves"}, residual_rms_deg);
  visitor.Number({"held_out_rms_deg", "the same in parts of the log that the fit did not contain"},
                 held_out_rms_deg);
  visitor.Text({"model", "what the fitted model contains"}, model);
  visitor.Text({"remarks", "what limits the values, what is withheld and why"}, remarks);
}

void IdentifiedChain::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({"log", "that it was made from"}, log);
  visitor.Numbers({"horizon_ms", "for prediction.horizon_ms: 0.8 of the delay", 0, 1000},
                  horizon_ms);
  visitor.Number({"expected_delay_ms", "for joint_loop.expected_delay_ms; 0: unknown"},
                 expected_delay_ms);
  visitor.Numbers({"friction_deg", "for joint_loop.friction_deg"}, friction_deg);
  visitor.Numbers({"dead_time_ms", "for model_predictive.dead_time_ms"}, dead_time_ms);
  visitor.Numbers({"lag_ms", "for model_predictive.lag_ms"}, lag_ms);
  visitor.Numbers({"natural_frequency_hz", "for model_predictive.natural_frequency_hz"},
                  natural_frequency_hz);
  controller::VisitList(visitor, {"parts", "joints or motors"}, parts);
}

void UseChain(const IdentifiedChain& chain, const std::vector<std::string>& channel_names,
              const controller::JointMapConfig& joint_map, controller::ControllerConfig& config) {
  if (chain.horizon_ms.empty()) {
    throw controller::SettingError(
        "chain", "has no horizon_ms: the delay of its hand is not known (see remarks)");
  }
  if (chain.horizon_ms.size() != chain.parts.size()) {
    throw controller::SettingError(
        "chain", fmt::format("horizon_ms has {} values, parts has {}", chain.horizon_ms.size(),
                             chain.parts.size()));
  }
  if (config.model_predictive.kind != controller::ModelPredictiveKind::kNone) {
    throw controller::SettingError(
        "chain",
        "gives horizon_ms for commands that are not planned; with model_predictive it must be "
        "given: 0, where dead_time_ms is all of the way");
  }
  std::vector<double>* const horizon_ms = std::visit(
      [](auto& settings) { return controller::HorizonOf(settings); }, config.prediction.settings);
  if (horizon_ms == nullptr) {
    throw controller::SettingError(
        "chain", fmt::format("gives horizon_ms, which a prediction of kind {} does not take",
                             config.prediction.kind()));
  }
  horizon_ms->clear();
  for (const std::string& channel : channel_names) {
    horizon_ms->push_back(HorizonOfChannel(chain, channel, joint_map));
  }
}

}  // namespace gauntlet::sim
