#pragma once

#include <optional>

#include "controller/settings.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// When commands leave and arrive: one frame per period, and it takes effect after the delay.
/// Source: Bai, Jiang, Yokoi, section 3: an event every 0.02 s, event time below 45 ms. The delay's
/// default lies in the middle of what that allows: an assumption.
struct EventConfig {
  double period_ms = 20.0;
  double delay_ms = 25.0;
  std::optional<double> jitter_ms = {};     // short for an exponential delay of `link.hand`
  std::optional<double> loss_percent = {};  // short for its independent loss

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Number({"period_ms", "time between two command frames", 1, 1000}, period_ms);
    visitor.Number(
        {"delay_ms",
         "time until a command frame reaches the servos, in whole steps of 1 ms or less", 0, 1000},
        delay_ms);
    const controller::Setting jitter = {
        "jitter_ms",
        "mean and standard deviation of an additional delay; short for link.hand.delay", 0, 1000};
    controller::VisitOptional(visitor, jitter, jitter_ms,
                              [&](double& value) { visitor.Number(jitter, value); });
    const controller::Setting loss = {
        "loss_percent", "command frames that are lost; short for link.hand.loss", 0, 100};
    controller::VisitOptional(visitor, loss, loss_percent,
                              [&](double& value) { visitor.Number(loss, value); });
  }
};

/// The links of a scenario: `links`, and to the hand what `event` is short for.
/// Errors: SettingError if both say something of the link to the hand.
LinksConfig LinksOf(const EventConfig& event, const LinksConfig& links);

}  // namespace gauntlet::sim
