#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// A place and a direction, relative to a body: position [m], quaternion (w, x, y, z).
struct Frame {
  std::array<double, 3> position_m = {0, 0, 0};
  std::array<double, 4> rotation = {1, 0, 0, 0};
};

/// All that is needed to draw a hand in any posture without the physics engine: bodies that hang on
/// each other, hinges, shapes and the ways of cables. Bodies are numbered as in the compiled model,
/// parents first; 0 is the world. Drums and what else no joint angle tells stand as in the model.
struct HandShapes {
  struct Body {
    int parent = 0;
    Frame frame;  // relative to the parent's, with all hinges at their zero
  };

  /// Turns its body by `angle - zero_rad` about `axis` through `position_m`, both relative to the
  /// body. The angle is that of a joint, or, with coefficients, of one that follows a joint:
  /// zero_rad + sum over k of coefficient[k] (joint - leader_zero_rad)^k.
  struct Hinge {
    int body = 0;
    int joint = 0;  // of HandModel::joint_names()
    std::array<double, 3> position_m = {0, 0, 0};
    std::array<double, 3> axis = {0, 0, 1};
    double zero_rad = 0.0;
    double leader_zero_rad = 0.0;
    std::vector<double> coefficient;  // empty: the joint itself
  };

  enum class Form { kSphere, kCapsule, kEllipsoid, kCylinder, kBox, kMesh };
  struct Shape {
    int body = 0;
    Form form = Form::kSphere;
    std::array<double, 3> size_m = {0, 0, 0};  // as MuJoCo's geom_size
    Frame frame;
    std::array<float, 4> rgba = {0, 0, 0, 1};
    int mesh = -1;  // of kMesh
  };
  struct Mesh {
    std::vector<float> vertex_m;  // 3 each
    std::vector<int> triangle;    // 3 vertices each
  };

  /// A point that a cable passes, or a round pulley between two points around which it may lie.
  struct CablePoint {
    int body = 0;
    Frame frame;  // a pulley's axis is z
    double radius_m = 0.0;
    bool is_sphere = false;
    /// Side of a pulley on which the cable lies: a place relative to a body.
    struct Side {
      int body = 0;
      std::array<double, 3> position_m = {0, 0, 0};
    };
    std::optional<Side> side;
  };
  struct Cable {
    std::array<float, 4> rgba = {0, 0, 0, 1};
    double width_m = 0.0;
    std::vector<CablePoint> points;
  };

  struct Camera {
    int body = 0;
    Frame frame;  // looks along -z, y is up
    double height_deg = 45.0;
  };

  std::vector<Body> bodies;
  std::vector<Hinge> hinges;
  std::vector<Shape> shapes;
  std::vector<Mesh> meshes;
  std::vector<Cable> cables;
  std::optional<Camera> camera;
  int object_body = -1;  // what a hand may hold, with a pose of its own; -1: nothing
};

/// Shapes that MuJoCo draws of the model by default, without planes. `camera`: a name of the model;
/// none if it does not have it.
HandShapes ShapesOf(const HandModel& hand, const std::string& camera);

}  // namespace gauntlet::sim
