// Cameras fitted to what they show.
#pragma once

#include <Eigen/Core>
#include <span>

namespace pleat {

enum class Projection { kOrthographic, kPerspective };

struct ViewOptions {
  int width = 512, height = 512;  // pixels, 16 .. 8192
  Projection projection = Projection::kPerspective;
  double azimuth_degrees = 0;    // 0 looks at the side that faces +z, 90 at the one that faces +x
  double elevation_degrees = 8;  // camera above the horizon, -90 .. 90
  double field_of_view_degrees = 28;  // perspective: of the shorter side
  double margin = .05;                // free border, share of the picture
};

// Maps world points to pixels (x right, y down) and depth (smaller is nearer).
class Camera {
 public:
  // Returns a camera in the direction of `view` that shows all of `points` (3 x N, N > 0, meters).
  static Camera Fit(const ViewOptions& view, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

  const ViewOptions& view() const { return view_; }
  Eigen::Vector3d Project(const Eigen::Vector3d& world) const;
  // Turns a direction of the world into camera axes (x right, y up, z towards the viewer).
  const Eigen::Matrix3d& camera_from_world() const { return camera_from_world_; }

 private:
  ViewOptions view_;
  Eigen::Matrix3d camera_from_world_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();  // world, shown in the middle
  double distance_ = 1;                               // perspective: viewer to center, meters
  double scale_ = 1;                                  // pixels per meter at the center
};

}  // namespace pleat
