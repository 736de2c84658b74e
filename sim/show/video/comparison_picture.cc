#include "sim/show/video/comparison_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/base/error.h"
#include "sim/score/jitter.h"
#include "sim/show/video/card.h"

namespace gauntlet::sim {
namespace {

constexpr double kCardRadius = 10.0;
constexpr double kInsetShare = 0.36;  // of the shorter side of a view
constexpr double kInsetGap = 10.0;
constexpr double kShownJitter_s = 0.25;      // before now, beside a fingertip
constexpr double kSmallestJitter_deg = 0.1;  // that its plot shows
constexpr double kTitleShare = 0.8;          // of the header's width
constexpr double kNameShare = 0.25;          // the same, of a name in the legend
constexpr double kSecondOpacity = 0.55;      // of an overlay

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
  if (input.true_angle_rad == nullptr) Fail("signals are missing");
  if (input.overlay && input.panes.size() != 2) Fail("an overlay is of two hands");
  const auto samples = input.true_angle_rad->rows(), joints = input.true_angle_rad->cols();
  if (samples == 0) Fail("there is no motion to show");
  if (!(input.rate_hz >= 1.0)) Fail(fmt::format("a rate of {} Hz", input.rate_hz));
  if (input.joint < 0 || input.joint >= joints) {
    Fail(fmt::format("joint {} is not in 0 .. {}", input.joint, joints - 1));
  }
  for (const VideoPane& pane : input.panes) {
    for (const Signal* signal : {pane.hand_angle_rad, pane.spool_angle_rad}) {
      if (signal == nullptr) Fail(pane.title + ": signals are missing");
      if (signal->rows() == 0) Fail(pane.title + ": the trial has no samples");
    }
    if (pane.hand_angle_rad->cols() != joints || pane.hand_angle_rad->rows() > samples ||
        pane.spool_angle_rad->rows() < pane.hand_angle_rad->rows()) {
      Fail(pane.title + ": signals differ in shape");
    }
  }
}

Rect FrameOf(const VideoInput& input) {
  return {0.0, 0.0, static_cast<double>(input.width_px), static_cast<double>(input.height_px)};
}

FrameClock ClockOf(const VideoInput& input) {
  CheckSignals(input);
  if (input.frames_per_s < 1 || input.frames_per_s > 240) {
    throw UserError(fmt::format("video: frames_per_s {} is not in 1 .. 240", input.frames_per_s));
  }
  const FrameClock clock(input.rate_hz, input.frames_per_s, input.true_angle_rad->rows(),
                         input.excerpt);
  if (clock.FrameCount() < 1) {
    throw UserError(fmt::format("video: nothing to show from {:g} s on: the motion takes {:g} s",
                                clock.first_s(), input.true_angle_rad->rows() / input.rate_hz));
  }
  return clock;
}

}  // namespace

ComparisonPicture::ComparisonPicture(const VideoInput& input)
    : input_(input),
      clock_(ClockOf(input)),
      layout_(input.overlay ? LayOutOverlay(input.width_px, input.height_px)
                            : LayOutVideo(input.width_px, input.height_px, input.panes.size())),
      measured_joints_(MeasuredJointsOf(input)),
      colour_scale_(ColourScaleOf(input)) {
  for (const VideoPane& pane : input_.panes) {
    scores_.push_back(ComputeRunningScores(*Measured(*input_.true_angle_rad),
                                           *Measured(*pane.hand_angle_rad), input_.rate_hz,
                                           input_.jitter_above_hz, clock_, input_.counted));
    errors_.emplace_back(
        pane.hand_angle_rad->col(input_.joint) -
        input_.true_angle_rad->col(input_.joint).head(pane.hand_angle_rad->rows()));
    jitter_curves_.push_back(JitterOf(pane));
  }
  const AngleScale errors = ScaleOfErrors(), jitter = ScaleOfJitter();
  for (const PaneLayout& pane : layout_.panes) {
    if (pane.error.height <= 0.0) continue;
    const bool all = pane.jitter_curve.height > 0.0;
    error_plots_.emplace_back(pane.error, layout_.unit, errors, clock_, /*times=*/!all);
    if (!all) continue;
    jitter_plots_.emplace_back(pane.jitter_curve, layout_.unit, jitter, clock_);
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

int ComparisonPicture::inset_px() const {
  if (!IsSlowMotion(input_.excerpt) || input_.overlay) return 0;
  return static_cast<int>(kInsetShare * std::min(view_width_px(), view_height_px()));
}

int ComparisonPicture::SampleCount(int pane) const {
  return input_.panes[pane].hand_angle_rad->rows();
}

int ComparisonPicture::SampleOf(int pane, int frame) const {
  return std::min(clock_.Sample(frame), SampleCount(pane) - 1);
}

AngleScale ComparisonPicture::ScaleOfErrors() const {
  const std::vector<double> none(1, 0.0);
  std::vector<std::span<const double>> whole = {none};
  for (const Signal& error_rad : errors_) whole.push_back(Column(error_rad, 0));
  const AngleScale scale = ChooseAngleScale(whole, {});
  TrimSignals();
  return scale;
}

AngleScale ComparisonPicture::ScaleOfJitter() const {
  const std::vector<double> none(1, 0.0);
  const std::vector<std::span<const double>> whole = {none};
  std::vector<std::span<const double>> noisy;
  for (const Signal& jitter_rad : jitter_curves_) noisy.push_back(Column(jitter_rad, 0));
  const AngleScale scale = ChooseAngleScale(whole, noisy, kSmallestJitter_deg);
  TrimSignals();
  return scale;
}

Signal ComparisonPicture::JitterOf(const VideoPane& pane) const {
  const Signal angle_rad = pane.hand_angle_rad->col(input_.joint);
  Fourier fourier;
  const FilteredSignal jitter =
      Trembling(angle_rad, input_.rate_hz, input_.jitter_above_hz, fourier);
  Signal whole = Signal::Constant(angle_rad.rows(), 1, kNaN);
  if (jitter.values.rows() > 0) {
    whole.middleRows(jitter.first_sample, jitter.values.rows()) = jitter.values;
  }
  return whole;
}

void ComparisonPicture::DrawBackground() {
  background_ = Image(input_.width_px, input_.height_px);
  const std::unique_ptr<Painter> opened = OpenPainter(background_);
  Painter& painter = *opened;
  const double unit = layout_.unit;
  painter.Fill(FrameOf(input_), palette::kPage);
  DrawHeader(painter);
  const TextStyle title = {.size_px = 18.0 * unit, .bold = true};
  for (std::size_t i = 0; i < layout_.panes.size(); ++i) {
    const PaneLayout& pane = layout_.panes[i];
    painter.Clip(pane.card, kCardRadius * unit);
    painter.Fill(pane.card, palette::kCard);
    painter.FillGradient(pane.view, palette::kViewTop, palette::kViewBottom);
    painter.Unclip();
    painter.Outline(pane.card, palette::kCardEdge, std::max(1.0, std::round(unit)),
                    kCardRadius * unit);
    const std::string name = input_.overlay
                                 ? input_.panes[0].title + ", behind it " + input_.panes[1].title
                                 : input_.panes[i].title;
    double left = pane.title.x;
    if (!input_.overlay) {
      painter.Dot({left + 6.0 * unit, pane.title.y + 19.0 * unit}, 6.0 * unit,
                  ColourOfPane(input_, static_cast<int>(i)));
      left += 20.0 * unit;
    }
    const double right = pane.title.right();
    const std::string role = input_.overlay ? "" : input_.panes[i].role;
    const TextStyle small = {
        .size_px = 14.0 * unit, .color = palette::kMutedOnLight, .align = Align::kRight};
    const double name_width = painter.TextWidth(name, title);
    const bool role_fits = left + name_width + painter.TextWidth(role, small) + 12.0 * unit < right;
    if (role_fits) painter.Text(role, {right, pane.title.y + 25.0 * unit}, small);
    painter.Text(painter.Elide(name, right - left, title), {left, pane.title.y + 25.0 * unit},
                 title);
    if (!error_plots_.empty()) error_plots_[i].DrawScale(painter);
    if (!jitter_plots_.empty()) jitter_plots_[i].DrawScale(painter);
  }
}

void ComparisonPicture::DrawHeader(Painter& painter) const {
  const double unit = layout_.unit;
  const Rect& header = layout_.header;
  const TextStyle title = {.size_px = 19.0 * unit, .bold = true};
  const TextStyle subtitle = {.size_px = 14.0 * unit, .color = palette::kMutedOnLight};
  const std::string curves =
      error_plots_.empty() ? fmt::format("mean of {} joints", measured_joints_.size())
                           : fmt::format("Numbers: mean over {} joints up to now. Curves: {}.",
                                         measured_joints_.size(), JointTitle(input_.joint_name));
  painter.Text(painter.Elide(input_.title, kTitleShare * header.width, title),
               {header.x, header.y + 27.0 * unit}, title);
  const double legend = DrawLegend(painter, header.right(), header.y + 50.0 * unit);
  painter.Text(painter.Elide(curves, legend - 12.0 * unit - header.x, subtitle),
               {header.x, header.y + 50.0 * unit}, subtitle);
}

double ComparisonPicture::DrawLegend(Painter& painter, double right, double baseline) const {
  struct Entry {
    std::string name;
    Color color;
    bool shown = true;
    bool from_white = false;
  };
  const Entry entries[] = {
      {fmt::format("joint error 0 to {:g}°", colour_scale_.full_error_deg),
       input_.overlay ? palette::kMutedOnLight : palette::kJointError, true, true},
      {"wearer", palette::kWearer.OnLight()},
      {input_.panes.back().title, ColourOfPane(input_, static_cast<int>(input_.panes.size()) - 1),
       input_.overlay},
      {input_.panes.front().title, ColourOfPane(input_, 0), input_.overlay}};
  const double unit = layout_.unit;
  const TextStyle style = {.size_px = 14.0 * unit};
  for (const Entry& entry : entries) {  // from the right
    if (!entry.shown) continue;
    const std::string name = painter.Elide(entry.name, kNameShare * layout_.header.width, style);
    const double width = painter.TextWidth(name, style);
    painter.Text(name, {right - width, baseline}, style);
    const double y = baseline - 4.5 * unit;
    const double end = right - width - 7.0 * unit;
    const Rect sample = {end - 20.0 * unit, y - 1.5 * unit, 20.0 * unit, 3.0 * unit};
    if (entry.from_white) {
      painter.FillGradientAcross({sample.x, y - 5.0 * unit, sample.width, 10.0 * unit},
                                 palette::kCard, entry.color);
    } else {
      painter.Fill(sample, entry.color);
    }
    right = end - 20.0 * unit - 18.0 * unit;
  }
  return right;
}

void ComparisonPicture::DrawClock(Painter& painter, int frame) const {
  const double unit = layout_.unit;
  const TextStyle style = {
      .size_px = 19.0 * unit, .bold = true, .align = Align::kRight, .tabular = true};
  // As many decimals as change from frame to frame at most.
  const std::string time =
      clock_.speed() == 1.0 ? fmt::format("{:.1f} s", clock_.Time_s(frame))
                            : fmt::format("{:.2f} s, {:g} x", clock_.Time_s(frame), clock_.speed());
  const double right = layout_.header.right(), baseline = layout_.header.y + 28.0 * unit;
  painter.Text(time, {right, baseline}, style);
  DrawPart(painter, frame, {right - painter.TextWidth(time, style) - 14.0 * unit, baseline});
  Rect done = layout_.progress;
  done.width *= static_cast<double>(frame + 1) / frame_count();
  painter.Fill(done, palette::kMutedOnLight);
}

void ComparisonPicture::DrawPart(Painter& painter, int frame, Point right_end) const {
  const int sample = clock_.Sample(frame);
  const auto part = std::ranges::find_if(input_.parts, [sample](const Segment& one) {
    return one.begin <= sample && sample < one.end;
  });
  if (part == input_.parts.end()) return;
  const TextStyle style = {
      .size_px = 15.0 * layout_.unit, .color = palette::kMutedOnLight, .align = Align::kRight};
  const double left = layout_.header.x + (kTitleShare + 0.01) * layout_.header.width;
  painter.Text(painter.Elide(part->label, right_end.x - left, style), right_end, style);
}

void ComparisonPicture::DrawStop(Painter& painter, int pane) const {
  const Rect& view = PlaceOf(pane).view;
  std::string text = fmt::format("stopped at {:.3f} s", SampleCount(pane) / input_.rate_hz);
  double baseline = view.y + 24.0 * layout_.unit;
  if (input_.overlay) {  // the other one may go on
    text = input_.panes[pane].title + " " + text;
    baseline += 20.0 * layout_.unit * pane;
  } else {
    painter.Fill(view, Rgb(0xffffff, 0.6));
  }
  painter.Text(text, {view.x + view.width / 2.0, baseline},
               {.size_px = 14.0 * layout_.unit,
                .color = palette::kWarning,
                .bold = true,
                .align = Align::kCenter});
}

void ComparisonPicture::DrawScore(Painter& painter, Rect rect, int pane, int frame,
                                  std::string label,
                                  std::vector<double> RunningScores::*score) const {
  const double unit = layout_.unit;
  const double value = (scores_[pane].*score)[frame];
  double largest = 0.0;
  for (const RunningScores& other : scores_) largest = std::fmax(largest, (other.*score).back());
  // As many digits as tell the panes apart, the same from the first frame to the last.
  const int decimals = largest < 1.0 ? 3 : 2;
  const std::string shown = std::isfinite(value) ? fmt::format("{:.{}f}°", value, decimals) : "–";
  const TextStyle number = {
      .size_px = 18.0 * unit, .bold = true, .align = Align::kRight, .tabular = true};
  const TextStyle caption = {.size_px = 14.0 * unit, .color = palette::kMutedOnLight};
  Point at = {rect.x, rect.y + 21.0 * unit};
  if (input_.overlay) {
    painter.Dot({at.x + 4.0 * unit, at.y - 5.0 * unit}, 4.0 * unit, ColourOfPane(input_, pane));
    at.x += 12.0 * unit;
    label = input_.panes[pane].title + ": " + label;
  }
  const double right = rect.right() - painter.TextWidth(shown, number) - 6.0 * unit;
  painter.Text(painter.Elide(label, right - at.x, caption), at, caption);
  painter.Text(shown, {rect.right(), at.y}, number);
}

void ComparisonPicture::DrawInset(Painter& painter, int pane, int frame,
                                  const DrawnHands& hands) const {
  const FingertipPath& path = hands.view.fingertip(pane);
  if (hands.insets[pane].pixels.empty() || path.places.empty()) return;
  const double unit = layout_.unit, side = inset_px(), gap = kInsetGap * unit;
  const Rect& view = PlaceOf(pane).view;
  const Rect place = {std::round(view.right() - gap - side), std::round(view.y + gap), side, side};
  const double radius = 0.5 * side;
  painter.Clip(place, radius);
  painter.Fill(place, palette::kCard);
  painter.Picture(hands.insets[pane], static_cast<int>(place.x), static_cast<int>(place.y));
  // Each place of the tip, seen from where it were without jitter.
  const CameraWindow window = hands.view.InsetAround({0.0, 0.0});
  const double now_s = SampleOf(pane, frame) / input_.rate_hz;
  std::vector<Point> points;
  for (int i = path.IndexAt(now_s - kShownJitter_s); i <= path.IndexAt(now_s); ++i) {
    const auto& [tip, smooth] = path.places[i];
    const Point at = PixelOf(window, {tip.x - smooth.x, tip.y - smooth.y}, inset_px(), inset_px());
    points.push_back({place.x + at.x, place.y + at.y});
  }
  painter.Polyline(points, palette::kCard, 5.0 * unit);
  painter.Polyline(points, ColourOfPane(input_, pane), 2.5 * unit);
  painter.Dot(points.back(), 4.0 * unit, ColourOfPane(input_, pane));
  painter.Unclip();
  painter.Outline(place, ColourOfPane(input_, pane), 2.0 * unit, radius);
  const std::string label = fmt::format("fingertip x {:g}", HandView::kMagnification);
  const TextStyle style = {.size_px = 14.0 * unit, .align = Align::kCenter};
  const double rightmost = view.right() - gap - 0.5 * painter.TextWidth(label, style);
  painter.Text(label, {std::min(place.x + radius, rightmost), place.bottom() + 18.0 * unit}, style);
}

void ComparisonPicture::DrawCurves(Painter& painter, int place, int frame) const {
  std::vector<Curve> errors, jitter;
  for (int pane = input_.overlay ? 1 : place; pane >= place; --pane) {  // the first one on top
    errors.push_back({Column(errors_[pane], 0), ColourOfPane(input_, pane), 2.0, true, true});
    jitter.push_back({Column(jitter_curves_[pane], 0), ColourOfPane(input_, pane), 1.3});
  }
  if (!error_plots_.empty()) error_plots_[place].Draw(painter, frame, errors);
  if (!jitter_plots_.empty()) jitter_plots_[place].Draw(painter, frame, jitter);
}

void ComparisonPicture::DrawView(Painter& painter, int pane, const DrawnHands& hands) const {
  const Rect& view = PlaceOf(pane).view;
  const int x = static_cast<int>(view.x), y = static_cast<int>(view.y);
  painter.Picture(hands.wearer.shape(), x, y);
  painter.Picture(hands.panes[pane], x, y);
  painter.Picture(hands.wearer.OutlineOver(hands.panes[pane]), x, y);
}

void ComparisonPicture::DrawOverlay(Painter& painter, const DrawnHands& hands) const {
  const Rect& view = PlaceOf(0).view;
  const int x = static_cast<int>(view.x), y = static_cast<int>(view.y);
  painter.Picture(hands.wearer.shape(), x, y);
  painter.Picture(hands.panes[1], x, y, kSecondOpacity);
  painter.Picture(hands.panes[0], x, y);
  painter.Picture(hands.second.OutlineOver(hands.panes[0]), x, y);
  painter.Picture(hands.wearer.OutlineOver(hands.panes[0]), x, y);
}

void ComparisonPicture::DrawPane(Painter& painter, int pane, int frame,
                                 const DrawnHands& hands) const {
  const PaneLayout& place = PlaceOf(pane);
  if (inset_px() > 0) DrawInset(painter, pane, frame, hands);
  if (HasStopped(pane, frame)) DrawStop(painter, pane);

  const auto part_of = [&](const Rect& rect) {
    if (!input_.overlay) return rect;
    const double gap = 16.0 * layout_.unit, width = 0.5 * (rect.width - gap);
    return Rect{rect.x + pane * (width + gap), rect.y, width, rect.height};
  };
  DrawScore(painter, part_of(place.tracking), pane, frame, "tracking error, RMS",
            &RunningScores::tracking_rmse_deg);
  DrawScore(painter, part_of(place.jitter), pane, frame, "jitter, RMS",
            &RunningScores::jitter_rms_deg);
}

int ComparisonPicture::outline_px() const {
  return std::max(1, static_cast<int>(std::round(layout_.unit)));
}

void ComparisonPicture::DrawTitle(ImageView image) const {
  DrawTitleCard(*OpenPainter(image), FrameOf(input_), layout_.card_unit, input_.title,
                input_.question);
}

void ComparisonPicture::DrawVerdict(ImageView image) const {
  DrawScoreBoard(*OpenPainter(image), FrameOf(input_), layout_.card_unit, input_.title,
                 input_.verdict);
}

void ComparisonPicture::Draw(int frame, const DrawnHands& hands, ImageView image) const {
  std::ranges::copy(background_.pixels, image.pixels);
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  if (input_.overlay) DrawOverlay(painter, hands);
  for (int pane = static_cast<int>(hands.panes.size()) - 1; pane >= 0; --pane) {  // 0 on top
    if (!input_.overlay) DrawView(painter, pane, hands);
    DrawPane(painter, pane, frame, hands);
  }
  for (int place = 0; place < std::ssize(layout_.panes); ++place) {
    DrawCurves(painter, place, frame);
  }
  DrawClock(painter, frame);
}

}  // namespace gauntlet::sim
