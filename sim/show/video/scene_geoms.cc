#include "sim/show/video/scene_geoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace gauntlet::sim {
namespace {

template <class Condition>
void RemoveGeoms(mjvScene& scene, const Condition& condition) {
  mjvGeom* end = std::remove_if(scene.geoms, scene.geoms + scene.ngeom, condition);
  scene.ngeom = end - scene.geoms;
}

/// No shape reaches further from its centre: a capsule's length and radius add up.
double BoundingRadius(const mjvGeom& geom) {
  if (geom.type == mjGEOM_PLANE || geom.type == mjGEOM_HFIELD || geom.type == mjGEOM_MESH ||
      geom.type >= mjGEOM_ARROW) {
    return std::numeric_limits<double>::infinity();
  }
  return geom.size[0] + geom.size[1] + geom.size[2];
}

/// Everything within an angle around the direction of the view.
struct Cone {
  std::array<double, 3> apex;
  std::array<double, 3> axis;
  double slope;  // tangent of that angle

  bool Touches(const mjvGeom& geom) const {
    double along = 0.0, square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double difference = geom.pos[i] - apex[i];
      along += difference * axis[i];
      square += difference * difference;
    }
    const double aside = std::sqrt(std::max(0.0, square - along * along));
    return aside <= slope * along + BoundingRadius(geom) * std::hypot(1.0, slope);
  }
};

void ColourCable(mjvGeom& geom, float share) {
  constexpr std::array<float, 3> kSlack = {1.0f, 1.0f, 1.0f};
  constexpr std::array<float, 3> kPullsLittle = {0.45f, 0.38f, 0.20f};
  constexpr std::array<float, 3> kPullsMost = {0.95f, 0.25f, 0.10f};
  const float pull = std::min(share, 1.0f);
  for (int i = 0; i < 3; ++i) {
    geom.rgba[i] =
        pull > 0.0f ? std::lerp(kPullsLittle[i], kPullsMost[i], std::sqrt(pull)) : kSlack[i];
  }
}

void ColourLink(mjvGeom& geom, float share, const Color& full) {
  const double parts[] = {full.red, full.green, full.blue};
  for (int i = 0; i < 3; ++i) {
    geom.rgba[i] = std::lerp(geom.rgba[i], static_cast<float>(parts[i]), share);
  }
}

}  // namespace

void RemovePlanes(mjvScene& scene) {
  RemoveGeoms(scene, [](const mjvGeom& geom) { return geom.type == mjGEOM_PLANE; });
}

void FlattenCables(mjvScene& scene) {
  constexpr float kHalfSide = 0.886f;  // of a square of the same area as a circle of radius 1
  for (mjvGeom& geom : std::span(scene.geoms, scene.ngeom)) {
    if (geom.objtype != mjOBJ_TENDON || geom.type != mjGEOM_CAPSULE) continue;
    geom.type = mjGEOM_BOX;
    geom.size[0] *= kHalfSide;
    geom.size[1] *= kHalfSide;
  }
}

void ColourScene(mjvScene& scene, const mjModel& model, const SceneColours& colours) {
  for (mjvGeom& geom : std::span(scene.geoms, scene.ngeom)) {
    if (geom.objtype == mjOBJ_TENDON && geom.objid < std::ssize(colours.cable_share)) {
      ColourCable(geom, colours.cable_share[geom.objid]);
    } else if (geom.objtype == mjOBJ_GEOM && !colours.link_share.empty()) {
      ColourLink(geom, colours.link_share[model.geom_bodyid[geom.objid]], colours.link);
    }
  }
}

void KeepBodies(mjvScene& scene, const mjModel& model, const std::vector<bool>& chosen) {
  RemoveGeoms(scene, [&](const mjvGeom& geom) {
    return geom.objtype != mjOBJ_GEOM || !chosen[model.geom_bodyid[geom.objid]];
  });
}

void ShowWindow(mjvScene& scene, const CameraWindow& window) {
  for (mjvGLCamera& eye : scene.camera) {
    eye.frustum_center = static_cast<float>(0.5 * (window.left + window.right)) * eye.frustum_near;
    eye.frustum_bottom = static_cast<float>(window.bottom) * eye.frustum_near;
    eye.frustum_top = static_cast<float>(window.top) * eye.frustum_near;
  }
}

void WidenView(mjvScene& scene, double factor) {
  for (mjvGLCamera& eye : scene.camera) {
    eye.frustum_top *= static_cast<float>(factor);
    eye.frustum_bottom *= static_cast<float>(factor);
  }
}

void RemoveOutOfSight(mjvScene& scene, int width_px, int height_px) {
  const auto& [left, right] = scene.camera;  // two eyes, a little apart
  // Of the corner that is furthest from the axis.
  const double half_height = 0.5 * (left.frustum_top - left.frustum_bottom);
  const double up = std::max<double>(std::abs(left.frustum_top), std::abs(left.frustum_bottom));
  const double aside = std::abs(left.frustum_center) + half_height * width_px / height_px;
  Cone cone = {.apex = {}, .axis = {}, .slope = std::hypot(up, aside) / left.frustum_near};
  for (int i = 0; i < 3; ++i) {
    cone.apex[i] = 0.5 * (left.pos[i] + right.pos[i]);
    cone.axis[i] = left.forward[i];
  }
  RemoveGeoms(scene, [&cone](const mjvGeom& geom) { return !cone.Touches(geom); });
}

}  // namespace gauntlet::sim
