#include "pleat/rigging/facing_evidence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pleat/math/rigid.h"
#include "pleat/rigging/bone_visibility.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Shares of the lower leg's length, from the knee: the stretch whose center gives its line, and
// where the foot begins.
constexpr double kShankBegin = .5, kShankEnd = .85, kFootBegin = .97;
constexpr int kMinBoneVertices = 12;
constexpr Eigen::Index kEnoughVertices = 20'000;  // of a whole body, to follow the legs

struct Leg {
  int hip, knee, ankle, toes;
};
constexpr Leg kLegs[2] = {{kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, kLeftToes},
                          {kRightUpperLeg, kRightLowerLeg, kRightFoot, kRightToes}};

// Returns the nearest bone of every `stride`th vertex, -1 for the others.
std::vector<int> BonesOfVertices(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& joints,
                                 Eigen::Index stride = 1) {
  std::vector<int> bones(positions.cols(), -1);
  for (Eigen::Index v = 0; v < positions.cols(); v += stride) {
    bones[v] = FindNearestBones(HumanTemplate(), joints, positions.col(v)).bones[0];
  }
  return bones;
}

// An area-weighted mean of points.
struct Centroid {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  void Add(const Eigen::Vector3d& point, double weight) {
    sum += weight * point;
    area += weight;
  }
  Eigen::Vector3d mean() const { return sum / area; }
};

// Returns how far the foot's center lies before the line from the knee through the lower leg, in
// meters; 0 without a foot.
double FootOffset(const BodyShell& shell, const std::vector<int>& bones,
                  const FacingHypothesis& hypothesis, const Leg& leg) {
  const Eigen::Vector3d knee = hypothesis.joints.col(leg.knee);
  const Eigen::Vector3d shank = Eigen::Vector3d(hypothesis.joints.col(leg.ankle)) - knee;
  const double length = shank.norm();
  if (!(length > 0)) return 0;
  Centroid lower, foot;
  for (Eigen::Index f = 0; f < shell.triangles.cols(); ++f) {
    const Eigen::Vector3i corners = shell.triangles.col(f);
    const int bone = bones[corners[0]];
    // Bones are named after the joint in which they end: the bone of the ankle is the lower leg.
    if (bone != leg.ankle && bone != leg.toes) continue;
    const Eigen::Vector3d a = shell.positions.col(corners[0]);
    const Eigen::Vector3d b = shell.positions.col(corners[1]);
    const Eigen::Vector3d c = shell.positions.col(corners[2]);
    const Eigen::Vector3d center = (a + b + c) / 3;
    const double area = (b - a).cross(c - a).norm();
    const double along = (center - knee).dot(shank) / (length * length);
    if (along > kFootBegin) {
      foot.Add(center, area);
    } else if (along > kShankBegin && along < kShankEnd) {
      lower.Add(center, area);
    }
  }
  if (!(lower.area > 0 && foot.area > 0)) return 0;
  const Eigen::Vector3d line = lower.mean() - knee;
  const double slope = line.dot(shank);
  if (!(slope > 0)) return 0;
  const Eigen::Vector3d below =
      lower.mean() + line * ((foot.mean() - lower.mean()).dot(shank) / slope);
  // Forward as the leg sees it: a leg that is raised forward carries its toes upward.
  const Eigen::Vector3d forward =
      Eigen::Quaterniond::FromTwoVectors(-hypothesis.up, shank) * hypothesis.forward;
  return forward.dot(foot.mean() - below);
}

// Returns the columns of the vertices whose bone is `bone`.
std::vector<int> VerticesOf(const std::vector<int>& bones, int bone) {
  std::vector<int> vertices;
  for (size_t v = 0; v < bones.size(); ++v) {
    if (bones[v] == bone) vertices.push_back(static_cast<int>(v));
  }
  return vertices;
}

Eigen::Matrix3d RotationOf(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& frame,
                           const std::vector<int>& vertices) {
  const Eigen::Matrix3Xd source = rest(Eigen::all, vertices), target = frame(Eigen::all, vertices);
  const absl::StatusOr<RigidTransform> motion = FitRigidTransform(source, target);
  return motion.ok() ? motion->rotation : Eigen::Matrix3d::Identity();
}

// Returns the mean sine of the bend of both knees, positive where the lower leg goes back as a
// knee's does.
double MeanKneeBend(const MeshSequence& sequence, const Eigen::Matrix3Xd& rest,
                    const std::vector<int>& bones, const FacingHypothesis& hypothesis,
                    int max_frames) {
  const Eigen::Vector3d left = hypothesis.up.cross(hypothesis.forward);
  const int num_frames = std::clamp(max_frames, 1, sequence.num_frames());
  double sum = 0;
  for (const Leg& leg : kLegs) {
    const std::vector<int> thigh = VerticesOf(bones, leg.knee),
                           shank = VerticesOf(bones, leg.ankle);
    if (std::min(thigh.size(), shank.size()) < kMinBoneVertices) continue;
    const Eigen::Vector3d knee = hypothesis.joints.col(leg.knee);
    const Eigen::Vector3d thigh_direction = (knee - hypothesis.joints.col(leg.hip)).normalized();
    const Eigen::Vector3d shank_direction =
        (Eigen::Vector3d(hypothesis.joints.col(leg.ankle)) - knee).normalized();
    for (int k = 0; k < num_frames; ++k) {
      const int t = static_cast<int>(static_cast<int64_t>(k) * sequence.num_frames() / num_frames);
      const Eigen::Matrix3Xd frame = sequence.FrameAsDouble(t);
      const Eigen::Matrix3d thigh_turn = RotationOf(rest, frame, thigh);
      const Eigen::Matrix3d shank_turn = RotationOf(rest, frame, shank);
      const Eigen::Vector3d axis =
          (thigh_turn * thigh_direction).cross(shank_turn * shank_direction);
      sum += axis.dot(thigh_turn * left);
    }
  }
  return sum / (2 * num_frames);
}

double Clip(double value) { return std::clamp(value, -1.0, 1.0); }

}  // namespace

FacingEvidence WeighFacing(const MeshSequence& sequence, const BodyShell& shell,
                           const FacingHypothesis& hypothesis,
                           const FacingEvidenceOptions& options) {
  const Eigen::RowVectorXd heights = hypothesis.up.transpose() * hypothesis.joints;
  const double height = std::max(heights.maxCoeff() - heights.minCoeff(), 1e-300);
  FacingEvidence evidence;
  const std::vector<int> shell_bones = BonesOfVertices(shell.positions, hypothesis.joints);
  for (const Leg& leg : kLegs) {
    evidence.feet += 0.5 * Clip(FootOffset(shell, shell_bones, hypothesis, leg) /
                                (height * options.sure_foot_offset));
  }
  // In the rest frame itself the knees bend as the template does, so they say nothing.
  if (sequence.num_frames() == 1) return evidence;
  const Eigen::Matrix3Xd rest = sequence.FrameAsDouble(hypothesis.frame);
  const Eigen::Index stride = std::max<Eigen::Index>(1, rest.cols() / kEnoughVertices);
  const std::vector<int> bones = BonesOfVertices(rest, hypothesis.joints, stride);
  evidence.knees = Clip(MeanKneeBend(sequence, rest, bones, hypothesis, options.max_frames) /
                        options.sure_knee_bend);
  return evidence;
}

}  // namespace pleat
