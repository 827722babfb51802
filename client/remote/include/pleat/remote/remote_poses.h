// Frames of the models of a server.
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

  // Frames are decoded from RemoteOptions::stream, so positions differ from a local evaluation by
  // up to half a step of its grid. A stream of parameters downloads the model once and evaluates it
  // here; one of the control mesh gives its vertices only.
  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) override;
  absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                           PoseSessionOptions options) override;
  absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                        PoseTrack track,
                                                        PoseSessionOptions options) override;
  // kUnimplemented: see OpenLiveSession.
  absl::StatusOr<std::unique_ptr<PoseStream>> OpenStream(const std::string& model_id,
                                                         PoseSessionOptions options,
                                                         LiveRules rules,
                                                         LiveListener* listener) override;

  // One pose -> one frame of RemoteOptions::stream, decoded. poses[h]: h training-frame intervals
  // earlier.
  absl::StatusOr<EvaluatedFrame> EvaluatePose(const ClipQuery& character,
                                              const std::vector<Pose>& poses);
  // Poses in, frames out, as they happen. character.track is not used.
  absl::StatusOr<std::unique_ptr<LiveSession>> OpenLiveSession(
      const ClipQuery& character, const LiveSessionOptions& options = {});

 private:
  absl::StatusOr<std::shared_ptr<const CharacterModel>> Model(const std::string& id);

  RemoteState* const state_;
  ModelService* const models_;
  // The model downloaded last, for streams of parameters.
  std::mutex model_mutex_;
  std::string model_id_;                         // guarded by model_mutex_
  std::shared_ptr<const CharacterModel> model_;  // guarded by model_mutex_
};

}  // namespace pleat
