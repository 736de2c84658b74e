#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/calibration/predictor_fit.h"
#include "controller/linearisation/linearisation.h"
#include "controller/number.h"
#include "controller/prediction/prediction_config.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/output_file.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/fit/calibration.h"
#include "sim/results/table_text.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

/// A number of the fit, which needs --predictor.
Option OfPredictor(const char* name, Variable variable, Range range, const char* help) {
  return Option(name, std::move(variable),
                {.range = range, .shows_default = true, .needs = {"--predictor"}}, help);
}

struct CalibrateOptions {
  static constexpr auto kName = "calibrate";
  static constexpr auto kPurpose = "Calibrate a glove from a recording";
  static constexpr auto kGroup = Group::kMeasure;
  std::string recording;
  std::string out;  // empty: out/<recording>.calibration.yaml
  std::string curve = "table";
  PoseRecordingFormat format;
  std::vector<std::string> still;
  CalibrationOptions calibration;
  bool predictor = false;
  std::string curves;  // file of a calibration whose curves make angles; empty: counts stay counts
  controller::FittedToOthersPredictionConfig fit;
  std::vector<std::string> held_out;
  bool json = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() { return {SensorRows(), PredictorRows()}; }

  /// Curves of the sensors, and the noise.
  Options SensorRows() {
    return {
        Argument("recording", &recording, Offer::kFiles,
                 "CSV with NAME_counts and NAME_deg per channel, or a trace of run --csv; with "
                 "--map any table that inspect reads"),
        OutOption(out, "file to write [out/<recording>.calibration.yaml]", "FILE.yaml"),
        Option("--linearisation", &curve,
               {.value = "KIND",
                .choices = {"table", "two_point", "polynomial"},
                .shows_default = true},
               "curve in the file: table (a corner per pose), two_point or polynomial"),
        Option("--degree", &calibration.degree, {.range = {1, 9}, .shows_default = true},
               "degree of the polynomial"),
        Option("--confidence", &calibration.confidence_percent,
               {.range = {1.0, 99.9999}, .shows_default = true},
               "confidence level of the intervals of R, in percent"),
        Option("--map", &format.map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map, or the name of a preset: sensors and channels of the columns, bits and "
               "the time; scales are not used"),
        ArrayOptions(format.array),
        UnitOption(format.unit, {"counts", "volts", "deg", "rad"},
                   "unit of columns with the name of a channel alone: counts or volts of the "
                   "sensor, or the known angle",
                   {"--map"}),
        TimeUnitOption(format.time_unit, {"--map"}),
        Option("--still", &still, {.value = "a:b"},
               "the hand is still from a to b seconds after the first row; may be repeated "
               "[stretches in which no sensor moves]"),
        Option("--poses", &format.poses, {.value = "FILE.csv", .offer = Offer::kFiles},
               "table of the known poses: start_s, end_s (or until the next), NAME_deg"),
        Option("--settle-ms", &format.settle_ms, {.range = {0.0, 1e6}, .shows_default = true},
               "time after the last change of an angle from which its pose counts; 0 for measured "
               "angles that never stand still"),
        Option("--rate-hz", &format.rate_hz, {.range = {1.0, 1e6}, .shows_default = true},
               "sampling rate of a recording without a column of time"),
        Option("--full-scale", &format.full_scale_counts,
               {.range = {-1e9, 1e9}, .shows_default = true, .separator = ',', .is_one_word = true},
               "full scale of the converter, in counts (or volts), unless the map has its bits; "
               "one for all channels or one for each column; values at either end are not used"),
        Option("--min-counts", &format.min_counts,
               {.range = {-1e9, 1e9}, .shows_default = true, .separator = ',', .is_one_word = true},
               "smallest value of the converter, below 0 for signed counts; one, or one for each"),
    };
  }

  /// Weights of a prediction instead.
  Options PredictorRows() {
    return {
        Option("--predictor", &predictor, {.excludes = {"--still", "--poses"}},
               "fit the weights of a prediction {kind: fitted} instead; record motions like those "
               "to predict"),
        OfPredictor("--horizon-ms", &fit.horizon_ms, {0.0, 1000.0},
                    "prediction horizon, one for all channels or one for each"),
        OfPredictor("--order", &fit.order, {1, 1000}, "number of taps in the past"),
        OfPredictor("--tap-ms", &fit.tap_ms, {0.1, 1000.0},
                    "length of a tap; its samples are averaged"),
        OfPredictor("--caution", &fit.caution, {1.0, 1e6},
                    "factor on the variance of the noise in the fit"),
        Option("--calibration", &curves,
               {.value = "FILE.yaml", .offer = Offer::kFiles, .needs = {"--predictor"}},
               "file of gauntlet calibrate with the curves from counts to angles: for --offset"),
        Option("--offset", &fit.offset, {.needs = {"--predictor", "--calibration"}},
               "also use the angle of the channel; predictions then tend to usual angles, also at "
               "rest"),
        Option("--all-channels", &fit.all_channels, {.needs = {"--predictor", "--offset"}},
               "also use angles and motion of all other channels; better where fingers move "
               "together"),
        Option("--held-out", &held_out,
               {.value = "FILE.csv", .offer = Offer::kFiles, .needs = {"--predictor"}},
               "another recording, to judge the fit; may be repeated"),
        Option("--json", &json, {.excludes = {"--predictor"}}, "print JSON instead of the table"),
        VerboseOption(verbose, "also print all curves, confidence intervals and methods"),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
Leave unknown angles empty. R is measured in stretches of half a second or more in which no
sensor moves. Spikes and values beyond the scale are left out and counted. Name the channels as
gauntlet list channels does.

A table of poses, in seconds from the recording's first row:
  name,start_s,end_s,index_mcp_deg,index_pip_deg
  flat hand,1.0,4.0,0,0
  fist,5.5,8.5,85,100

Example:
  gauntlet run scenarios/known_poses.yaml --csv
  gauntlet calibrate out/known_poses/trace.raw.csv --out out/my_glove.yaml
  gauntlet run scenarios/calibrated_glove.yaml --set controllers.calibrated_kalman.calibration=out/my_glove.yaml

  gauntlet calibrate glove.csv --map map.csv --poses poses.csv --still 1:4 --still 10:15

  gauntlet run scenarios/random_motion.yaml --csv --controllers raw
  gauntlet calibrate out/random_motion/trace.raw.csv --predictor --horizon-ms 100
  gauntlet calibrate moving.csv --predictor --offset --all-channels --calibration out/my_glove.yaml --held-out other.csv
)";
};

CurveKind KindOf(const std::string& name) {
  if (name == "two_point") return CurveKind::kTwoPoint;
  return name == "polynomial" ? CurveKind::kPolynomial : CurveKind::kTable;
}

void RemarkOnRows(const PoseRecording& recording) {
  if (recording.rows_left_out > 0) {
    Say("gauntlet: {}: {} rows with a missing count left out\n", recording.name,
        recording.rows_left_out);
  }
  if (recording.rows_beyond_scale > 0) {
    const controller::ConverterRange& first = recording.converters.front();
    const bool alike = std::ranges::all_of(recording.converters,
                                           [&](const auto& range) { return range == first; });
    Say("gauntlet: {}: {} rows with a count {} left out\n", recording.name,
        recording.rows_beyond_scale,
        alike ? fmt::format("below {:g} or above {:g}", first.min_counts, first.full_scale_counts)
              : "outside the range of its converter");
  }
}

void Remark(const PoseRecording& recording, const Calibration& calibration) {
  RemarkOnRows(recording);
  if (!recording.columns_unknown.empty()) {
    std::vector<std::string> names;
    for (const std::string& name : recording.columns_unknown) names.push_back(Shown(name));
    Say("gauntlet: {}: left out, as no counts nor angles: {}\n", recording.name,
        OneLine(fmt::format("{}", fmt::join(names, ", ")), 400));
  }
  if (recording.angle_deg.cols() == 0) {
    Say("gauntlet: {}: no known angles (columns as index_mcp_deg, or --poses), so no "
        "linearisation\n",
        recording.name);
  }
  const std::vector<std::string> known = KnownChannelNames();
  for (const ChannelCalibration& channel : calibration.channels) {
    const std::string nearest = NearestName(channel.channel, known);
    if (!nearest.empty() && nearest != channel.channel) {
      Say("gauntlet: warning: {}: {} is not a channel of the simulated glove (did you mean {}?)\n",
          recording.name, Shown(channel.channel), nearest);
    }
    if (!channel.hidden_by_rounding || channel.variance_low_counts2 > 0.0) continue;
    Say("gauntlet: warning: {}: {}: rounding hides the noise, R is at most {:.3g}; is the sensor "
        "connected?\n",
        recording.name, Shown(channel.channel), channel.variance_high_counts2);
  }
}

/// `2:5`, from 2 to 5 s.
TimeStretch StretchOf(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view behind = std::string_view(text).substr(std::min(colon + 1, text.size()));
  const auto start_s = controller::ParseNumber(std::string_view(text).substr(0, colon));
  const auto end_s = controller::ParseNumber(behind);
  if (!start_s || !end_s || !(*start_s >= 0.0) || !(*end_s > *start_s)) {
    throw UserError({.place = "--still " + text,
                     .problem = "must be two times in seconds from the first row, as 2:5"});
  }
  return {.start_s = *start_s, .end_s = *end_s};
}

std::filesystem::path TargetOf(const CalibrateOptions& options) {
  if (options.out.empty()) {
    const std::string stem = std::filesystem::path(options.recording).stem().string();
    const char* ending = options.predictor ? ".predictor.yaml" : ".calibration.yaml";
    return std::filesystem::path("out") / (stem + ending);
  }
  return options.out;
}

/// The recording in degrees, by the curves of a calibration.
Eigen::MatrixXd AnglesOf(const PoseRecording& recording, const std::string& file) {
  controller::ControllerConfig config;
  try {
    UseCalibration(ReadAll<Calibration>(file), recording.channel_names, true, {}, config);
    if (config.linearisation.kind == controller::LinearisationKind::kGlove) {
      throw controller::SettingError("linearisation", "has no curves from counts to angles");
    }
    const std::vector<double> zeros(recording.channel_names.size(), 0.0);
    const std::vector<double> ones(recording.channel_names.size(), 1.0);
    const controller::GloveCalibration any = {.channel_names = recording.channel_names,
                                              .low_counts = zeros,
                                              .high_counts = ones,
                                              .low_angle_rad = zeros,
                                              .high_angle_rad = ones};  // the curves count
    const auto linearisation =
        MakeLinearisation(config.linearisation, any, recording.channel_names);
    Eigen::MatrixXd angles = recording.counts;
    std::vector<double> sample(recording.channel_names.size());
    Eigen::Map<Eigen::RowVectorXd> row(sample.data(), std::ssize(sample));
    for (Eigen::Index k = 0; k < angles.rows(); ++k) {
      row = angles.row(k);
      linearisation->ToAngles(sample, sample);
      angles.row(k) = row * kDegPerRad;
    }
    return angles;
  } catch (const controller::SettingError& error) {
    throw UserError({.place = file, .key = error.key(), .problem = error.problem()});
  }
}

/// The motion of a recording as it is fitted to, in stretches: nothing is foreseen across a gap.
controller::RecordedMotion MotionOf(const PoseRecording& recording, const std::string& curves) {
  const Eigen::MatrixXd motion =
      curves.empty() ? Eigen::MatrixXd(recording.counts) : AnglesOf(recording, curves);
  controller::RecordedMotion stretches;
  for (std::size_t i = 0; i < recording.stretch_begins.size(); ++i) {
    const Eigen::Index begin = recording.stretch_begins[i];
    const bool is_last = i + 1 == recording.stretch_begins.size();
    const Eigen::Index end = is_last ? motion.rows() : recording.stretch_begins[i + 1];
    stretches.emplace_back(motion.middleRows(begin, end - begin));
  }
  return stretches;
}

/// Does what may find fault with a recording.
template <class Work>
auto OfRecording(const PoseRecording& recording, const Work& work) {
  try {
    return work();
  } catch (const controller::SettingError& error) {
    throw UserError({.place = recording.name, .key = error.key(), .problem = error.problem()});
  }
}

/// Recordings that were not fitted to. Errors: UserError for other channels or another rate.
std::optional<controller::PredictionErrors> JudgeHeldOut(
    const CalibrateOptions& options, const PoseRecording& fitted,
    const controller::FittedPredictionConfig& predictor) {
  if (options.held_out.empty()) return {};
  controller::RecordedMotion motions;
  std::optional<PoseRecording> last;
  for (const std::string& file : options.held_out) {
    last = LoadPoseRecording(file, options.format);
    if (last->channel_names != fitted.channel_names) {
      throw UserError({.place = file, .problem = "has other channels than " + fitted.name});
    }
    constexpr double kSameRate = 0.01;
    if (std::abs(last->rate_hz / fitted.rate_hz - 1.0) > kSameRate) {
      throw UserError({.place = file,
                       .problem = fmt::format("has {:g} Hz, must have those of {}, {:g}",
                                              last->rate_hz, fitted.name, fitted.rate_hz)});
    }
    RemarkOnRows(*last);
    std::ranges::move(MotionOf(*last, options.curves), std::back_inserter(motions));
  }
  return OfRecording(*last, [&] { return JudgePredictor(predictor, motions, fitted.rate_hz); });
}

void RunPredictorFit(const CalibrateOptions& options) {
  const std::filesystem::path target = TargetOf(options);
  const PoseRecording recording = LoadPoseRecording(options.recording, options.format);
  RefuseInput(target);
  const controller::PredictorFit fit = OfRecording(recording, [&] {
    return FitPredictor(MotionOf(recording, options.curves), recording.rate_hz, options.fit);
  });
  const auto held_out = JudgeHeldOut(options, recording, fit.predictor);
  controller::PredictionConfig prediction = {fit.predictor};
  MakeDirectoryOf(target);
  WriteOutputFile(
      target,
      "# Made by gauntlet calibrate --predictor: of a controller whose glove has the channels of\n"
      "# the recording, in its order. The weights serve motions like those in it.\n" +
          SettingsToYaml([&](controller::SettingsVisitor& visitor) {
            VisitGroup(visitor, {.key = "prediction", .help = {}}, prediction);
          }));
  PrintText(
      TextOf(PredictorFitText(recording, fit, held_out, options.curves.empty() ? "counts" : "deg",
                              target.string(), options.verbose),
             StyleOf(options.terminal)));
  FlushOutput();
  RemarkOnRows(recording);
  if (const std::size_t gaps = recording.stretch_begins.size() - 1; gaps > 0) {
    Say("gauntlet: {}: {}, across which nothing is fitted\n", recording.name, Counted(gaps, "gap"));
  }
  Say("wrote {}\n", target.string());
}

void RunCalibrate(const CalibrateOptions& given) {
  CalibrateOptions options = given;
  options.calibration.curve = KindOf(options.curve);
  for (const std::string& text : options.still) options.format.still.push_back(StretchOf(text));
  if (options.predictor) return RunPredictorFit(options);
  const std::filesystem::path target = TargetOf(options);
  const PoseRecording recording = LoadPoseRecording(options.recording, options.format);
  RefuseInput(target);
  CurveErrors errors;
  Calibration calibration = Calibrate(recording, options.calibration, errors);
  MakeDirectoryOf(target);
  WriteOutputFile(target,
                  "# Made by gauntlet calibrate. A controller of a scenario includes it: "
                  "`calibration: FILE`.\n" +
                      SettingsToYaml([&](auto& visitor) { calibration.Visit(visitor); }));
  PrintText(options.json ? CalibrationJson(calibration, errors)
                         : TextOf(CalibrationText(calibration, errors, options.calibration.curve,
                                                  target.string(), options.verbose),
                                  StyleOf(options.terminal)));
  FlushOutput();
  Remark(recording, calibration);
  Say("wrote {}\n", target.string());
}

}  // namespace

Command MakeCalibrateCommand() { return MakeCommand(RunCalibrate); }

}  // namespace gauntlet::sim
