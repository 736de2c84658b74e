#include "sim/video/comparison_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

constexpr double kCardRadius = 10.0;
constexpr double kRankingStarts_s = 1.0;  // before, the first samples decide, and marks would jump

std::span<const double> Column(const Signal& signal, int channel) {
  return {signal.col(channel).data(), static_cast<std::size_t>(signal.rows())};
}

/// `index_mcp` as a person writes it: index MCP.
std::string JointTitle(const std::string& name) {
  std::string title, word;
  for (char letter : name + "_") {
    if (letter != '_') {
      word += letter;
      continue;
    }
    if (word == "mcp" || word == "pip" || word == "dip" || word == "ip") {
      for (char& small : word) small = static_cast<char>(small - 'a' + 'A');
    }
    title += (title.empty() ? "" : " ") + word;
    word.clear();
  }
  return title;
}

[[noreturn]] void Fail(const std::string& what) { throw RunError("video: " + what); }

void CheckSignals(const VideoInput& input) {
  if (input.true_angle_rad == nullptr || input.raw_angle_rad == nullptr)
    Fail("signals are missing");
  const auto samples = input.true_angle_rad->rows(), joints = input.true_angle_rad->cols();
  if (samples == 0) Fail("there is no motion to show");
  if (!(input.rate_hz >= 1.0)) Fail(fmt::format("a rate of {} Hz", input.rate_hz));
  if (input.joint < 0 || input.joint >= joints) {
    Fail(fmt::format("joint {} is not in 0 .. {}", input.joint, joints - 1));
  }
  if (input.raw_angle_rad->cols() != joints) Fail("raw and true angles differ in joints");
  for (const VideoPane& pane : input.panes) {
    for (const Signal* signal :
         {pane.hand_angle_rad, pane.spool_angle_rad, pane.command_angle_rad}) {
      if (signal == nullptr) Fail(pane.title + ": signals are missing");
      if (signal->rows() == 0) Fail(pane.title + ": the trial has no samples");
    }
    if (pane.hand_angle_rad->cols() != joints || pane.command_angle_rad->cols() != joints ||
        pane.hand_angle_rad->rows() > samples ||
        pane.spool_angle_rad->rows() < pane.hand_angle_rad->rows()) {
      Fail(pane.title + ": signals differ in shape");
    }
  }
}

FrameClock ClockOf(const VideoInput& input) {
  CheckSignals(input);
  if (input.frames_per_s < 1 || input.frames_per_s > 240) {
    throw UserError(fmt::format("video: frames_per_s {} is not in 1 .. 240", input.frames_per_s));
  }
  return {input.rate_hz, input.frames_per_s, input.true_angle_rad->rows()};
}

}  // namespace

ComparisonPicture::ComparisonPicture(const VideoInput& input)
    : input_(input),
      clock_(ClockOf(input)),
      layout_(LayOutVideo(input.width_px, input.height_px, input.panes.size())),
      measured_joints_(input.measured_joints) {
  if (measured_joints_.empty()) {
    measured_joints_.resize(static_cast<std::size_t>(input.true_angle_rad->cols()));
    std::iota(measured_joints_.begin(), measured_joints_.end(), 0);
  }
  const AngleScale scale = ScaleOfAllPanes();
  for (std::size_t i = 0; i < input_.panes.size(); ++i) {
    scores_.push_back(ComputeRunningScores(*Measured(*input_.true_angle_rad),
                                           *Measured(*input_.panes[i].hand_angle_rad),
                                           input_.rate_hz, input_.jitter_above_hz, clock_));
    plots_.emplace_back(layout_.panes[i].curves, layout_.unit, scale, input_.rate_hz, clock_);
  }
  DrawBackground();
}

Columns<Signal> ComparisonPicture::Measured(const Signal& all_joints) const {
  return {all_joints, measured_joints_};
}

int ComparisonPicture::view_width_px() const {
  return static_cast<int>(layout_.panes.front().view.width);
}

int ComparisonPicture::view_height_px() const {
  return static_cast<int>(layout_.panes.front().view.height);
}

int ComparisonPicture::SampleCount(int pane) const {
  return input_.panes[pane].hand_angle_rad->rows();
}

int ComparisonPicture::SampleOf(int pane, int frame) const {
  return std::min(clock_.Sample(frame), SampleCount(pane) - 1);
}

AngleScale ComparisonPicture::ScaleOfAllPanes() const {
  std::vector<std::span<const double>> whole = {Column(*input_.true_angle_rad, input_.joint)};
  std::vector<std::span<const double>> noisy = {Column(*input_.raw_angle_rad, input_.joint)};
  for (const VideoPane& pane : input_.panes) {
    whole.push_back(Column(*pane.hand_angle_rad, input_.joint));
    noisy.push_back(Column(*pane.command_angle_rad, input_.joint));
  }
  const AngleScale scale = ChooseAngleScale(whole, noisy);
  TrimSignals();
  return scale;
}

void ComparisonPicture::DrawBackground() {
  background_ = Image(input_.width_px, input_.height_px);
  Painter painter(background_);
  const double unit = layout_.unit;
  painter.Fill(
      {0.0, 0.0, static_cast<double>(input_.width_px), static_cast<double>(input_.height_px)},
      palette::kPage);
  DrawHeader(painter);
  const TextStyle title = {.size_px = 15.0 * unit, .bold = true};
  const TextStyle caption = {.size_px = 11.0 * unit, .color = palette::kMutedInk};
  for (std::size_t i = 0; i < layout_.panes.size(); ++i) {
    const PaneLayout& pane = layout_.panes[i];
    painter.Clip(pane.card, kCardRadius * unit);
    painter.Fill(pane.card, palette::kCard);
    painter.FillGradient(pane.view, palette::kViewTop, palette::kViewBottom);
    painter.Unclip();
    painter.Outline(pane.card, palette::kCardEdge, std::max(1.0, std::round(unit)),
                    kCardRadius * unit);
    painter.Text(painter.Elide(input_.panes[i].title, pane.title.width, title),
                 {pane.title.x, pane.title.y + 26.0 * unit}, title);
    plots_[i].DrawScale(painter);
    painter.Text(JointTitle(input_.joint_name), {pane.curves.x, pane.curves.y - 8.0 * unit},
                 caption);
  }
}

void ComparisonPicture::DrawHeader(Painter& painter) const {
  const double unit = layout_.unit;
  const Rect& header = layout_.header;
  const TextStyle title = {.size_px = 19.0 * unit, .bold = true};
  const TextStyle subtitle = {.size_px = 12.5 * unit, .color = palette::kMutedInk};
  const std::string curves =
      fmt::format("Numbers: mean over {} joints, up to now.  Curves: one joint, {}.",
                  measured_joints_.size(), JointTitle(input_.joint_name));
  painter.Text(painter.Elide(input_.title, 0.8 * header.width, title),
               {header.x, header.y + 28.0 * unit}, title);
  painter.Text(painter.Elide(curves, 0.62 * header.width, subtitle),
               {header.x, header.y + 48.0 * unit}, subtitle);
  DrawLegend(painter, header.right(), header.y + 48.0 * unit);
}

void ComparisonPicture::DrawLegend(Painter& painter, double right, double baseline) const {
  const Signal& command_rad = *input_.panes.front().command_angle_rad;
  // Commands do not decide the angle of a joint that springs move.
  const bool decided = command_rad.rows() == 0 || !std::isnan(command_rad(0, input_.joint));
  struct Entry {
    const char* name;
    Color color;
    bool shown = true;
  };
  const Entry entries[] = {{"hand", palette::kHand},
                           {"command", palette::kCommand, decided},
                           {"glove, raw", palette::kRaw},
                           {"wearer, true", palette::kTrue}};
  const double unit = layout_.unit;
  const TextStyle style = {.size_px = 12.5 * unit};
  for (const Entry& entry : entries) {  // from the right
    if (!entry.shown) continue;
    const double width = painter.TextWidth(entry.name, style);
    painter.Text(entry.name, {right - width, baseline}, style);
    const double y = baseline - 4.5 * unit;
    const double end = right - width - 7.0 * unit;
    painter.Line({end - 20.0 * unit, y}, {end, y}, entry.color, 3.0 * unit);
    right = end - 20.0 * unit - 18.0 * unit;
  }
}

void ComparisonPicture::DrawClock(Painter& painter, int frame) const {
  const double unit = layout_.unit;
  const TextStyle style = {
      .size_px = 19.0 * unit, .bold = true, .align = Align::kRight, .tabular = true};
  painter.Text(fmt::format("{:.1f} s", clock_.Time_s(frame)),
               {layout_.header.right(), layout_.header.y + 28.0 * unit}, style);
  Rect done = layout_.progress;
  done.width *= static_cast<double>(frame + 1) / frame_count();
  painter.Fill(done, palette::kHand);
}

void ComparisonPicture::DrawStop(Painter& painter, int pane) const {
  const Rect& view = layout_.panes[pane].view;
  painter.Fill(view, Rgb(0xffffff, 0.6));
  painter.Text(fmt::format("stopped at {:.3f} s", SampleCount(pane) / input_.rate_hz),
               {view.x + view.width / 2.0, view.y + 24.0 * layout_.unit},
               {.size_px = 14.0 * layout_.unit,
                .color = palette::kWarning,
                .bold = true,
                .align = Align::kCenter});
}

void ComparisonPicture::DrawScore(Painter& painter, const Rect& rect, int pane, int frame,
                                  const char* label,
                                  std::vector<double> RunningScores::*score) const {
  const double unit = layout_.unit;
  const double value = (scores_[pane].*score)[frame];
  double largest = 0.0, lowest = INFINITY;
  for (const RunningScores& other : scores_) {
    largest = std::fmax(largest, (other.*score).back());
    lowest = std::fmin(lowest, (other.*score)[frame]);
  }
  // As many digits as tell the panes apart, the same from the first frame to the last.
  const int decimals = largest < 1.0 ? 3 : 2;
  const auto shown = [&](double number) {
    return std::isfinite(number) ? fmt::format("{:.{}f}°", number, decimals) : "–";
  };
  const bool best = scores_.size() > 1 && clock_.Time_s(frame) >= kRankingStarts_s &&
                    shown(value) == shown(lowest);
  const Color& accent = best ? palette::kGood : palette::kMutedInk;

  painter.Text(best ? std::string(label) + ", lowest" : label, {rect.x, rect.y + 17.0 * unit},
               {.size_px = 11.0 * unit, .color = accent});
  painter.Text(shown(value), {rect.x, rect.y + 39.0 * unit},
               {.size_px = 19.0 * unit, .bold = true, .tabular = true});
  const Rect bar = {rect.x, rect.y + 46.0 * unit, rect.width, 3.0 * unit};
  painter.Fill(bar, palette::kGrid, bar.height / 2.0);
  if (!std::isfinite(value) || largest <= 0.0) return;
  const double share = std::clamp(value / largest, 0.0, 1.0);
  painter.Fill({bar.x, bar.y, std::max(share * bar.width, bar.height), bar.height},
               best ? palette::kGood : palette::kBar, bar.height / 2.0);
}

void ComparisonPicture::DrawPane(Painter& painter, int pane, int frame, const Image& view) const {
  const PaneLayout& place = layout_.panes[pane];
  painter.Picture(view, static_cast<int>(place.view.x), static_cast<int>(place.view.y));
  if (HasStopped(pane, frame)) DrawStop(painter, pane);

  DrawScore(painter, place.tracking, pane, frame, "RMSE so far", &RunningScores::tracking_rmse_deg);
  DrawScore(painter, place.jitter, pane, frame, "Jitter so far", &RunningScores::jitter_rms_deg);

  const VideoPane& signals = input_.panes[pane];
  const Curve curves[] = {
      {Column(*input_.raw_angle_rad, input_.joint), palette::kRaw, 1.0, false},
      {Column(*signals.command_angle_rad, input_.joint), palette::kCommand, 1.3, false},
      {Column(*input_.true_angle_rad, input_.joint), palette::kTrue, 1.5, true},
      {Column(*signals.hand_angle_rad, input_.joint), palette::kHand, 2.0, true}};
  plots_[pane].Draw(painter, frame, curves);
}

void ComparisonPicture::Draw(int frame, std::span<const Image> views, ImageView image) const {
  std::ranges::copy(background_.pixels, image.pixels);
  Painter painter(image);
  for (std::size_t i = 0; i < views.size(); ++i) {
    DrawPane(painter, i, frame, views[i]);
  }
  DrawClock(painter, frame);
}

}  // namespace gauntlet::sim
