#include "sim/show/video/hand_view.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "sim/base/error.h"
#include "sim/hand/posture.h"
#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr int kPosturesLookedAt = 25;  // evenly over the motion, of each hand
constexpr double kMoves_m = 0.003;     // less is not seen
constexpr double kMovesShare = 0.3;    // of what moves most: less is not what the picture is about
constexpr double kFingertipRate_hz = 250.0;  // jitter of 10 Hz is a wave of 25 points
constexpr double kShownPath_s = 0.5;         // before the first frame

std::vector<double> Row(const Signal& signal, int sample) {
  std::vector<double> values(signal.cols());
  for (Eigen::Index i = 0; i < signal.cols(); ++i) values[i] = signal(sample, i);
  return values;
}

std::span<const mjtNum, 3> PositionOf(const mjData& data, int geom) {
  return std::span<const mjtNum, 3>(data.geom_xpos + 3 * geom, 3);
}

/// The end of the longest chain of bodies that hangs on one.
int EndOfChain(const mjModel& model, int body) {
  std::vector<int> depth(model.nbody, -1);
  depth[body] = 0;
  int end = body;
  for (int i = body + 1; i < model.nbody; ++i) {  // parents come first
    if (depth[model.body_parentid[i]] < 0) continue;
    depth[i] = depth[model.body_parentid[i]] + 1;
    if (depth[i] > depth[end]) end = i;
  }
  return end;
}

/// Outermost shape of a body; -1 if it has none.
int OutermostGeom(const mjModel& model, int body) {
  int outermost = -1;
  double furthest_m = -1.0;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (model.geom_bodyid[geom] != body) continue;
    const double away_m = mju_norm3(model.geom_pos + 3 * geom);
    if (away_m > furthest_m) furthest_m = away_m, outermost = geom;
  }
  return outermost;
}

/// Widens `window` to a shape, seen from `origin`: a round one by its axis and radius, another by
/// its bounding sphere.
void Include(const mjModel& model, const mjData& data, int camera, int geom, Point origin,
             CameraWindow& window) {
  const bool round =
      model.geom_type[geom] == mjGEOM_CAPSULE || model.geom_type[geom] == mjGEOM_CYLINDER;
  const double radius_m = round ? model.geom_size[3 * geom] : model.geom_rbound[geom];
  const double half_length_m = round ? model.geom_size[3 * geom + 1] : 0.0;
  for (const double along_m : {-half_length_m, half_length_m}) {
    mjtNum end_m[3];
    for (int i = 0; i < 3; ++i) {
      end_m[i] = data.geom_xpos[3 * geom + i] + along_m * data.geom_xmat[9 * geom + 3 * i + 2];
    }
    const auto seen = SeenFrom(data, camera, end_m);
    if (!seen) continue;
    const double radius = radius_m / seen->depth_m;
    const Point middle = {seen->tangents.x - origin.x, seen->tangents.y - origin.y};
    window.Include({middle.x - radius, middle.y - radius});
    window.Include({middle.x + radius, middle.y + radius});
  }
}

/// Calls `visit` with each posture that the camera's window has to show set in `data`, the wearer's
/// before those of the panes at the same time.
template <class Visit>
void ForPosturesOfAll(const VideoInput& input, const HandModel& hand, mjData& data, Visit&& visit) {
  for (int i = 0; i < kPosturesLookedAt; ++i) {
    const auto sample_of = [&](const Signal& signal) {
      return static_cast<int>((signal.rows() - 1) * i / (kPosturesLookedAt - 1));
    };
    SetWearer(input, hand, sample_of(*input.true_angle_rad), data);
    visit(true);
    for (const VideoPane& pane : input.panes) {
      SetPane(pane, hand, sample_of(*pane.hand_angle_rad), data);
      visit(false);
    }
  }
}

/// Which bodies of the hand hang on the one that carries a camera: on the world, all.
std::vector<bool> BodiesBefore(const HandModel& hand, int camera) {
  const mjModel& model = hand.model();
  const int root = model.body_rootid[model.jnt_bodyid[hand.joints().front().joint]];
  const int carrier = model.cam_bodyid[camera];
  std::vector<bool> before(model.nbody, false);
  for (int i = 1; i < model.nbody; ++i) {  // parents come first
    const int parent = model.body_parentid[i];
    before[i] = model.body_rootid[i] == root && (parent == carrier || before[parent]);
  }
  return before;
}

/// The first body beyond the palm on the way from it to a body; -1 where that is not beyond it.
int FingerOf(const mjModel& model, int body) {
  const int palm = mj_name2id(&model, mjOBJ_BODY, "palm");
  while (body > 0 && model.body_parentid[body] != palm) body = model.body_parentid[body];
  return body > 0 ? body : -1;
}

/// Shapes whose middle moves in the picture, however little those of fingers do, and those of the
/// palm. None if nothing moves.
std::vector<int> ShapesThatMatter(const VideoInput& input, const HandModel& hand, int camera,
                                  const std::vector<bool>& bodies, mjData& data) {
  const mjModel& model = hand.model();
  std::vector<CameraWindow> reach;  // of each shape's middle
  std::vector<double> depth_m(model.ngeom, 0.0);
  ForPosturesOfAll(input, hand, data, [&](bool) {
    const bool first = reach.empty();
    reach.resize(model.ngeom);
    for (int geom = 0; geom < model.ngeom; ++geom) {
      const auto seen = SeenFrom(data, camera, PositionOf(data, geom));
      if (!seen) continue;
      const auto [x, y] = seen->tangents;
      if (first) reach[geom] = {x, x, y, y};
      reach[geom].Include(seen->tangents);
      depth_m[geom] = seen->depth_m;
    }
  });
  std::vector<double> moved_m(model.ngeom, 0.0);
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (!bodies[model.geom_bodyid[geom]]) continue;
    moved_m[geom] = depth_m[geom] * std::max(reach[geom].width(), reach[geom].height());
  }
  const double most_m = std::ranges::max(moved_m);
  if (most_m < kMoves_m) return {};
  const int palm = mj_name2id(&model, mjOBJ_BODY, "palm");
  std::vector<int> shapes;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const bool of_palm = model.geom_bodyid[geom] == palm && bodies[palm];
    const bool of_finger = FingerOf(model, model.geom_bodyid[geom]) >= 0;
    const double least_m = of_finger ? kMoves_m : kMovesShare * most_m;
    if (of_palm || moved_m[geom] >= least_m) shapes.push_back(geom);
  }
  return shapes;
}

/// Keeps only the shapes of all fingers, or of the one that a joint is in; all where that leaves
/// none, as for a joint of the wrist.
void KeepFramed(const HandModel& hand, Framed framed, int joint, std::vector<int>& shapes) {
  if (framed == Framed::kWhatMoves) return;
  const mjModel& model = hand.model();
  const int chosen = FingerOf(model, model.jnt_bodyid[hand.joints()[joint].joint]);
  std::vector<int> kept;
  std::ranges::copy_if(shapes, std::back_inserter(kept), [&](int geom) {
    const int finger = FingerOf(model, model.geom_bodyid[geom]);
    return finger >= 0 && (framed == Framed::kFingers || finger == chosen);
  });
  if (!kept.empty()) shapes = kept;
}

/// The tip of the finger of `joint` as the camera sees it, for some samples of joint angles.
class FingertipTracker {
 public:
  FingertipTracker(const HandModel& hand, int joint, int camera, mjData& data)
      : hand_(hand),
        geom_(OutermostGeom(
            hand.model(),
            EndOfChain(hand.model(), hand.model().jnt_bodyid[hand.joints()[joint].joint]))),
        camera_(camera),
        spools_(hand.motor_names().size()),
        data_(data) {}

  bool exists() const { return geom_ >= 0; }

  /// In tangents.
  Point At(const std::vector<double>& joint_angle_rad) {
    SetPosture(hand_, joint_angle_rad, spools_, data_);
    const auto seen = SeenFrom(data_, camera_, PositionOf(data_, geom_));
    return seen ? seen->tangents : Point{kNaN, kNaN};
  }

 private:
  const HandModel& hand_;
  int geom_;
  int camera_;
  std::vector<double> spools_;
  mjData& data_;
};

/// From `from` to `to`, in samples.
FingertipPath PathOf(FingertipTracker& tip, const Signal& angle_rad,
                     const FilteredSignal& jitter_rad, double rate_hz, int from, int to) {
  const int step = std::max(1, static_cast<int>(std::round(rate_hz / kFingertipRate_hz)));
  FingertipPath path = {.first_s = from / rate_hz, .rate_hz = rate_hz / step, .places = {}};
  for (int sample = from; sample < std::min<int>(to, angle_rad.rows()); sample += step) {
    std::vector<double> angles = Row(angle_rad, sample);
    FingertipPath::Place& place = path.places.emplace_back();
    place.tip = place.smooth = tip.At(angles);
    const Eigen::Index row = sample - jitter_rad.first_sample;
    if (row >= 0 && row < jitter_rad.values.rows()) {
      for (std::size_t i = 0; i < angles.size(); ++i) {
        angles[i] -= jitter_rad.values(row, static_cast<Eigen::Index>(i));
      }
      place.smooth = tip.At(angles);
    }
    TrimSignals();
  }
  return path;
}

}  // namespace

DataOfModel MakeData(const HandModel& hand) {
  DataOfModel data(mj_makeData(&hand.model()));
  if (data == nullptr) throw RunError("video: not enough memory for a posture");
  return data;
}

void SetWearer(const VideoInput& input, const HandModel& hand, int sample, mjData& data) {
  SetPosture(hand, Row(*input.true_angle_rad, sample),
             std::vector<double>(hand.motor_names().size()), data);
}

void SetPane(const VideoPane& pane, const HandModel& hand, int sample, mjData& data) {
  if (pane.object_pose != nullptr && pane.object_pose->cols() == 7) {
    SetObjectPose(hand, Row(*pane.object_pose, sample), data);
  }
  SetPosture(hand, Row(*pane.hand_angle_rad, sample), Row(*pane.spool_angle_rad, sample), data);
}

int FingertipPath::IndexAt(double time_s) const {
  const auto index = static_cast<int>(std::lround((time_s - first_s) * rate_hz));
  return std::clamp(index, 0, static_cast<int>(std::ssize(places)) - 1);
}

HandView::HandView(const VideoInput& input, const HandModel& hand, int width_px, int height_px,
                   int inset_px)
    : width_px_(width_px),
      height_px_(height_px),
      inset_px_(inset_px),
      view_(CameraViewOf(input.camera)),
      camera_(FindCamera(hand.model(), view_.camera, width_px < height_px)),
      palm_(mj_name2id(&hand.model(), mjOBJ_BODY, "palm")) {
  fingertips_.resize(input.panes.size());
  const DataOfModel data = MakeData(hand);
  if (!camera_) return;
  bodies_ = BodiesBefore(hand, *camera_);
  window_ = FrameWhatMoves(input, hand, *data);
  FingertipTracker tip(hand, input.joint, *camera_, *data);
  if (!window_ || !tip.exists() || inset_px == 0) return;
  const FrameClock clock(input.rate_hz, input.frames_per_s, input.true_angle_rad->rows(),
                         input.excerpt);
  const int before = static_cast<int>(std::lround(kShownPath_s * input.rate_hz));
  const int from = std::max(0, static_cast<int>(clock.first) - before);
  Fourier fourier;
  for (std::size_t i = 0; i < input.panes.size(); ++i) {
    const Signal& angle_rad = *input.panes[i].hand_angle_rad;
    const FilteredSignal jitter_rad =
        Trembling(angle_rad, input.rate_hz, input.jitter_above_hz, fourier);
    fingertips_[i] =
        PathOf(tip, angle_rad, jitter_rad, input.rate_hz, from, static_cast<int>(clock.end));
  }
}

RendererConfig HandView::RendererOf(const VideoInput& input) const {
  return {.width_px = width_px_,
          .height_px = height_px_,
          .camera = view_.camera,
          .window = window_,
          .supersampling = input.look.supersampling,
          .shadows = input.look.shadows,
          .ground = false,
          .sides = input.look.sides,
          .plain_cables = input.look.plain_cables};
}

RendererConfig HandView::InsetRendererOf(const VideoInput& input) const {
  RendererConfig config = RendererOf(input);
  config.sides *= 2;  // for what is some 100 px wide
  // A square picture of a camera that was chosen for a tall one.
  if (camera_ && width_px_ < height_px_) config.camera_id = camera_;
  config.width_px = config.height_px = inset_px_;
  return config;
}

Point HandView::PalmIn(const mjData& data) const {
  if (palm_ < 0) return {};
  const auto seen = SeenFrom(data, *camera_, std::span<const mjtNum, 3>(data.xpos + 3 * palm_, 3));
  return seen ? seen->tangents : Point{};
}

std::optional<CameraWindow> HandView::WindowAt(const mjData& wearer) const {
  if (!window_) return std::nullopt;
  const Point palm = PalmIn(wearer);
  return CameraWindow{window_->left + palm.x, window_->right + palm.x, window_->bottom + palm.y,
                      window_->top + palm.y};
}

CameraWindow HandView::InsetAround(Point tangents) const {
  const double half = 0.5 * inset_px_ * window_->height() / (height_px_ * kMagnification);
  return {tangents.x - half, tangents.x + half, tangents.y - half, tangents.y + half};
}

std::optional<CameraWindow> HandView::FrameWhatMoves(const VideoInput& input, const HandModel& hand,
                                                     mjData& data) const {
  std::vector<int> shapes = ShapesThatMatter(input, hand, *camera_, bodies_, data);
  KeepFramed(hand, view_.framed, input.joint, shapes);
  if (shapes.empty()) return std::nullopt;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CameraWindow shown = {kInfinity, -kInfinity, kInfinity, -kInfinity};
  Point palm;
  ForPosturesOfAll(input, hand, data, [&](bool of_wearer) {
    if (of_wearer) palm = PalmIn(data);
    for (const int geom : shapes) Include(hand.model(), data, *camera_, geom, palm, shown);
  });
  return WindowAround(shown, width_px_, height_px_);
}

}  // namespace gauntlet::sim
