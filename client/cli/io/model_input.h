// Models that are named on the command line: a .pleat file here, or the id of a model on a service.
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

// Says whether `model` names a file on this machine: one that exists, or whose name ends in .pleat.
bool IsModelFile(const std::string& model);

// Reads a model file, or downloads the model whose id begins with `model`.
absl::StatusOr<std::shared_ptr<const CharacterModel>> LoadModel(const Session& session,
                                                                const std::string& model);

// Does the same as FitMotion, shows its progress and stops on Ctrl-C.
absl::StatusOr<PoseTrack> FitMotionWithProgress(const CharacterModel& model,
                                                const MeshSequence& sequence,
                                                const Session& session);

// Returns the poses of `source`: a motion (motion_reader.h), or else a mesh sequence, to which
// poses are fitted. fps: the frame rate of a source that does not have one; may be empty.
absl::StatusOr<Motion> LoadMotion(const std::string& source, const std::string& fps,
                                  const CharacterModel& model, const Session& session);

// Returns the names of all joints, in order.
std::vector<std::string> JointNames(const Skeleton& skeleton);

}  // namespace pleat
