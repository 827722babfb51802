#include "rest_alignment.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "blending.h"
#include "pleat/math/rotations.h"

namespace pleat {
namespace {

// A body stands whose trunk and legs are no further from upright than this.
constexpr double kMaxTrunkLean = 35 * kDegree, kMaxLegLean = 60 * kDegree;
// Bones of the trunk whose rests differ by more differ by their pose, not by their build.
constexpr double kMaxBuildAngle = 45 * kDegree;
// A joint is a hinge in a clip when it bends by this on average; less says little about its axis.
constexpr double kMinBend = .06;
// A rest elbow that bends by more shows its axis.
constexpr double kMinRestBend = .17;
constexpr size_t kMaxFrames = 600;    // that are looked at
constexpr int kMinStanceFrames = 12;  // of a foot, for its sole
constexpr double kMaxFootPitch = 60 * kDegree;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The rotation whose second axis is `up` and whose first one is nearest to `left`.
Eigen::Matrix3d Frame(const Eigen::Vector3d& left, const Eigen::Vector3d& up) {
  Eigen::Matrix3d frame;
  frame.col(1) = up.normalized();
  Eigen::Vector3d x = left - left.dot(frame.col(1)) * frame.col(1);
  if (!(x.norm() > 1e-9 * left.norm()) || !(x.norm() > 0)) x = frame.col(1).unitOrthogonal();
  frame.col(0) = x.normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

Eigen::Vector3d Flat(const Eigen::Vector3d& v) { return {v.x(), 0, v.z()}; }

// The turn about the vertical axis that takes the heading of `from` to that of `to`.
Eigen::Matrix3d HeadingTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  if (!(Flat(from).norm() > 1e-9) || !(Flat(to).norm() > 1e-9)) {
    return Eigen::Matrix3d::Identity();
  }
  const double angle = std::atan2(to.x(), to.z()) - std::atan2(from.x(), from.z());
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

class Aligner {
 public:
  explicit Aligner(const AlignmentInputs& inputs)
      : in_(inputs), rest_(inputs.clip.RestPositions()) {
    index_of_.assign(static_cast<size_t>(inputs.skeleton.num_joints()), -1);
    for (size_t i = 0; i < inputs.bones.size(); ++i) {
      index_of_[static_cast<size_t>(inputs.bones[i].bone)] = static_cast<int>(i);
    }
  }

  RestAlignment Align() {
    result_.stands = Stands();
    for (size_t i = 0; i < in_.bones.size(); ++i) {
      const bool by_motion = !result_.stands && in_.bones[i].alignment == BoneAlignment::kRotation;
      result_.turns.push_back(by_motion ? Average(i) : First(i));
    }
    if (!result_.stands) {
      AlignHinge(kLeftUpperLeg);
      AlignHinge(kRightUpperLeg);
      AlignHinge(kLeftUpperArm);
      AlignHinge(kRightUpperArm);
    }
    for (size_t i = 0; i < in_.bones.size(); ++i) {
      if (in_.bones[i].alignment == BoneAlignment::kSole) AlignSole(i);
    }
    return std::move(result_);
  }

 private:
  // The mapped bone that ends in a landmark of the character, or -1.
  int IndexOf(int landmark) const {
    const int joint = in_.target.joints[static_cast<size_t>(landmark)];
    return joint < 0 ? -1 : index_of_[static_cast<size_t>(joint)];
  }
  Eigen::Vector3d SourceRest(int joint) const { return rest_.col(joint); }
  // Where the clip has a landmark at rest.
  Eigen::Vector3d SourceAt(int landmark) const {
    const int index = IndexOf(landmark);
    return index < 0 ? Eigen::Vector3d::Zero().eval()
                     : SourceRest(in_.bones[static_cast<size_t>(index)].from);
  }
  Eigen::Vector3d TargetAt(int landmark) const {
    const int joint = in_.target.joints[static_cast<size_t>(landmark)];
    return joint < 0 ? Eigen::Vector3d::Zero().eval() : in_.skeleton.rest_position(joint);
  }

  Eigen::Vector3d TargetDirection(size_t i) const {
    const int bone = in_.bones[i].bone;
    const int parent = in_.skeleton.parent(bone);
    if (parent < 0) return Eigen::Vector3d::Zero();
    return in_.skeleton.rest_position(bone) - in_.skeleton.rest_position(parent);
  }
  // As the joint that the bone turns with has it; of a bone over several joints the whole way where
  // they are one.
  Eigen::Vector3d SourceDirection(size_t i) const {
    const ResolvedBone& bone = in_.bones[i];
    const Eigen::Vector3d own = SourceRest(bone.from) - SourceRest(bone.turns);
    if (own.norm() > 0) return own;
    return SourceRest(bone.from) - SourceRest(bone.begin);
  }

  template <typename At>
  Eigen::Vector3d Left(const At& at) const {
    Eigen::Vector3d left = at(kLeftUpperLeg) - at(kRightUpperLeg);
    if (IndexOf(kLeftUpperArm) >= 0 && IndexOf(kRightUpperArm) >= 0) {
      left += at(kLeftUpperArm) - at(kRightUpperArm);
    }
    return left;
  }
  Eigen::Vector3d SourceLeft() const {
    return Left([&](int landmark) { return SourceAt(landmark); });
  }
  Eigen::Vector3d TargetLeft() const {
    return Left([&](int landmark) { return TargetAt(landmark); });
  }

  // The next mapped bone above, which is there: the root is mapped.
  int AboveOf(size_t i) const {
    int above = in_.skeleton.parent(in_.bones[i].bone);
    while (index_of_[static_cast<size_t>(above)] < 0) above = in_.skeleton.parent(above);
    return index_of_[static_cast<size_t>(above)];
  }
  // The bone that turns with the top of the trunk, or -1.
  int TopIndex() const {
    const int head = IndexOf(kHead);
    return head >= 0 ? head : IndexOf(kChest);
  }

  bool Stands() const {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
    const int top = TopIndex();
    if (top >= 0) {
      const Eigen::Vector3d trunk =
          SourceRest(in_.bones[static_cast<size_t>(top)].turns) - SourceAt(kHips);
      if (AngleBetween(trunk, up) > kMaxTrunkLean) return false;
    }
    for (const auto& [hip, ankle] :
         {std::pair(kLeftUpperLeg, kLeftFoot), std::pair(kRightUpperLeg, kRightFoot)}) {
      if (AngleBetween(SourceAt(ankle) - SourceAt(hip), -up) > kMaxLegLean) return false;
    }
    return true;
  }

  // From the bone above, without a look at the motion.
  Eigen::Matrix3d First(size_t i) const {
    const ResolvedBone& bone = in_.bones[i];
    if (i == 0) return RootTurn();
    const Eigen::Matrix3d& carried = result_.turns[static_cast<size_t>(AboveOf(i))];
    const Eigen::Vector3d wanted = SourceDirection(i), has = carried * TargetDirection(i);
    if (bone.alignment == BoneAlignment::kRotation && AngleBetween(has, wanted) < kMaxBuildAngle) {
      return carried;
    }
    return ShortestTurn(has, wanted) * carried;
  }

  Eigen::Matrix3d RootTurn() const {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
    return Frame(SourceLeft(), up) * Frame(TargetLeft(), up).transpose();
  }

  // The rotation where the rest of the clip says nothing: pelvis and trunk are upright on average,
  // and each bone of the trunk has on average the rotation of the one above. Frames count by how
  // upright the body is.
  Eigen::Matrix3d Average(size_t i) const {
    const ResolvedBone& bone = in_.bones[i];
    const int above = i == 0 ? -1 : AboveOf(i);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d left = Eigen::Vector3d::Zero(), up = left;
    ForFrames([&](size_t, const PlacedJoints& placed) {
      const double weight = Uprightness(placed);
      const Eigen::Matrix3d back =
          placed.rotations[static_cast<size_t>(bone.turns)].toRotationMatrix().transpose();
      if (above < 0) {
        left +=
            weight * (back * (PlacedAt(placed, kLeftUpperLeg) - PlacedAt(placed, kRightUpperLeg)));
        up += weight * back.col(1);
        return;
      }
      const auto a = static_cast<size_t>(above);
      sum += weight *
             (back * placed.rotations[static_cast<size_t>(in_.bones[a].turns)] * result_.turns[a]);
    });
    if (above < 0)
      return Frame(left, up) * Frame(TargetLeft(), Eigen::Vector3d::UnitY()).transpose();
    return NearestRotation(sum);
  }

  Eigen::Vector3d PlacedAt(const PlacedJoints& placed, int landmark) const {
    const int index = IndexOf(landmark);
    return index < 0 ? Eigen::Vector3d::Zero().eval()
                     : placed.positions.col(in_.bones[static_cast<size_t>(index)].from).eval();
  }

  double Uprightness(const PlacedJoints& placed) const {
    const int top = TopIndex();
    if (top < 0) return 1;
    const Eigen::Vector3d trunk = placed.positions.col(in_.bones[static_cast<size_t>(top)].turns) -
                                  placed.positions.col(in_.bones[0].from);
    const double cosine = trunk.norm() > 0 ? trunk.y() / trunk.norm() : 0;
    return 1e-6 + std::pow(std::max(0., cosine), 8);
  }

  // Calls `see` with the frames that are looked at.
  template <typename See>
  void ForFrames(const See& see) const {
    const size_t step = std::max<size_t>(1, in_.clip.num_frames() / kMaxFrames);
    PlacedJoints placed;
    for (size_t t = 0; t < in_.clip.num_frames(); t += step) {
      PlaceJoints(in_.clip, t, &placed);
      see(t, placed);
    }
  }

  // The axis about which the character's limb from `first` on bends, at rest. An elbow that bends
  // at rest shows it. Else it follows from how bodies are made: a knee bends about the axis to the
  // left, and an elbow of an arm that hangs down about that to the right, which an arm that is
  // raised sideways carries with it.
  Eigen::Vector3d TargetHinge(int first, size_t upper, size_t lower) const {
    const Eigen::Vector3d left = Flat(TargetLeft()).normalized();
    if (first == kLeftUpperLeg || first == kRightUpperLeg) {
      const int foot = first + 2, toes = first + 3;
      const Eigen::Vector3d heading = Flat(TargetAt(toes) - TargetAt(foot));
      const Eigen::Vector3d across = Eigen::Vector3d::UnitY().cross(heading);
      const bool known = in_.target.joints[static_cast<size_t>(toes)] >= 0 && across.norm() > 0;
      return known && across.normalized().dot(left) > .5 ? across.normalized() : left;
    }
    const Eigen::Vector3d a = TargetDirection(upper).normalized();
    const Eigen::Vector3d bend = a.cross(TargetDirection(lower).normalized());
    if (bend.norm() > kMinRestBend) return bend.normalized();
    return ShortestTurn(-Eigen::Vector3d::UnitY(), a) * -left;
  }

  // Solves the twist of the two bones of a limb by the axis about which it bends in the clip.
  void AlignHinge(int first) {
    const int upper = IndexOf(first + 1), lower = IndexOf(first + 2);
    if (upper < 0 || lower < 0) return;
    const ResolvedBone& u = in_.bones[static_cast<size_t>(upper)];
    const ResolvedBone& l = in_.bones[static_cast<size_t>(lower)];
    Eigen::Vector3d upper_axis = Eigen::Vector3d::Zero(), lower_axis = upper_axis;
    double num_frames = 0;
    ForFrames([&](size_t, const PlacedJoints& placed) {
      const Eigen::Vector3d a = placed.positions.col(u.from) - placed.positions.col(u.begin);
      const Eigen::Vector3d b = placed.positions.col(l.from) - placed.positions.col(l.begin);
      const Eigen::Vector3d axis = a.normalized().cross(b.normalized());
      upper_axis += placed.rotations[static_cast<size_t>(u.turns)].conjugate() * axis;
      lower_axis += placed.rotations[static_cast<size_t>(l.turns)].conjugate() * axis;
      ++num_frames;
    });
    if (std::min(upper_axis.norm(), lower_axis.norm()) < kMinBend * num_frames) {
      result_.warnings.push_back(
          absl::StrCat("the clip does not bend '", in_.skeleton.joint(u.bone).name,
                       "', and its rest is no standing body: the twist of this limb is a guess"));
      return;
    }
    const auto i = static_cast<size_t>(upper), k = static_cast<size_t>(lower);
    const Eigen::Vector3d hinge = TargetHinge(first, i, k);
    result_.turns[i] =
        Frame(upper_axis, SourceDirection(i)) * Frame(hinge, TargetDirection(i)).transpose();
    result_.turns[k] =
        Frame(lower_axis, SourceDirection(k)) * Frame(hinge, TargetDirection(k)).transpose();
  }

  // Points a foot where the clip's points; on average it turns about its length with the shank.
  void PointFoot(size_t i) {
    const auto above = static_cast<size_t>(AboveOf(i));
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const Eigen::Vector3d direction = TargetDirection(i);
    ForFrames([&](size_t, const PlacedJoints& placed) {
      const Eigen::Matrix3d carried =
          placed.rotations[static_cast<size_t>(in_.bones[above].turns)] * result_.turns[above];
      const Eigen::Vector3d way =
          placed.positions.col(in_.bones[i].from) - placed.positions.col(in_.bones[i].begin);
      sum +=
          placed.rotations[static_cast<size_t>(in_.bones[i].turns)].toRotationMatrix().transpose() *
          ShortestTurn(carried * direction, way) * carried;
    });
    result_.turns[i] = NearestRotation(sum);
  }

  // A foot that stands is flat and points where the clip's points.
  void AlignSole(size_t i) {
    const ResolvedBone& bone = in_.bones[i];
    const bool is_left = bone.bone == in_.target[kLeftToes];
    if (!is_left && bone.bone != in_.target[kRightToes]) return;
    const FootContacts& contacts = in_.contacts[is_left ? 0 : 1];
    const Eigen::Vector3d heading = TargetDirection(i);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    int num_frames = 0;
    ForFrames([&](size_t t, const PlacedJoints& placed) {
      if (t >= contacts.heel.size() || !contacts.heel[t] || !contacts.ball[t]) return;
      const Eigen::Vector3d way =
          placed.positions.col(bone.from) - placed.positions.col(bone.begin);
      sum += placed.rotations[static_cast<size_t>(bone.turns)].toRotationMatrix().transpose() *
             HeadingTurn(heading, way);
      ++num_frames;
    });
    if (num_frames >= kMinStanceFrames) {
      result_.turns[i] = NearestRotation(sum);
      return;
    }
    const Eigen::Vector3d way = SourceDirection(i);
    if (!result_.stands || std::abs(way.y()) > std::sin(kMaxFootPitch) * way.norm()) {
      result_.warnings.push_back(
          absl::StrCat("the foot of '", in_.skeleton.joint(bone.bone).name,
                       "' never stands flat in the clip: it points where the clip's points"));
      PointFoot(i);
      return;
    }
    const Eigen::Matrix3d& root = result_.turns[0];
    result_.turns[i] = HeadingTurn(root * heading, way) * root;
  }

  const AlignmentInputs& in_;
  const Eigen::Matrix3Xd rest_;
  std::vector<int> index_of_;  // of the bone of each joint of the character among those mapped
  RestAlignment result_;
};

}  // namespace

Eigen::Matrix3d ShortestTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  if (!(from.norm() > 0) || !(to.norm() > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

RestAlignment AlignRests(const AlignmentInputs& inputs) { return Aligner(inputs).Align(); }

}  // namespace pleat
