// Pleat over the network: the CharacterService of a server somewhere else.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pleat/remote/live_session.h"
#include "pleat/service/character_service.h"
#include "pleat/stream/frame_encoder.h"
#include "pleat/stream/stream_header.h"

namespace grpc {
class Channel;
}

namespace pleat {

struct RemoteOptions {
  double connect_seconds = 5;    // until Connect gives up
  double deadline_seconds = 60;  // of one call that is no stream
  int max_attempts = 5;          // of an upload, download or watch that breaks off
  // Of EvaluateClip; 16 bits are about .02 mm on a person. Live sessions choose their own.
  FrameEncoderOptions stream{.position_bits = 16};
  bool tls = false;
  std::string tls_root_certificates{};                     // PEM; empty = those of the system
  std::string tls_client_certificate{}, tls_client_key{};  // PEM; for servers that ask for them
};

// What a stream of one clip gives, in this order; an error from either ends the stream.
struct ClipStreamSink {
  std::function<absl::Status(const StreamHeader&)> on_header{};  // may be null
  std::function<absl::Status(int frame_index, std::string_view draco, const FrameMark& mark,
                             double confidence)>
      on_frame{};
  // In its place for streams of parameters.
  std::function<absl::Status(int frame_index, const FrameParameters&)> on_parameters{};
};

// Thread-safe. Errors of the connection are kUnavailable (nobody answers) or kDeadlineExceeded;
// all others are the server's own.
class RemoteCharacterService final : public CharacterService {
 public:
  // address: HOST:PORT, or unix:PATH.
  static absl::StatusOr<std::unique_ptr<RemoteCharacterService>> Connect(
      const std::string& address, RemoteOptions options = {});
  // Over a channel that exists (in-process servers, tests).
  static std::unique_ptr<RemoteCharacterService> OverChannel(std::shared_ptr<grpc::Channel> channel,
                                                             RemoteOptions options = {});
  ~RemoteCharacterService() override;

  // In chunks; goes on where a broken upload stopped.
  absl::StatusOr<SequenceInfo> UploadSequence(const MeshSequence& sequence,
                                              const Progress& progress) override;
  absl::StatusOr<SequenceInfo> GetSequence(const std::string& id) override;
  absl::StatusOr<std::vector<SequenceInfo>> ListSequences() override;
  absl::Status DeleteSequence(const std::string& id) override;

  absl::StatusOr<JobInfo> CreateTrainingJob(const TrainingRequest& request) override;
  absl::StatusOr<JobInfo> CreateCompressionJob(const std::string& sequence_id,
                                               const CompressOptions& options) override;
  absl::StatusOr<JobInfo> GetJob(const std::string& id) override;
  absl::StatusOr<std::vector<JobInfo>> ListJobs() override;
  absl::Status CancelJob(const std::string& id) override;
  // Also calls `observe` about four times a second when nothing changes, so that a caller who wants
  // to stop is heard; watches again when the connection breaks.
  absl::Status WatchJob(const std::string& id,
                        const std::function<bool(const JobInfo&)>& observe) override;

  absl::StatusOr<ModelInfo> GetModel(const std::string& id) override;
  absl::StatusOr<std::vector<ModelInfo>> ListModels() override;
  absl::Status DeleteModel(const std::string& id) override;
  // The bytes have the SHA-256 `id`.
  absl::StatusOr<std::string> DownloadModel(const std::string& id,
                                            const Progress& progress) override;

  absl::StatusOr<CompressedSequenceInfo> UploadCompressedSequence(
      const std::string& file, const Progress& progress) override;
  absl::StatusOr<CompressedSequenceInfo> GetCompressedSequence(const std::string& id) override;
  absl::StatusOr<std::vector<CompressedSequenceInfo>> ListCompressedSequences() override;
  absl::Status DeleteCompressedSequence(const std::string& id) override;
  // The bytes have the SHA-256 `id`.
  absl::StatusOr<std::string> DownloadCompressedSequence(const std::string& id,
                                                         const Progress& progress) override;
  absl::Status DecodeFrames(const std::string& id, FrameRange range,
                            const DecodedFramesSink& sink) override;

  // Frames are decoded from RemoteOptions::stream, so positions differ from a local evaluation by
  // up to half a step of its grid. A stream of parameters downloads the model once and evaluates it
  // here; one of the control mesh gives its vertices only.
  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) override;

  // The same as Draco bytes, for those who keep or forward them.
  absl::Status StreamClip(const ClipQuery& query, const FrameEncoderOptions& encoding,
                          const ClipStreamSink& sink);

  // One pose -> one Draco frame. poses[h]: h training-frame intervals earlier.
  absl::StatusOr<EvaluatedFrame> EvaluatePose(const ClipQuery& character,
                                              const std::vector<Pose>& poses);

  // Poses in, frames out, as they happen. character.track is not used.
  absl::StatusOr<std::unique_ptr<LiveSession>> OpenLiveSession(
      const ClipQuery& character, const LiveSessionOptions& options = {});

 private:
  struct State;
  explicit RemoteCharacterService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pleat
