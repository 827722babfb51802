#include "bone_joints.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

// How far such a joint may lie from the one above, in diagonals of the skeleton: another program
// has rounded both.
constexpr double kSamePlace = 1e-4;

bool IsBoneJoint(const Skeleton& skeleton, int joint, double diagonal) {
  const int parent = skeleton.parent(joint);
  if (parent < 0 || skeleton.children(joint).size() != 1) return false;
  const std::string& below = skeleton.joint(skeleton.children(joint)[0]).name;
  std::string name = skeleton.joint(joint).name;
  while (name.ends_with("__")) name.pop_back();
  if (name.ends_with("bone_")) name.pop_back();
  return name == absl::StrCat(below, "_bone") &&
         (skeleton.rest_position(joint) - skeleton.rest_position(parent)).norm() <=
             kSamePlace * diagonal;
}

// The joints that stay: in the order of the skin where parents come first there, as Pleat writes
// them.
std::vector<int> KeptJoints(const Skeleton& skeleton, const std::vector<bool>& is_bone,
                            const std::vector<int>& skin_places) {
  std::vector<int> kept;
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    if (!is_bone[static_cast<size_t>(j)]) kept.push_back(j);
  }
  const bool is_skin_order =
      std::ranges::all_of(skeleton.joints(), [&, j = 0](const Joint& joint) mutable {
        const int place = skin_places[static_cast<size_t>(j++)];
        return joint.parent < 0 || skin_places[static_cast<size_t>(joint.parent)] < place;
      });
  if (is_skin_order) {
    std::ranges::sort(kept, {}, [&](int j) { return skin_places[static_cast<size_t>(j)]; });
  }
  return kept;
}

}  // namespace

void TakeBoneJoints(const std::vector<int>& skin_places, RigFile* file) {
  const Skeleton& skeleton = file->skeleton;
  const auto num_joints = static_cast<size_t>(skeleton.num_joints());
  const double diagonal = BoundsDiagonal(skeleton.RestPositions());
  std::vector<bool> is_bone(num_joints);
  for (size_t j = 0; j < num_joints; ++j) {
    is_bone[j] = IsBoneJoint(skeleton, static_cast<int>(j), diagonal);
  }
  const std::vector<int> kept = KeptJoints(skeleton, is_bone, skin_places);
  if (kept.size() == num_joints || kept.size() < 2) return;
  std::vector<int> new_index(num_joints, -1);
  for (size_t i = 0; i < kept.size(); ++i)
    new_index[static_cast<size_t>(kept[i])] = static_cast<int>(i);
  std::vector<Joint> joints;
  for (const int j : kept) {
    int parent = skeleton.parent(j);
    while (parent >= 0 && is_bone[static_cast<size_t>(parent)]) parent = skeleton.parent(parent);
    joints.push_back({skeleton.joint(j).name,
                      parent < 0 ? -1 : new_index[static_cast<size_t>(parent)],
                      skeleton.rest_position(j)});
  }
  absl::StatusOr<Skeleton> smaller = Skeleton::Create(std::move(joints));
  if (!smaller.ok()) return;
  std::vector<std::vector<JointInfluence>> influences = file->influences;
  for (std::vector<JointInfluence>& vertex : influences) {
    for (JointInfluence& influence : vertex) {
      const std::vector<int>& below = skeleton.children(influence.joint);
      if (below.size() != 1 || is_bone[static_cast<size_t>(below[0])]) return;
      influence.joint = new_index[static_cast<size_t>(below[0])];
    }
  }
  file->influences = std::move(influences);
  file->influences_are_of_bones = true;
  file->skeleton = *std::move(smaller);
}

}  // namespace pleat
