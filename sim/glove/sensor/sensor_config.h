#pragma once

#include "controller/settings.h"

namespace gauntlet::sim {

/// Bend sensors: how an angle becomes a voltage, here a share of the converter's full scale.
///
///     bend   = (angle - min) / (max - min)                      0 .. 1 over the joint's range
///     bend'  = bend, late by the lag, held back by the hysteresis, with its neighbours' cross-talk
///     output = low + (high - low) (0.5 + gain (bend' - 0.5) + curvature 4 bend' (1 - bend'))
///              + offset + drift (1 - exp(-t / drift time))
///     low, high = 10 and 90 % of the full scale
///
/// The nominal sensor is straight and has neither; a seed draws one glove from it, per channel or
/// pair: gain, offset, curvature and drift are normal about the nominal value, with the standard
/// deviation given here; cross-talk is normal about its mean, with half of it as deviation;
/// hysteresis and lag are log-normal about their median, as nothing negative can come of them, with
/// a standard deviation of 20 %: an assumption.
/// Source: what they add up to, 1.5 deg RMS, stands for a good glove that was calibrated with care.
/// Gentner and Classen (J Neurosci Methods 178, 2009) found a mean standard deviation of 1.59 deg
/// for a glove of resistive bend sensors, and an "overall error" of 4.96 deg, which we take for no
/// RMS: it is as much larger as ten readings lie apart. VPL gave below 5 deg for its DataGlove
/// model 4; the best calibrated CyberGlove III has an RMS error below 10 deg at most joints. How it
/// is split is an assumption. Before calibration bend sensors differ far more: 30 % in resistance
/// (data sheet of Spectra Symbol's Flex Sensor, 2014).
struct SensorConfig {
  double gain_deviation_percent = 3.0;
  double offset_deviation_percent = 1.0;
  double curvature_deviation_percent = 1.0;
  double cross_talk_percent = 1.0;
  double hysteresis_deg = 0.5;
  double lag_ms = 0.0;
  double drift_deviation_percent = 0.0;
  double drift_time_s = 120.0;

  /// Each seed draws another glove.
  bool is_drawn() const;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
