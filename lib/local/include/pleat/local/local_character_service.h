// Everything Pleat offers, in this process: store, jobs and cache behind one interface.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pleat/cache/byte_cache.h"
#include "pleat/character/train_character.h"
#include "pleat/formats/rig_file.h"
#include "pleat/jobs/job_manager.h"
#include "pleat/local/decode_session.h"
#include "pleat/local/encoder_pool.h"
#include "pleat/local/memory_budget.h"
#include "pleat/local/pose_session.h"
#include "pleat/service/character_service.h"
#include "pleat/store/store.h"

namespace pleat {

using TrainFunction = std::function<absl::StatusOr<std::shared_ptr<const CharacterModel>>(
    const std::vector<MeshSequence>& clips, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress)>;

// What is refused, with a status that names limit and number.
struct ServiceLimits {
  uint64_t max_upload_bytes = uint64_t{4} << 30;  // of one sequence or compressed sequence file
  int64_t max_vertices = 1'000'000;               // of one frame
  int64_t max_frames = 20'000;                    // of one sequence or clip
  int max_clips = 64;                             // of one training job
  uint64_t max_rig_bytes = uint64_t{12} << 20;    // of a user's own rig
};

struct LocalServiceOptions {
  std::string data_dir{};
  uint64_t reserve_bytes = uint64_t{256} << 20;  // kept free on the disk
  int num_workers = 1;                           // jobs at the same time
  int num_threads_per_job = 0;                   // 0 = one per core
  uint64_t cache_bytes = uint64_t{1} << 30;      // models in memory
  uint64_t decode_bytes = uint64_t{1} << 30;     // all decoders of compressed sequences
  uint64_t encoder_bytes = uint64_t{64} << 20;   // frame encoders that nobody uses at the moment
  ServiceLimits limits{};
  TrainFunction train = TrainCharacter;
};

struct UploadStatus {
  uint64_t received_bytes = 0;
  bool complete = false;  // the sequence is stored
};

// Thread-safe.
class LocalCharacterService final : public CharacterService {
 public:
  // Opens the data folder, takes over the jobs of the process before, and starts the workers.
  static absl::StatusOr<std::unique_ptr<LocalCharacterService>> Open(LocalServiceOptions options);
  ~LocalCharacterService() override;

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
  absl::Status WatchJob(const std::string& id,
                        const std::function<bool(const JobInfo&)>& observe) override;

  absl::StatusOr<ModelInfo> GetModel(const std::string& id) override;
  absl::StatusOr<std::vector<ModelInfo>> ListModels() override;
  absl::Status DeleteModel(const std::string& id) override;
  absl::StatusOr<std::string> DownloadModel(const std::string& id,
                                            const Progress& progress) override;

  absl::StatusOr<CompressedSequenceInfo> UploadCompressedSequence(
      const std::string& file, const Progress& progress) override;
  absl::StatusOr<CompressedSequenceInfo> GetCompressedSequence(const std::string& id) override;
  absl::StatusOr<std::vector<CompressedSequenceInfo>> ListCompressedSequences() override;
  absl::Status DeleteCompressedSequence(const std::string& id) override;
  absl::StatusOr<std::string> DownloadCompressedSequence(const std::string& id,
                                                         const Progress& progress) override;
  absl::Status DecodeFrames(const std::string& id, FrameRange range,
                            const DecodedFramesSink& sink) override;

  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) override;

  // The finer doors that streams need.

  absl::StatusOr<UploadStatus> QueryUpload(const std::string& id);
  // The right to write an upload; checks the declared size against the limits and the disk.
  absl::StatusOr<std::unique_ptr<Upload>> BeginUpload(const std::string& id, uint64_t size_bytes,
                                                      uint64_t offset_bytes);
  // Checks the complete upload and stores it. Takes seconds for large sequences.
  absl::StatusOr<SequenceInfo> FinishUpload(Upload* upload);
  // The same for an upload of a compressed sequence.
  absl::StatusOr<CompressedSequenceInfo> FinishCompressedUpload(Upload* upload);
  // The model, pinned in the cache as long as the handle lives.
  absl::StatusOr<std::shared_ptr<const CharacterModel>> AcquireModel(const std::string& id);
  // `count` bytes (fewer at the end) of the file of a model, sequence or compressed sequence.
  absl::StatusOr<std::string> ReadStoredBytes(EntryKind kind, const std::string& id,
                                              uint64_t offset, uint64_t count);
  absl::StatusOr<std::shared_ptr<JobStateMachine>> FindJob(const std::string& id);
  absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                           PoseSessionOptions options);
  absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                        PoseTrack track,
                                                        PoseSessionOptions options);

  // kResourceExhausted when all decoders together would take more than decode_bytes.
  absl::StatusOr<std::unique_ptr<DecodeSession>> OpenDecode(const std::string& id,
                                                            FrameRange range);

  const ServiceLimits& limits() const { return options_.limits; }
  ByteCacheStats cache_stats() const { return cache_.stats(); }
  uint64_t decoder_bytes() const { return decode_memory_.used_bytes(); }
  const EncoderPool& encoders() const { return encoders_; }
  const std::vector<std::string>& missing_files() const { return store_->missing_files(); }

  // Stops the workers; running jobs are queued for the next process. Watchers end.
  void Shutdown();
  bool shutting_down() const { return jobs_->shutting_down(); }

 private:
  LocalCharacterService(LocalServiceOptions options, std::unique_ptr<Store> store);
  absl::Status RestoreJobs();
  absl::StatusOr<RigFile> DecodeUserRig(const std::string& text) const;
  absl::Status CheckClip(const PoseTrack& track) const;
  absl::Status CheckSequence(const MeshSequence& sequence) const;
  absl::StatusOr<MeshSequence> LoadSequence(const std::string& id);
  absl::StatusOr<SequenceDecoder> OpenDecoder(std::string bytes) const;
  absl::StatusOr<JobOutcome> Run(const JobInfo& job, const Progress& progress);
  absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainModel(
      const std::vector<MeshSequence>& clips, const std::string& rig_id,
      const TrainOptions& options, const Progress& progress) const;
  absl::StatusOr<JobOutcome> Train(const JobInfo& job, const TrainOptions& options,
                                   const Progress& progress);
  absl::StatusOr<JobOutcome> Compress(const JobInfo& job, CompressOptions options,
                                      const Progress& progress);
  absl::StatusOr<std::string> Download(EntryKind kind, const std::string& id, uint64_t size_bytes,
                                       const Progress& progress);

  const LocalServiceOptions options_;
  std::unique_ptr<Store> store_;
  ByteCache<CharacterModel> cache_;
  MemoryBudget decode_memory_;
  EncoderPool encoders_;
  std::unique_ptr<JobManager> jobs_;
};

}  // namespace pleat
