// Turns a rig file into the rig of a clip's own vertices.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "align_rig.h"
#include "pleat/base/status.h"
#include "pleat/formats/rig_file.h"
#include "pleat/geometry/point_index.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

constexpr int kVerticesPerLeaf = 10;  // in the search tree
// In diagonals of the clip's rest frame. A vertex that is farther from the file's mesh, or a joint
// that is farther from the center, belongs to another mesh, pose or unit.
constexpr double kMaxVertexDistance = .01;
constexpr double kMaxJointDistance = 1;

absl::Status CheckJoints(const Skeleton& skeleton, const Eigen::Matrix3Xd& rest, double diagonal) {
  const Eigen::Vector3d center = ComputeBounds(rest).center();
  for (const Joint& joint : skeleton.joints()) {
    if ((joint.rest_position - center).norm() <= kMaxJointDistance * diagonal) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "rig: joint '%s' at (%g, %g, %g) lies far from the mesh, which is %.3g m large around "
        "(%.3g, %.3g, %.3g): is it in another unit or up axis?",
        joint.name, joint.rest_position.x(), joint.rest_position.y(), joint.rest_position.z(),
        diagonal, center.x(), center.y(), center.z()));
  }
  return absl::OkStatus();
}

// Carries the file's influences to the clip's vertices by place.
absl::StatusOr<std::vector<std::vector<JointInfluence>>> CarryByPlace(const RigFile& file,
                                                                      const Eigen::Matrix3Xd& rest,
                                                                      double diagonal) {
  const PointIndex places(file.positions, kVerticesPerLeaf);
  std::vector<std::vector<JointInfluence>> influences(rest.cols());
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    double squared_distance = 0;
    const int nearest = places.Nearest(rest.col(v), &squared_distance);
    if (!(std::sqrt(squared_distance) <= kMaxVertexDistance * diagonal)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "rig: vertex %d of the clip is %.3g m from the nearest vertex of the file: its mesh must "
          "be the clip's frame %d (rest_frame), or differ from it by a rigid motion and a unit",
          v, std::sqrt(squared_distance), file.rest_frame));
    }
    influences[v] = file.influences[static_cast<size_t>(nearest)];
  }
  return influences;
}

// Returns the weights without a change when they have the form of Pleat's own already: they fall,
// belong to different bones and add up to 1. Then a rig that Pleat wrote comes back bit for bit.
std::optional<SkinWeights> OwnWeights(const RigFile& file) {
  std::vector<VertexInfluences> vertices(file.influences.size());
  for (size_t v = 0; v < vertices.size(); ++v) {
    const std::vector<JointInfluence>& influences = file.influences[v];
    if (influences.size() > kMaxInfluences) return std::nullopt;
    for (size_t k = 0; k < influences.size(); ++k) {
      const auto same_bone = [&](const JointInfluence& other) {
        return other.joint == influences[k].joint;
      };
      if (!(influences[k].weight > 0) || std::ranges::count_if(influences, same_bone) > 1 ||
          (k > 0 && influences[k].weight > influences[k - 1].weight)) {
        return std::nullopt;
      }
      vertices[v].bones[k] = static_cast<uint16_t>(influences[k].joint);
      vertices[v].weights[k] = static_cast<float>(influences[k].weight);
    }
  }
  absl::StatusOr<SkinWeights> weights =
      SkinWeights::Create(file.skeleton.num_joints(), std::move(vertices));
  if (!weights.ok()) return std::nullopt;
  return *std::move(weights);
}

absl::StatusOr<SkinWeights> BoneWeights(const RigFile& file) {
  if (std::optional<SkinWeights> own = OwnWeights(file)) return *std::move(own);
  std::vector<VertexInfluences> vertices(file.influences.size());
  for (size_t v = 0; v < vertices.size(); ++v) {
    std::map<int, double> bone_weights;
    double total = 0;
    for (const JointInfluence& influence : file.influences[v]) {
      if (influence.joint == 0 || !(influence.weight > 0)) continue;  // no bone ends in the root
      bone_weights[influence.joint] += influence.weight;
      total += influence.weight;
    }
    if (!(total > 0) || !std::isfinite(total)) {
      return absl::InvalidArgumentError(
          absl::StrCat("rig: vertex ", v, " has no positive, finite weight of a bone"));
    }
    vertices[v] = StrongestInfluences(bone_weights);
  }
  return SkinWeights::Create(file.skeleton.num_joints(), std::move(vertices));
}

// Says how many vertices lose influences because they have more than the skinning takes.
void NoteInfluences(const RigFile& file, std::vector<InputNote>* notes) {
  size_t num_cut = 0, most = 0;
  for (const std::vector<JointInfluence>& vertex : file.influences) {
    num_cut += vertex.size() > kMaxInfluences;
    most = std::max(most, vertex.size());
  }
  if (num_cut == 0) return;
  notes->push_back(
      {.kind = "influences_left_out",
       .text = absl::StrCat(num_cut, " of ", file.influences.size(),
                            " vertices of the rig have up to ", most, " influences: the strongest ",
                            kMaxInfluences, " of each are kept and add up to 1")});
}

std::vector<int> LockedJoints(const RigFile& file, const Skeleton& skeleton) {
  if (!file.is_locked) return file.locked_joints;
  std::vector<int> all(skeleton.num_joints());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

absl::StatusOr<UserRig> ResolveRig(const RigFile& given, const MeshSequence& clip,
                                   std::vector<InputNote>* notes) {
  RigFile file = given;
  if (notes != nullptr) {
    notes->insert(notes->end(), file.notes.begin(), file.notes.end());
    NoteInfluences(file, notes);
  }
  if (file.rest_frame >= clip.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("rig: rest_frame ", file.rest_frame, " of ",
                                                   clip.name(), ", which has ", clip.num_frames(),
                                                   " frames"));
  }
  const Eigen::Matrix3Xd rest = clip.FrameAsDouble(file.rest_frame);
  const double diagonal = BoundsDiagonal(rest);
  const bool by_place = file.positions.cols() > 0;
  if (by_place) {
    PLEAT_RETURN_IF_ERROR(AlignRig(rest, kMaxVertexDistance * diagonal, &file, notes));
    PLEAT_ASSIGN_OR_RETURN(file.influences, CarryByPlace(file, rest, diagonal));
  }
  PLEAT_RETURN_IF_ERROR(CheckJoints(file.skeleton, rest, diagonal));
  UserRig rig{file.skeleton, std::nullopt, file.rest_frame, LockedJoints(file, file.skeleton)};
  if (file.influences.empty()) return rig;
  if (!by_place && static_cast<Eigen::Index>(file.influences.size()) != rest.cols()) {
    return absl::InvalidArgumentError(absl::StrCat("rig: weights of ", file.influences.size(),
                                                   " vertices; ", clip.name(), " has ",
                                                   rest.cols()));
  }
  if (file.influences_are_of_bones) {
    PLEAT_ASSIGN_OR_RETURN(rig.weights, BoneWeights(file));
    return rig;
  }
  PLEAT_ASSIGN_OR_RETURN(UserRig converted,
                         RigFromJointWeights(file.skeleton, file.influences, rest));
  converted.rest_frame = file.rest_frame;
  converted.locked_joints = LockedJoints(file, converted.skeleton);
  return converted;
}

}  // namespace pleat
