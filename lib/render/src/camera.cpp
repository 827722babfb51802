#include "pleat/render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pleat {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

}  // namespace

Camera Camera::Fit(const ViewOptions& view, const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  Camera camera;
  camera.view_ = view;
  camera.camera_from_world_ =
      (Eigen::AngleAxisd(view.elevation_degrees * kRadians, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(-view.azimuth_degrees * kRadians, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  const Eigen::Matrix3Xd local = camera.camera_from_world_ * points;
  const Eigen::Vector3d low = local.rowwise().minCoeff(), high = local.rowwise().maxCoeff();
  camera.center_ = camera.camera_from_world_.transpose() * ((low + high) / 2);
  const double free = 1 - 2 * view.margin;
  const Eigen::Vector2d room(free * view.width, free * view.height);
  const Eigen::Vector2d extent = (high - low).head<2>().cwiseMax(1e-9);
  camera.scale_ = room.cwiseQuotient(extent).minCoeff();
  if (view.projection == Projection::kPerspective) {
    // With pixels = focal * x / (distance - z) each point demands a distance at which it stays
    // inside the picture; the largest demand wins. The bounding box bounds the distance from below,
    // so that no point is behind the viewer.
    const double focal = std::min(view.width, view.height) / 2. /
                         std::tan(view.field_of_view_degrees / 2 * kRadians);
    const Eigen::Matrix3Xd centered = local.colwise() - (low + high) / 2;
    double distance = 1e-9;
    for (int i = 0; i < centered.cols(); ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        distance = std::max(
            distance, focal * std::abs(centered(axis, i)) / (room[axis] / 2) + centered(2, i));
      }
    }
    camera.distance_ = std::max(distance, (high - low).norm());
    camera.scale_ = focal / camera.distance_;
  }
  return camera;
}

Eigen::Vector3d Camera::Project(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d local = camera_from_world_ * (world - center_);
  double scale = scale_, depth = -local.z();
  if (view_.projection == Projection::kPerspective) {
    const double away = std::max(distance_ - local.z(), 1e-3 * distance_);
    scale = scale_ * distance_ / away;
    depth = -1 / away;  // linear over the picture plane, as interpolation needs
  }
  return {view_.width / 2. + scale * local.x(), view_.height / 2. - scale * local.y(), depth};
}

}  // namespace pleat
