// A character in the files of other programs: mesh, skin, motion and folds, without Pleat's own
// code (docs/formats/character.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/character/morph_basis.h"
#include "pleat/formats/motion_file.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// What is written. Joints are those of MakeExportJoints (joint_clip.h), in meters with Y up.
struct CharacterFile {
  std::string name;
  Topology topology;
  MeshAppearance appearance;
  Rig rig;               // its weights are written; they may have been cut (cut_influences.h)
  PoseTrack track;       // empty: the rest pose alone
  FrameRate frame_rate;  // of the track
  // They show the folds of the track with the weights of the rig; only glTF has them.
  std::optional<MorphBasis> morphs;
  // The whole mesh in every frame of the track, or nothing; only for USD.
  std::vector<Eigen::Matrix3Xf> points;
};

// The character as it moves in `motion`, or, with a motion of no frames, in its rest pose, with the
// strongest `influences` bones of every vertex (1 to kMaxInfluences, asserted). Clips become one,
// since these files know none. kInvalidArgument when the motion has bone_scales, which joints of
// other programs cannot hold. Strengths of the detail are in none of it.
absl::StatusOr<CharacterFile> MakeCharacterFile(const CharacterModel& model, const Motion& motion,
                                                int influences);

// Binary glTF 2.0: a skinned mesh with names, normals, texture coordinates, materials and
// _VERTEX_ID, one set of four influences for each four that a vertex has at most, the animation of
// the joints, and the morph targets with their weights. kResourceExhausted when the file would be
// larger than GLB allows (4 GiB).
absl::StatusOr<std::string> EncodeCharacterGlb(const CharacterFile& character);
absl::Status WriteCharacterGlb(const std::string& path, const CharacterFile& character);

// USD text: UsdSkel (SkelRoot, Skeleton, SkelAnimation), and beside the skinned mesh a mesh with
// the points of every frame where they are given.
std::string EncodeCharacterUsda(const CharacterFile& character);
absl::Status WriteCharacterUsda(const std::string& path, const CharacterFile& character);

}  // namespace pleat
