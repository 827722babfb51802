// A motion as the joints of other programs' files have it
// (docs/formats/motion.md#joints-of-other-files): a hierarchy with one rotation for each joint,
// which turns all that hangs below. BVH, the skins of glTF and UsdSkel are written from it, and BVH
// and glTF are read into it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// What a clip takes in memory is bounded by this product of frames and joints.
inline constexpr int64_t kMaxJointFrames = 8'000'000;
inline constexpr int kMaxClipJoints = 4096;

struct ClipJoint {
  std::string name;
  int parent = -1;  // an index below the joint's own; -1 for a root
  // Where the joint rests relative to its parent, or in the world for a root, in units of the clip.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  bool is_end = false;  // the tip of the joint above, which has no motion (End Site of BVH)
};

// At rest all joints have the axes of the world. Whoever makes a clip keeps the sizes of its lists.
struct JointClip {
  std::vector<ClipJoint> joints{};  // J, parents before children; there may be several roots
  double fps = 30;
  // T x J, frame by frame: the rotation of each joint relative to its parent, the identity at rest,
  // and its place relative to the parent in the parent's axes, the offset at rest.
  std::vector<Eigen::Quaterniond> rotations{};
  std::vector<Eigen::Vector3d> translations{};

  size_t num_joints() const { return joints.size(); }
  size_t num_frames() const { return joints.empty() ? 0 : rotations.size() / joints.size(); }
  // Returns the first joint with this name that is no end, or -1.
  int FindJoint(const std::string& name) const;
  Eigen::Matrix3Xd RestPositions() const;  // 3 x J, in the world
};

// Where all joints of a frame are in the world: a point x that moves with joint j is at
// rotations[j] (x - rest position of j) + positions.col(j).
struct PlacedJoints {
  std::vector<Eigen::Quaterniond> rotations;  // J
  Eigen::Matrix3Xd positions;                 // 3 x J
};
void PlaceJoints(const JointClip& clip, size_t frame, PlacedJoints* placed);

// The joints that other programs need to show a character of Pleat. All of its own joints are
// there with their names. A Pleat bone turns about the joint in which it begins, so where several
// bones begin in one joint, and at the root, which turns by itself, each bone has a joint of its
// own there: "<name of the joint that it ends in>_bone".
struct ExportJoint {
  std::string name;
  int parent = -1;
  Eigen::Vector3d rest_position;  // meters, world
  int joint = -1;                 // of the skeleton; -1 for the joint of a bone
  int turning_bone = -1;          // whose rotation of a pose it has; -1 for one that never turns
};
std::vector<ExportJoint> MakeExportJoints(const Skeleton& skeleton);
// The export joint that has the rotation of each bone: J entries, of which entry 0 is the root.
std::vector<int> TurningJoints(const std::vector<ExportJoint>& joints);

// Returns the poses with the joints of MakeExportJoints, in meters; of an empty track the rest
// pose. `track` must be empty or have the joints of the skeleton (asserted).
JointClip ClipFromPoses(const Skeleton& skeleton, const PoseTrack& track);

// The unit in which a skeleton is as large as a person, of those that packages write.
struct UnitGuess {
  std::string name;   // "centimeters"
  double unit_m = 1;  // meters per unit
  double size = 0;    // the longest way from tip to tip through the hierarchy, in units
};
UnitGuess GuessUnit(const JointClip& clip);
// The name of a unit that `meters` is within half a percent of, or an empty text. *unit_m, which
// may be null, becomes the unit itself.
std::string UnitName(double meters, double* unit_m = nullptr);

}  // namespace pleat
