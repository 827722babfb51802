// Frames of the models that a server keeps.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pleat/remote/live_session.h"
#include "pleat/service/model_service.h"
#include "pleat/service/pose_service.h"

namespace pleat {

struct RemoteState;

// Thread-safe.
class RemotePoses final : public PoseService {
 public:
  // `state` and `models`, which a stream of parameters downloads from, must outlive it.
  RemotePoses(RemoteState* state, ModelService* models) : state_(state), models_(models) {}

  // Frames come as RemoteOptions::stream says and are decoded, so positions differ from those of a
  // local evaluation by up to half a step of the grid. With a stream of parameters, the model is
  // downloaded once and evaluated here. A stream of the control mesh gives the control vertices
  // only.
  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) override;
  absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                           PoseSessionOptions options) override;
  absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                        PoseTrack track,
                                                        PoseSessionOptions options) override;
  // Returns kUnimplemented; OpenLiveSession takes its place.
  absl::StatusOr<std::unique_ptr<PoseStream>> OpenStream(const std::string& model_id,
                                                         PoseSessionOptions options,
                                                         LiveRules rules,
                                                         LiveListener* listener) override;

  // Evaluates one pose; the frame comes as RemoteOptions::stream says and is decoded. poses[0] is
  // the pose to show, poses[h] the pose h training-frame intervals earlier.
  absl::StatusOr<EvaluatedFrame> EvaluatePose(const ClipQuery& character,
                                              const std::vector<Pose>& poses);
  // Opens a session in which poses go out and frames come back as they happen. character.track is
  // not used.
  absl::StatusOr<std::unique_ptr<LiveSession>> OpenLiveSession(
      const ClipQuery& character, const LiveSessionOptions& options = {});

 private:
  absl::StatusOr<std::shared_ptr<const CharacterModel>> Model(const std::string& id);

  RemoteState* const state_;
  ModelService* const models_;
  // The model that was downloaded last, for streams of parameters.
  std::mutex model_mutex_;
  std::string model_id_;                         // guarded by model_mutex_
  std::shared_ptr<const CharacterModel> model_;  // guarded by model_mutex_
};

}  // namespace pleat
