// Models named on the command line: a .pleat file here, or the id of one on a service.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/session.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/motion_file.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// True when `model` names a file on this machine (exists, or ends in .pleat).
bool IsModelFile(const std::string& model);

// Reads a model file, or downloads the model whose id begins with `model`.
absl::StatusOr<std::shared_ptr<const CharacterModel>> LoadModel(const Session& session,
                                                                const std::string& model);

// FitMotion with progress; Ctrl-C stops it.
absl::StatusOr<PoseTrack> FitMotionWithProgress(const CharacterModel& model,
                                                const MeshSequence& sequence,
                                                const Session& session);

// The poses of `source` (a motion file, else a mesh sequence, whose poses are fitted). fps: where a
// sequence does not say, may be empty.
absl::StatusOr<Motion> LoadMotion(const std::string& source, const std::string& fps,
                                  const CharacterModel& model, const Session& session);

// The names of all joints, in order.
std::vector<std::string> JointNames(const Skeleton& skeleton);

}  // namespace pleat
