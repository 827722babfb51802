#include "pleat/formats/joint_clip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string_view>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

struct Unit {
  std::string_view name;
  double meters;
};
// Those that tools write. The unit of the files of CMU is 1 / 0.45 inches, as in its Acclaim files.
constexpr std::array<Unit, 7> kUnits = {{{"meters", 1},
                                         {"decimeters", .1},
                                         {"centimeters", .01},
                                         {"millimeters", .001},
                                         {"inches", .0254},
                                         {"feet", .3048},
                                         {"units of 1/0.45 inches", .0254 / .45}}};
constexpr double kUnitTolerance = .005;
// From the tip of a hand to the tip of a toe along the bones, of an adult of 1.7 m. Measured on the
// skeletons of CMU, Mixamo and the template: 2.1 to 2.5 m.
constexpr double kTipToTip_m = 2.3;

// The root counts as branching: it has a rotation of its own, and so have the bones that begin
// there.
bool NeedsBoneJoints(const Skeleton& skeleton, int joint) {
  return joint == 0 || skeleton.children(joint).size() > 1;
}

}  // namespace

int JointClip::FindJoint(const std::string& name) const {
  for (size_t j = 0; j < joints.size(); ++j) {
    if (!joints[j].is_end && joints[j].name == name) return static_cast<int>(j);
  }
  return -1;
}

Eigen::Matrix3Xd JointClip::RestPositions() const {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(joints.size()));
  for (size_t j = 0; j < joints.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    positions.col(column) = joints[j].offset;
    if (joints[j].parent >= 0) positions.col(column) += positions.col(joints[j].parent);
  }
  return positions;
}

void PlaceJoints(const JointClip& clip, size_t frame, PlacedJoints* placed) {
  const size_t num_joints = clip.num_joints(), first = frame * num_joints;
  placed->rotations.resize(num_joints);
  placed->positions.resize(3, static_cast<Eigen::Index>(num_joints));
  for (size_t j = 0; j < num_joints; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const int parent = clip.joints[j].parent;
    placed->rotations[j] = clip.rotations[first + j];
    placed->positions.col(column) = clip.translations[first + j];
    if (parent < 0) continue;
    const Eigen::Quaterniond& above = placed->rotations[static_cast<size_t>(parent)];
    placed->positions.col(column) =
        placed->positions.col(parent) + above * clip.translations[first + j];
    placed->rotations[j] = above * clip.rotations[first + j];
  }
}

std::vector<ExportJoint> MakeExportJoints(const Skeleton& skeleton) {
  std::vector<ExportJoint> joints;
  std::vector<int> export_of(static_cast<size_t>(skeleton.num_joints()), -1);
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    const Eigen::Vector3d& position = skeleton.rest_position(j);
    int parent = -1;
    if (j > 0) {
      const int begin = skeleton.parent(j);
      parent = export_of[static_cast<size_t>(begin)];
      if (NeedsBoneJoints(skeleton, begin)) {
        std::string name = absl::StrCat(skeleton.joint(j).name, "_bone");
        while (skeleton.FindJoint(name) >= 0) name += '_';
        joints.push_back({std::move(name), parent, skeleton.rest_position(begin), -1, j});
        parent = static_cast<int>(joints.size()) - 1;
      }
    }
    export_of[static_cast<size_t>(j)] = static_cast<int>(joints.size());
    int bone = j == 0 ? 0 : -1;
    if (!NeedsBoneJoints(skeleton, j) && !skeleton.children(j).empty()) {
      bone = skeleton.children(j)[0];
    }
    joints.push_back({skeleton.joint(j).name, parent, position, j, bone});
  }
  return joints;
}

std::vector<int> TurningJoints(const std::vector<ExportJoint>& joints) {
  std::vector<int> turning;
  for (size_t e = 0; e < joints.size(); ++e) {
    if (joints[e].turning_bone < 0) continue;
    const auto bone = static_cast<size_t>(joints[e].turning_bone);
    if (turning.size() <= bone) turning.resize(bone + 1, -1);
    turning[bone] = static_cast<int>(e);
  }
  return turning;
}

JointClip ClipFromPoses(const Skeleton& skeleton, const PoseTrack& track) {
  assert(track.num_frames() == 0 || CheckJointCount(track, skeleton.num_joints()).ok());
  const std::vector<ExportJoint> joints = MakeExportJoints(skeleton);
  JointClip clip;
  for (const ExportJoint& joint : joints) {
    Eigen::Vector3d offset = joint.rest_position;
    if (joint.parent >= 0) offset -= joints[static_cast<size_t>(joint.parent)].rest_position;
    clip.joints.push_back({joint.name, joint.parent, offset});
  }
  if (track.num_frames() > 0) clip.fps = track.fps();
  std::vector<Pose> rest;
  if (track.num_frames() == 0) rest.push_back(Pose::Rest(skeleton));
  for (const Pose& pose : track.num_frames() == 0 ? rest : track.poses()) {
    for (size_t e = 0; e < joints.size(); ++e) {
      const int bone = joints[e].turning_bone;
      clip.rotations.push_back(bone < 0 ? Eigen::Quaterniond::Identity()
                                        : pose.rotations[static_cast<size_t>(bone)]);
      clip.translations.push_back(e == 0 ? pose.root_position : clip.joints[e].offset);
    }
  }
  return clip;
}

std::string UnitName(double meters, double* unit_m) {
  for (const Unit& unit : kUnits) {
    if (std::abs(meters / unit.meters - 1) > kUnitTolerance) continue;
    if (unit_m != nullptr) *unit_m = unit.meters;
    return std::string(unit.name);
  }
  return "";
}

UnitGuess GuessUnit(const JointClip& clip) {
  // The two longest ways down from each joint, from the tips upwards.
  std::vector<double> longest(clip.num_joints(), 0);
  double size = 0;
  for (size_t j = clip.num_joints(); j-- > 0;) {
    const int parent = clip.joints[j].parent;
    if (parent < 0) continue;
    double& above = longest[static_cast<size_t>(parent)];
    const double way = longest[j] + clip.joints[j].offset.norm();
    size = std::max(size, above + way);
    above = std::max(above, way);
  }
  UnitGuess guess{.name = std::string(kUnits[0].name), .unit_m = 1, .size = size};
  if (!(size > 0) || !std::isfinite(size)) return guess;
  const auto misfit = [&](double meters) {
    return std::abs(std::log(size * meters / kTipToTip_m));
  };
  for (const Unit& unit : kUnits) {
    if (misfit(unit.meters) >= misfit(guess.unit_m)) continue;
    guess.name = std::string(unit.name);
    guess.unit_m = unit.meters;
  }
  return guess;
}

}  // namespace pleat
