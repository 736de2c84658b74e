#include "sim/show/pages/replay_data.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/json.h"
#include "sim/hand/camera_view.h"
#include "sim/hand/hand_shapes.h"
#include "sim/show/pages/curve_codec.h"

namespace gauntlet::sim {
namespace {

constexpr double kObjectRate_hz = 50.0;
constexpr double kObjectStep = 1e-4;  // of positions [m] and of the numbers of a quaternion

/// Ten micrometres, and as little of a direction.
constexpr double kDigits = 1e5;

template <class Numbers>
Json Rounded(const Numbers& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(std::round(value * kDigits) / kDigits + 0.0);
  return json;
}

Json FrameJson(const Frame& frame) {
  Json json = Rounded(frame.position_m);
  for (const double part : frame.rotation) json.push_back(std::round(part * 1e7) / 1e7 + 0.0);
  return json;
}

Json HingeJson(const HandShapes::Hinge& hinge) {
  Json json = {{"body", hinge.body},
               {"joint", hinge.joint},
               {"at", Rounded(hinge.position_m)},
               {"axis", hinge.axis},
               {"zero_deg", hinge.zero_rad * kDegPerRad}};
  if (hinge.coefficient.empty()) return json;
  json["leader_zero_rad"] = hinge.leader_zero_rad;
  json["coefficient"] = hinge.coefficient;
  return json;
}

Json ShapeJson(const HandShapes::Shape& shape) {
  static constexpr std::string_view kForms[] = {"sphere",   "capsule", "ellipsoid",
                                                "cylinder", "box",     "mesh"};
  Json json = {{"body", shape.body},
               {"form", kForms[static_cast<std::size_t>(shape.form)]},
               {"size", Rounded(shape.size_m)},
               {"frame", FrameJson(shape.frame)},
               {"rgba", Rounded(shape.rgba)}};
  if (shape.mesh >= 0) json["mesh"] = shape.mesh;
  return json;
}

Json CableJson(const HandShapes::Cable& cable) {
  Json points = Json::array();
  for (const HandShapes::CablePoint& point : cable.points) {
    Json json = {{"body", point.body}, {"frame", FrameJson(point.frame)}};
    if (point.radius_m > 0.0) json["radius"] = point.radius_m;
    if (point.is_sphere) json["sphere"] = true;
    if (point.side) {
      json["side"] = {{"body", point.side->body}, {"at", Rounded(point.side->position_m)}};
    }
    points.push_back(std::move(json));
  }
  return {{"rgba", Rounded(cable.rgba)}, {"width", cable.width_m}, {"points", std::move(points)}};
}

Json ShapesJson(const HandShapes& shapes) {
  Json json = {{"bodies", Json::array()}, {"hinges", Json::array()}, {"shapes", Json::array()},
               {"meshes", Json::array()}, {"cables", Json::array()}, {"camera", nullptr}};
  for (const HandShapes::Body& body : shapes.bodies) {
    json["bodies"].push_back({{"parent", body.parent}, {"frame", FrameJson(body.frame)}});
  }
  for (const auto& hinge : shapes.hinges) json["hinges"].push_back(HingeJson(hinge));
  for (const auto& shape : shapes.shapes) json["shapes"].push_back(ShapeJson(shape));
  for (const HandShapes::Mesh& mesh : shapes.meshes) {
    json["meshes"].push_back({{"vertex", Rounded(mesh.vertex_m)}, {"triangle", mesh.triangle}});
  }
  for (const auto& cable : shapes.cables) json["cables"].push_back(CableJson(cable));
  if (shapes.camera) {
    json["camera"] = {{"body", shapes.camera->body},
                      {"frame", FrameJson(shapes.camera->frame)},
                      {"height_deg", shapes.camera->height_deg}};
  }
  return json;
}

Json HandJson(const HandShapes& shapes, const HandModel& hand) {
  Json json = ShapesJson(shapes);
  json["joints"] = hand.joint_names();
  return json;
}

/// Mean of each joint [deg].
std::vector<double> MeansOf(const Signal& angle_rad) {
  std::vector<double> means;
  for (Eigen::Index joint = 0; joint < angle_rad.cols(); ++joint) {
    means.push_back(angle_rad.col(joint).mean() * kDegPerRad);
    TrimSignals();
  }
  return means;
}

/// The seven numbers of a pose, each as a curve of every `stride`-th sample.
Json PoseCurves(const Signal& pose, Eigen::Index stride) {
  Json curves = Json::array();
  for (Eigen::Index column = 0; column < pose.cols(); ++column) {
    std::vector<double> values;
    for (Eigen::Index row = 0; row < pose.rows(); row += stride) {
      values.push_back(pose(row, column));
    }
    curves.push_back(EncodeCurve(values, kObjectStep));
  }
  return curves;
}

}  // namespace

Json HandData(const HandModel& hand, const std::string& camera) {
  return HandJson(ShapesOf(hand, camera), hand);
}

Json ReplayData(const FinishedStudy& finished) {
  const Study& study = finished.study;
  const std::vector<Trace>& traces = finished.result.first_traces;
  if (study.hand == nullptr || traces.empty()) return nullptr;
  const HandShapes shapes = ShapesOf(*study.hand, CameraViewOf(study.scenario.video.camera).camera);
  Json json = HandJson(shapes, *study.hand);
  json["held_deg"]["wearer"] = Rounded(MeansOf(finished.result.first_reference_rad));
  for (const Trace& trace : traces) {
    json["held_deg"]["controllers"].push_back(Rounded(MeansOf(trace.hand_angle_rad)));
  }
  json["object"] = nullptr;
  if (shapes.object_body < 0) return json;
  const double rate_hz = finished.result.first_glove->tick_rate_hz;
  const auto stride = std::max<Eigen::Index>(1, std::llround(rate_hz / kObjectRate_hz));
  json["object"] = {{"body", shapes.object_body},
                    {"rate_hz", rate_hz / static_cast<double>(stride)},
                    {"step", kObjectStep}};
  for (const Trace& trace : traces) {
    json["object"]["controllers"].push_back(PoseCurves(trace.object_pose, stride));
  }
  return json;
}

}  // namespace gauntlet::sim
