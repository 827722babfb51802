// The skirt as cloth: a ring of strands simulated in time, in units of body height.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "character_shape.h"
#include "pleat/base/progress.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// The lookup of one surface point in the grid of particles: value = sum_i weights[i] *
// grid[ids[i]].
struct SkirtSample {
  std::array<int, 16> ids{};
  std::array<float, 16> weights{};
};

// Particles on the bell, theta x s. Their displacement from the skinned bell is the skirt's detail.
// The shape must outlive this object.
class SkirtDynamics {
 public:
  static constexpr int kNumStrands = 72, kNumRings = 15;
  // At the hem, body heights; only a leg pushes farther.
  static constexpr double kMaxDisplacement = .15;

  explicit SkirtDynamics(const CharacterShape& shape);

  // Returns the displacements of all particles per frame, 3 x (kNumRings * kNumStrands), in world
  // axes. gravity: in body heights per second squared. Only kCancelled is an error.
  absl::StatusOr<std::vector<Eigen::Matrix3Xf>> Simulate(const PoseTrack& track, double gravity,
                                                         const Progress& progress);

  // Returns the bicubic lookup at a surface point of the rest shape.
  SkirtSample Locate(const Eigen::Vector3d& rest_point) const;

 private:
  struct Link {  // distance constraint
    int a, b;
    double rest_length, compliance;
  };
  struct Capsule {
    Eigen::Vector3d a, b;
    double radius;
  };
  struct Surroundings {        // what drives the particles at one instant
    Eigen::Matrix3Xd targets;  // 3 x P, the skinned bell
    Eigen::Matrix3Xd target_velocities;
    std::vector<Capsule> legs;
    Eigen::Matrix3Xd forces;  // 3 x P, per mass: gravity less what holds the rest shape
  };

  static int Id(int ring, int strand) {
    return ring * kNumStrands + (strand + kNumStrands) % kNumStrands;
  }
  void AddLink(int a, int b, double compliance);
  void MeasureSurroundings(const Pose& pose, double gravity, Surroundings* out) const;
  void Step(const Surroundings& now, double step_s);
  void Collide(const std::vector<Capsule>& legs);

  const CharacterShape& shape_;
  Eigen::Matrix3Xd rest_;             // 3 x P
  Eigen::Matrix3Xd strand_tangents_;  // 3 x P, rest shape, downward
  Eigen::MatrixXd bone_weights_;      // num_joints x P
  std::vector<double> share_of_way_;  // per particle: s, 0 at the waist (pinned) .. 1
  std::vector<Link> links_;
  Eigen::Matrix3Xd positions_, velocities_;  // 3 x P
};

}  // namespace pleat
