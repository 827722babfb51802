#include "glb_joints.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "glb_animation.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "glb_skin.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/math/rotations.h"

namespace pleat {
namespace {

absl::Status JointsFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: ", what));
}

// The first skin with all joints of `skeleton`.
absl::StatusOr<std::optional<GlbSkin>> FindSkin(const GlbContainer& glb, const GlbNodes& nodes,
                                                const Skeleton& skeleton) {
  for (size_t s = 0; s < glb.List("skins").size(); ++s) {
    PLEAT_ASSIGN_OR_RETURN(GlbSkin skin, ReadGlbSkin(glb, nodes, s));
    std::set<std::string> names;
    for (const int node : skin.joint_nodes) names.insert(GlbNodeName(glb, node));
    const bool has_all = std::ranges::all_of(
        skeleton.joints(), [&](const Joint& joint) { return names.contains(joint.name); });
    if (has_all) return std::optional(std::move(skin));
  }
  return std::optional<GlbSkin>();
}

// The first of the skins with the most joints.
absl::StatusOr<std::optional<GlbSkin>> FindLargestSkin(const GlbContainer& glb,
                                                       const GlbNodes& nodes) {
  std::optional<GlbSkin> largest;
  for (size_t s = 0; s < glb.List("skins").size(); ++s) {
    PLEAT_ASSIGN_OR_RETURN(GlbSkin skin, ReadGlbSkin(glb, nodes, s));
    if (largest && skin.joint_nodes.size() <= largest->joint_nodes.size()) continue;
    largest = std::move(skin);
  }
  return largest;
}

class JointsReader {
 public:
  JointsReader(const GlbContainer& glb, GlbNodes nodes, GlbSkin skin)
      : glb_(glb), nodes_(std::move(nodes)), skin_(std::move(skin)) {
    const std::vector<int> parents = ParentJoints(skin_, nodes_);
    order_ = ParentsFirst(parents);
    std::vector<int> new_index(parents.size(), -1);
    for (size_t i = 0; i < order_.size(); ++i) new_index[order_[i]] = static_cast<int>(i);
    for (const int j : order_) {
      clip_.joints.push_back({.name = GlbNodeName(glb_, skin_.joint_nodes[j]),
                              .parent = parents[j] < 0 ? -1 : new_index[parents[j]]});
    }
  }

  absl::StatusOr<JointClip> Read(const GlbAnimation* animation, const GlbFrames& frames) {
    PLEAT_RETURN_IF_ERROR(Rest(animation, frames));
    clip_.fps = frames.rate.fps();
    std::vector<GlbTransform> transforms = nodes_.transforms();
    std::vector<std::vector<float>> weights(static_cast<size_t>(nodes_.count()));
    for (const float time : frames.times) {
      if (animation != nullptr) {
        animation->Sample(time, &transforms, &weights);
        nodes_.Pose(transforms);
      }
      PLEAT_RETURN_IF_ERROR(AddFrame());
    }
    return std::move(clip_);
  }

 private:
  // What carries a point of the mesh at rest to where it is with joint i (in the order of the clip)
  // alone.
  Eigen::Matrix4d WorldFromMesh(size_t i) const {
    const auto joint = static_cast<size_t>(order_[i]);
    return nodes_.world_from_node(skin_.joint_nodes[joint]) * skin_.inverse_binds[joint];
  }

  // The mesh may be in another unit than the world: a node above the joints scales then.
  absl::Status Rest(const GlbAnimation* animation, const GlbFrames& frames) {
    if (skin_.inverse_binds.empty()) {
      return JointsFault("its skin has no inverse bind matrices, so its rest pose is not known");
    }
    if (animation != nullptr) {
      std::vector<GlbTransform> transforms = nodes_.transforms();
      std::vector<std::vector<float>> weights(static_cast<size_t>(nodes_.count()));
      animation->Sample(frames.times.front(), &transforms, &weights);
      nodes_.Pose(transforms);
    }
    const double determinant = WorldFromMesh(0).topLeftCorner<3, 3>().determinant();
    if (!(determinant > 0) || !std::isfinite(determinant)) {
      return JointsFault(absl::StrCat("the joint ", Quoted(0),
                                      " mirrors or flattens the mesh in the first frame"));
    }
    const double scale = std::cbrt(determinant);
    std::vector<Eigen::Vector3d> rest;
    for (size_t i = 0; i < clip_.num_joints(); ++i) {
      rest.push_back(
          scale *
          skin_.inverse_binds[static_cast<size_t>(order_[i])].inverse().col(3).hnormalized());
      const int parent = clip_.joints[i].parent;
      clip_.joints[i].offset = parent < 0 ? rest[i] : rest[i] - rest[static_cast<size_t>(parent)];
      if (!clip_.joints[i].offset.allFinite()) {
        return JointsFault(absl::StrCat("the rest place of ", Quoted(i), " is not finite"));
      }
    }
    return absl::OkStatus();
  }

  absl::Status AddFrame() {
    std::vector<Eigen::Quaterniond> world;
    std::vector<Eigen::Vector3d> places;
    for (size_t i = 0; i < clip_.num_joints(); ++i) {
      const Eigen::Matrix3d linear = WorldFromMesh(i).topLeftCorner<3, 3>();
      places.push_back(nodes_.world_from_node(skin_.joint_nodes[order_[i]]).col(3).hnormalized());
      if (!linear.allFinite() || !places.back().allFinite() || !(linear.determinant() > 0)) {
        return JointsFault(absl::StrCat("frame ", clip_.num_frames(), ": the joint ", Quoted(i),
                                        " is not turned and placed, but flattened or mirrored"));
      }
      world.emplace_back(NearestRotation(linear));
      world.back().normalize();
      const int parent = clip_.joints[i].parent;
      if (parent < 0) {
        clip_.rotations.push_back(world[i]);
        clip_.translations.push_back(places[i]);
        continue;
      }
      const Eigen::Quaterniond back = world[static_cast<size_t>(parent)].conjugate();
      clip_.rotations.push_back((back * world[i]).normalized());
      clip_.translations.push_back(back * (places[i] - places[static_cast<size_t>(parent)]));
    }
    return absl::OkStatus();
  }

  std::string Quoted(size_t i) const {
    return absl::StrCat("'", EscapeControls(clip_.joints[i].name), "'");
  }

  const GlbContainer& glb_;
  GlbNodes nodes_;
  GlbSkin skin_;
  std::vector<int> order_;  // the place in the skin of each joint of the clip
  JointClip clip_;
};

absl::StatusOr<std::optional<JointClip>> ReadSkin(const GlbContainer& glb, GlbNodes nodes,
                                                  std::optional<GlbSkin> skin,
                                                  const std::optional<FrameRate>& frame_rate,
                                                  const MeshLimits& limits, InputReport* report) {
  if (!skin) return std::optional<JointClip>();
  PLEAT_ASSIGN_OR_RETURN(const std::optional<GlbAnimation> animation,
                         ChooseGlbAnimation(glb, nodes, {}, report));
  GlbFrames frames{{0.f}, frame_rate.value_or(FrameRate{})};
  if (animation) {
    frames = ChooseGlbFrames(*animation, {frame_rate, limits.max_frames}, report);
  }
  const auto num_frames = static_cast<int64_t>(frames.times.size());
  if (num_frames > limits.max_frames ||
      num_frames * static_cast<int64_t>(skin->joint_nodes.size()) > kMaxJointFrames) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "GLB: ", num_frames, " frames of ", skin->joint_nodes.size(), " joints: the limits are ",
        limits.max_frames, " frames and ", kMaxJointFrames, " frames times joints"));
  }
  PLEAT_ASSIGN_OR_RETURN(JointClip clip, JointsReader(glb, std::move(nodes), *std::move(skin))
                                             .Read(animation ? &*animation : nullptr, frames));
  return std::optional(std::move(clip));
}

}  // namespace

absl::StatusOr<std::optional<JointClip>> DecodeGlbJoints(std::string_view bytes,
                                                         const Skeleton& skeleton,
                                                         const std::optional<FrameRate>& frame_rate,
                                                         const MeshLimits& limits,
                                                         InputReport* report) {
  PLEAT_ASSIGN_OR_RETURN(const GlbContainer glb, GlbContainer::Open(bytes, limits));
  PLEAT_ASSIGN_OR_RETURN(GlbNodes nodes, GlbNodes::Read(glb));
  PLEAT_ASSIGN_OR_RETURN(std::optional<GlbSkin> skin, FindSkin(glb, nodes, skeleton));
  return ReadSkin(glb, std::move(nodes), std::move(skin), frame_rate, limits, report);
}

absl::StatusOr<std::optional<JointClip>> DecodeLargestGlbSkin(
    std::string_view bytes, const std::optional<FrameRate>& frame_rate, const MeshLimits& limits,
    InputReport* report) {
  PLEAT_ASSIGN_OR_RETURN(const GlbContainer glb, GlbContainer::Open(bytes, limits));
  PLEAT_ASSIGN_OR_RETURN(GlbNodes nodes, GlbNodes::Read(glb));
  PLEAT_ASSIGN_OR_RETURN(std::optional<GlbSkin> skin, FindLargestSkin(glb, nodes));
  return ReadSkin(glb, std::move(nodes), std::move(skin), frame_rate, limits, report);
}

}  // namespace pleat
