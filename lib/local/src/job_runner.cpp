#include "pleat/local/job_runner.h"

#include <utility>

#include "infos.h"
#include "job_checkpoints.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/formats/model_file.h"
#include "pleat/local/job_memory.h"
#include "pleat/service/compression.h"
#include "pleat/store/records.h"

namespace pleat {
namespace {

// How long a job that waits for memory may take to notice that it was cancelled.
constexpr absl::Duration kCancellationPause = absl::Milliseconds(200);

uint64_t BytesOf(const JobOptions& options, const std::vector<SequenceInfo>& clips) {
  if (std::holds_alternative<TrainOptions>(options)) return TrainingBytes(clips);
  return clips.empty() ? 0 : CompressionBytes(clips[0]);
}

}  // namespace

absl::StatusOr<RigFile> JobRunner::DecodeUserRig(const std::string& text) const {
  MeshLimits limits;
  limits.max_document_bytes = static_cast<uint64_t>(files_->limits().max_rig_bytes);
  limits.max_vertices = files_->limits().max_vertices;
  return DecodeRigJson(text, limits);
}

absl::Status JobRunner::CheckMemory(const JobOptions& options,
                                    const std::vector<SequenceInfo>& clips) const {
  const uint64_t bytes = BytesOf(options, clips);
  if (memory_ == nullptr || memory_->CanFit(bytes)) return absl::OkStatus();
  return memory_->Reserve(bytes, "this job").status();
}

absl::StatusOr<Reservation> JobRunner::TakeMemory(const JobInfo& job,
                                                  const Progress& progress) const {
  if (memory_ == nullptr) return Reservation();
  std::vector<SequenceInfo> clips;
  for (const std::string& id : job.sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, sequences_->Get(id));
    clips.push_back(std::move(info));
  }
  const uint64_t bytes = BytesOf(job.options, clips);
  const Progress waiting = progress.Stage("wait for memory", 0, 0);
  while (true) {
    const uint64_t num_releases = memory_->num_releases();
    absl::StatusOr<Reservation> memory = memory_->Reserve(bytes, "this job");
    if (memory.ok() || !memory_->CanFit(bytes)) return memory;
    PLEAT_RETURN_IF_ERROR(waiting.Report(0));  // says that the job was cancelled
    memory_->WaitForRelease(num_releases, kCancellationPause);
  }
}

absl::StatusOr<JobOutcome> JobRunner::Run(const JobInfo& job, const Progress& progress) const {
  PLEAT_ASSIGN_OR_RETURN(const Reservation memory, TakeMemory(job, progress));
  if (const auto* training = std::get_if<TrainOptions>(&job.options)) {
    return Train(job, *training, progress);
  }
  return Compress(job, std::get<CompressOptions>(job.options), progress);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> JobRunner::TrainModel(
    const std::vector<MeshSequence>& clips, const std::string& rig_id, const TrainOptions& options,
    const TrainResources& resources, const Progress& progress) const {
  if (rig_id.empty()) return train_(clips, options, resources, nullptr, progress);
  PLEAT_ASSIGN_OR_RETURN(const std::string text, files_->Read(rig_id));
  PLEAT_ASSIGN_OR_RETURN(const RigFile file, DecodeUserRig(text));
  PLEAT_ASSIGN_OR_RETURN(const UserRig rig, ResolveRig(file, clips[0]));
  return TrainCharacterWithRig(clips, rig, options, resources, nullptr, progress);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> JobRunner::TrainFromCheckpoint(
    const std::vector<MeshSequence>& clips, const JobInfo& job, const TrainOptions& options,
    const Progress& progress) const {
  JobCheckpoints checkpoints(files_, job);
  const std::optional<TrainingCheckpoint> checkpoint = checkpoints.Load();
  TrainResources resources;
  resources.num_threads = num_threads_;
  resources.on_checkpoint = [&](const TrainingCheckpoint& done) { checkpoints.Save(done); };
  if (checkpoint) {
    resources.resume = &*checkpoint;
    auto model = TrainModel(clips, job.rig_id, options, resources, progress);
    if (model.ok() || absl::IsCancelled(model.status())) return model;
    checkpoints.Discard(model.status());
    resources.resume = nullptr;
  }
  return TrainModel(clips, job.rig_id, options, resources, progress);
}

absl::StatusOr<JobOutcome> JobRunner::Train(const JobInfo& job, const TrainOptions& options,
                                            const Progress& progress) const {
  std::vector<MeshSequence> clips;
  const Progress reading = progress.Stage("read", 0, .02);
  for (const std::string& id : job.sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence clip, sequences_->Load(id));
    clips.push_back(std::move(clip));
    PLEAT_RETURN_IF_ERROR(
        reading.Report(static_cast<double>(clips.size()) / job.sequence_ids.size()));
  }
  PLEAT_ASSIGN_OR_RETURN(
      std::shared_ptr<const CharacterModel> model,
      TrainFromCheckpoint(clips, job, options, progress.Stage("train", .02, .98)));
  if (model->name() != job.name) {
    CharacterModel::Parts parts = model->parts();
    parts.name = job.name;
    PLEAT_ASSIGN_OR_RETURN(model, CharacterModel::Create(std::move(parts)));
  }
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .98, 1).Report(0));
  const std::string bytes = EncodeModel(*model);
  const ModelInfo info = MakeModelInfo(*model, ModelId(bytes), bytes.size());
  PLEAT_RETURN_IF_ERROR(
      files_->Add(EntryKind::kModel, {info.id, EncodeRecord(info)}, bytes, job.result_ttl));
  return JobOutcome{info.id, model->record().warnings};
}

absl::StatusOr<JobOutcome> JobRunner::Compress(const JobInfo& job, CompressOptions options,
                                               const Progress& progress) const {
  PLEAT_RETURN_IF_ERROR(progress.Stage("read", 0, .02).Report(0));
  const std::string& sequence_id = job.sequence_ids.at(0);
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, sequences_->Load(sequence_id));
  options.num_threads = num_threads_;
  PLEAT_ASSIGN_OR_RETURN(MeasuredCompression compressed,
                         CompressMeasured(sequence, options, progress.Stage("compress", .02, .99)));
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .99, 1).Report(0));
  CompressedSequenceInfo info = {.id = ToHex(ComputeSha256(compressed.bytes)),
                                 .name = sequence.name(),
                                 .num_frames = sequence.num_frames(),
                                 .num_vertices = sequence.num_vertices(),
                                 .num_faces = sequence.topology().num_faces(),
                                 .frame_rate = sequence.frame_rate(),
                                 .size_bytes = compressed.bytes.size(),
                                 .record = std::move(compressed.record)};
  info.record->sequence_id = sequence_id;
  PLEAT_RETURN_IF_ERROR(files_->Add(EntryKind::kCompressedSequence, {info.id, EncodeRecord(info)},
                                    compressed.bytes, job.result_ttl));
  return JobOutcome{info.id, {}};
}

}  // namespace pleat
