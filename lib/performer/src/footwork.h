// Plans where the feet stand, and how the legs reach there.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "pleat/skeleton/skeleton.h"

namespace pleat {

// The course that the steps follow, sampled at every frame. A cycle is one step of each foot.
struct Course {
  std::vector<double> cycles;         // cycles of the left foot since the start, rising
  std::vector<double> liveliness;     // 0 standing with both feet .. 1 stepping
  std::vector<Eigen::Vector3d> path;  // way of the hips, body heights; y is not used
  std::vector<double> heading;        // radians about y
  std::vector<double> lift;           // height of the swinging foot, body heights
  // The wanted place of each foot besides its place below the hips, in axes of the heading.
  std::array<std::vector<Eigen::Vector3d>, 2> offsets;
};

struct FootTarget {
  Eigen::Vector3d ankle;  // world, body heights
  double yaw = 0;         // radians about y
  double pitch = 0;       // radians, toes down
};

// Plans both feet (0 left, 1 right) along a course: a foot stands still on its spot for the first
// part of a cycle, below the hips at half of that part, and swings to the next spot for the rest.
// Skeleton and course must outlive this object.
class Footwork {
 public:
  static constexpr double kStance = .62;  // share of a cycle
  // Cycle positions at the start: both feet stand, the right one is about to swing.
  static constexpr std::array<double, 2> kStart = {.12, -.38};

  Footwork(const Skeleton& skeleton, const Course& course, double heel_rise_rad);
  FootTarget At(int side, int t) const;

 private:
  struct Spot {
    Eigen::Vector3d ankle;
    double yaw;
  };
  Spot PlanSpot(int side, int cycle) const;

  const Skeleton& skeleton_;
  const Course& course_;
  double heel_rise_rad_;
  std::array<std::vector<Spot>, 2> spots_;  // by cycle, the first cycle is -1
};

// Rotations of thigh and shin, in the axes of the pelvis, that bring the ankle to `ankle` (relative
// to the hip joint, axes of the pelvis) with the knee bending forward; the nearest reach when it is
// too far. `thigh` and `shin` are vectors of the rest pose: hip to knee and knee to ankle.
struct LegAngles {
  double flexion = 0, abduction = 0, knee = 0;  // radians; abduction about z, towards +x

  Eigen::Quaterniond Thigh() const;
  Eigen::Quaterniond Knee() const;
};
LegAngles SolveLeg(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                   const Eigen::Vector3d& ankle);

}  // namespace pleat
