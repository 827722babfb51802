// The performer's rest shape as an implicit surface, in units of body height (floor y = 0).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "pleat/skeleton/skeleton.h"

namespace pleat {

// A solid of which Distance() is negative inside: either a tapered capsule (axis a-b) or an
// ellipsoid around `a` with half axes `radii` along the columns of `axes`.
struct ShapePart {
  enum class Kind { kCapsule, kEllipsoid } kind;
  Eigen::Vector3d a, b;
  double radius_a = 0, radius_b = 0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d radii = Eigen::Vector3d::Ones();
  double blend = .01;  // width of the smooth union with the parts before it

  double Distance(const Eigen::Vector3d& p) const;
};

// The bell of the skirt. theta = atan2(x, z - center_z), s = 0 at the waist .. 1 at the hem.
struct SkirtShape {
  double waist_y = .605, hem_y = .335, center_z = -.010;
  Eigen::Vector2d waist_radii{.074, .060}, hem_radii{.165, .155};  // x, z
  double bell = .75;  // exponent of the flare along s: under 1 swells at the hips
  int num_folds = 9;
  double fold_phase = 0, fold_depth = .045;

  double Fraction(double y) const { return (waist_y - y) / (waist_y - hem_y); }  // s, not clamped
  double Radius(double theta, double s) const;
  Eigen::Vector3d Point(double theta, double s) const;
  double Distance(const Eigen::Vector3d& p) const;
};

// The parts of the surface that differ in how they are skinned.
enum class BodyRegion { kTorso, kLeftArm, kRightArm, kLeftLeg, kRightLeg, kSkirt };

class CharacterShape {
 public:
  explicit CharacterShape(uint64_t character_seed);

  const Skeleton& skeleton() const { return skeleton_; }
  const SkirtShape& skirt() const { return skirt_; }

  // Approximate signed distance to the whole surface.
  double Distance(const Eigen::Vector3d& p) const;
  // The distance to one region alone.
  double RegionDistance(BodyRegion region, const Eigen::Vector3d& p) const;
  BodyRegion NearestRegion(const Eigen::Vector3d& p) const;
  // The distance to both legs, without the skirt.
  double LegDistance(const Eigen::Vector3d& p) const;
  // Returns how much of the skirt's displacement a surface point takes, 0..1: 1 on the bell,
  // falling to 0 along its underside towards the legs.
  double SkirtShare(const Eigen::Vector3d& p) const;
  // Returns the wanted edge length relative to the torso's: finer on head, arms and legs.
  double RelativeEdgeLength(const Eigen::Vector3d& p) const;

  struct Box {
    Eigen::Vector3d low, high;
  };
  Box bounds() const { return {{-.40, -.03, -.25}, {.40, 1.04, .25}}; }

 private:
  void AddTorso(double girth);
  void AddArm(int side, double girth);  // side 0 left, 1 right
  void AddLeg(int side, double girth);

  Skeleton skeleton_;
  SkirtShape skirt_;
  std::array<std::vector<ShapePart>, 5> parts_;  // by BodyRegion, without the skirt
};

}  // namespace pleat
