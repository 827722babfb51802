// What Pleat offers, without saying where it runs: implemented by the local service
// (server/service) and by the remote client (client/). One contract test suite runs on both.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/character/train_character.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

struct SequenceInfo {
  std::string id;  // hex SHA-256 of the sequence file's bytes (docs/formats/sequence_file.md)
  std::string name;
  int num_frames = 0, num_vertices = 0, num_faces = 0;
  FrameRate frame_rate;
  uint64_t size_bytes = 0;
};

// queued -> running -> succeeded | failed | cancelled; queued -> cancelled. A job that was running
// when the server stopped is queued again at the next start.
enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };
bool IsFinal(JobState state);
const char* JobStateName(JobState state);  // "queued", "running", ...

// What a job does: train a model, or compress one sequence.
using JobOptions = std::variant<TrainOptions, CompressOptions>;

struct TrainingRequest {
  std::vector<std::string> sequence_ids{};
  TrainOptions options{};
  std::string model_name{};  // empty: the first sequence's
  // The user's own rig as the text of a rig file (docs/formats/rig.md); empty: found automatically.
  std::string rig{};
};

struct JobInfo {
  std::string id;
  JobState state = JobState::kQueued;
  std::vector<std::string> sequence_ids;
  JobOptions options;
  std::string name;                 // of the result
  std::string rig_id;               // hex SHA-256 of TrainingRequest::rig, or empty
  std::string stage;                // of the running computation: "rig", "fit", "encode", ...
  double fraction = 0;              // 0..1
  std::optional<double> objective;  // of the running optimizer
  std::optional<double> eta_seconds;
  std::vector<std::string> warnings;
  absl::Status error;     // why it failed or was cancelled
  std::string result_id;  // when it succeeded: of the model or of the compressed sequence
};

struct ModelInfo {
  std::string id;  // hex SHA-256 of the model file's bytes
  std::string name;
  Skeleton skeleton;
  FrameRate frame_rate;
  int num_vertices = 0, num_faces = 0, num_control_vertices = 0, num_components = 0;
  uint64_t size_bytes = 0;    // model file
  uint64_t memory_bytes = 0;  // in the cache
  TrainOptions options;
  TrainingRecord record;
};

// What was measured when a sequence was compressed.
struct CompressionRecord {
  std::string sequence_id;  // what was compressed
  CompressOptions options;
  CompressSummary summary;
  double encode_seconds = 0;  // with the check of the promise
  double decode_seconds = 0;  // opening the file and decoding all frames, on one thread
};

struct CompressedSequenceInfo {
  std::string id;  // hex SHA-256 of the file (docs/formats/compressed_sequence.md)
  std::string name;
  int num_frames = 0, num_vertices = 0, num_faces = 0;
  FrameRate frame_rate;
  uint64_t size_bytes = 0;
  std::optional<CompressionRecord> record;  // none of files that were uploaded
};

// Frames [begin, end) of a sequence; end 0: to its end.
struct FrameRange {
  int begin = 0, end = 0;
};

// What decoding gives, in this order; an error from either ends it.
struct DecodedFramesSink {
  // The first frame of the range: connectivity, appearance, name, frame rate.
  std::function<absl::Status(const MeshSequence& shape)> on_shape;
  // Every frame of the range. positions: 3 x V, meters.
  std::function<absl::Status(int t, const Eigen::Matrix3Xf& positions)> on_frame;
};

struct ClipQuery {
  std::string model_id;
  PoseTrack track;
  std::vector<double> bone_scales;  // J or empty
  bool skinned_only = false;
};

class CharacterService {
 public:
  virtual ~CharacterService() = default;

  // Sequences. Uploading the same content twice gives the same id and stores it once.
  virtual absl::StatusOr<SequenceInfo> UploadSequence(const MeshSequence& sequence,
                                                      const Progress& progress) = 0;
  virtual absl::StatusOr<SequenceInfo> GetSequence(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<SequenceInfo>> ListSequences() = 0;
  virtual absl::Status DeleteSequence(const std::string& id) = 0;

  // Jobs.
  virtual absl::StatusOr<JobInfo> CreateTrainingJob(const TrainingRequest& request) = 0;
  virtual absl::StatusOr<JobInfo> CreateCompressionJob(const std::string& sequence_id,
                                                       const CompressOptions& options) = 0;
  virtual absl::StatusOr<JobInfo> GetJob(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<JobInfo>> ListJobs() = 0;
  virtual absl::Status CancelJob(const std::string& id) = 0;
  // Calls `observe` with the job now and after every change until it is final or `observe` returns
  // false.
  virtual absl::Status WatchJob(const std::string& id,
                                const std::function<bool(const JobInfo&)>& observe) = 0;

  // Models.
  virtual absl::StatusOr<ModelInfo> GetModel(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<ModelInfo>> ListModels() = 0;
  virtual absl::Status DeleteModel(const std::string& id) = 0;
  virtual absl::StatusOr<std::string> DownloadModel(const std::string& id,
                                                    const Progress& progress) = 0;

  // Compressed sequences. `file`: bytes of a .plt.
  virtual absl::StatusOr<CompressedSequenceInfo> UploadCompressedSequence(
      const std::string& file, const Progress& progress) = 0;
  virtual absl::StatusOr<CompressedSequenceInfo> GetCompressedSequence(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<CompressedSequenceInfo>> ListCompressedSequences() = 0;
  virtual absl::Status DeleteCompressedSequence(const std::string& id) = 0;
  virtual absl::StatusOr<std::string> DownloadCompressedSequence(const std::string& id,
                                                                 const Progress& progress) = 0;
  virtual absl::Status DecodeFrames(const std::string& id, FrameRange range,
                                    const DecodedFramesSink& sink) = 0;

  // Poses: every frame of the clip in order; `consume` may stop it with an error.
  virtual absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) = 0;
};

}  // namespace pleat
