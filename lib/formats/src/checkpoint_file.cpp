// A checkpoint is kind and version, then the parts of the training that are finished one after the
// other, and a checksum. A checksum finds accidents alone, so every count is checked against the
// bytes that are there before anything is allocated.
#include "pleat/formats/checkpoint_file.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "detail_section.h"
#include "model_sections.h"
#include "pleat/base/bytes.h"
#include "pleat/base/sealed_file.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"

namespace pleat {
namespace {

constexpr FileKind kCheckpointKind = {"PLEATCKP", 1, 1, "checkpoint"};
constexpr uint32_t kModelVersion = 5;  // the version of model files whose sections these are
constexpr size_t kMaxJobIdBytes = 64;
constexpr size_t kMaxWarningBytes = size_t{1} << 16;
constexpr size_t kMaxNameBytes = 256;  // of a learner
constexpr uint32_t kMaxLearners = 100;

enum class LastStage : uint32_t { kRig = 1, kFit = 2, kValidate = 3, kLearn = 4 };

LastStage LastStageOf(const TrainingCheckpoint& checkpoint) {
  if (checkpoint.detail_model) return LastStage::kLearn;
  if (checkpoint.choice) return LastStage::kValidate;
  return checkpoint.fit ? LastStage::kFit : LastStage::kRig;
}

void WriteRigging(const TrainingCheckpoint::Rigging& rigging, ByteWriter* writer) {
  WriteSkeleton(rigging.rig.skeleton, writer);
  writer->Write(static_cast<uint32_t>(rigging.rig.weights.num_vertices()));
  WriteSkin(rigging.rig, writer);
  writer->Write(static_cast<int32_t>(rigging.rest_frame));
  writer->Write(rigging.yaw_degrees);
  writer->Write(rigging.residual);
  writer->Write(static_cast<uint32_t>(rigging.warnings.size()));
  for (const std::string& warning : rigging.warnings) {
    writer->WriteString(std::string_view(warning).substr(0, kMaxWarningBytes));
  }
  writer->Write(static_cast<uint32_t>(rigging.locked_joints.size()));
  writer->WriteArray(std::span<const int32_t>(rigging.locked_joints));
}

absl::StatusOr<TrainingCheckpoint::Rigging> ReadRigging(ByteReader* reader,
                                                        const MeshLimits& limits) {
  TrainingCheckpoint::Rigging rigging;
  PLEAT_ASSIGN_OR_RETURN(const Skeleton skeleton, ReadSkeleton(reader));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_vertices, reader->Read<uint32_t>("vertex count"));
  if (num_vertices == 0) return absl::InvalidArgumentError("a rig without vertices");
  if (num_vertices > limits.max_vertices) {
    return absl::ResourceExhaustedError(
        absl::StrCat(num_vertices, " vertices, the limit is ", limits.max_vertices));
  }
  PLEAT_ASSIGN_OR_RETURN(rigging.rig,
                         ReadSkin(reader, kModelVersion, skeleton, static_cast<int>(num_vertices)));
  PLEAT_ASSIGN_OR_RETURN(rigging.rest_frame, reader->Read<int32_t>("rest frame"));
  PLEAT_ASSIGN_OR_RETURN(rigging.yaw_degrees, reader->Read<double>("yaw"));
  PLEAT_ASSIGN_OR_RETURN(rigging.residual, reader->Read<double>("residual"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_warnings, reader->Read<uint32_t>("warning count"));
  PLEAT_RETURN_IF_ERROR(reader->Require(num_warnings, sizeof(uint32_t), "warnings"));
  for (uint32_t i = 0; i < num_warnings; ++i) {
    PLEAT_ASSIGN_OR_RETURN(std::string warning, reader->ReadString(kMaxWarningBytes, "warning"));
    rigging.warnings.push_back(std::move(warning));
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_locked, reader->Read<uint32_t>("locked joints"));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_locked, "locked joints", &rigging.locked_joints));
  return rigging;
}

void WriteFit(const TrainingCheckpoint::Fit& fit, ByteWriter* writer) {
  const PoseTrack& track = fit.track;
  writer->Write(track.fps());
  writer->Write(static_cast<uint32_t>(track.clip_starts().size()));
  writer->WriteArray(std::span<const int32_t>(track.clip_starts()));
  writer->Write(static_cast<uint32_t>(track.num_frames()));
  writer->Write(static_cast<uint32_t>(track.num_joints()));
  for (const Pose& pose : track.poses()) {
    WriteMatrix(pose.root_position, writer);
    for (const Eigen::Quaterniond& rotation : pose.rotations) {
      WriteMatrix(rotation.coeffs(), writer);  // x, y, z, w
    }
  }
  writer->Write(fit.jitter_rad);
  writer->Write(fit.unsmoothed_jitter_rad);
  writer->Write(fit.unsmoothed_rms_m);
}

absl::StatusOr<TrainingCheckpoint::Fit> ReadFit(ByteReader* reader) {
  PoseTrack::Parts parts;
  PLEAT_ASSIGN_OR_RETURN(parts.fps, reader->Read<double>("frames per second"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_clips, reader->Read<uint32_t>("clip count"));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_clips, "clip starts", &parts.clip_starts));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_frames, reader->Read<uint32_t>("frame count"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_joints, reader->Read<uint32_t>("joint count"));
  const uint64_t pose_bytes = sizeof(double) * (3 + 4 * uint64_t{num_joints});
  PLEAT_RETURN_IF_ERROR(reader->Require(num_frames, pose_bytes, "poses"));
  parts.poses.resize(num_frames);
  for (Pose& pose : parts.poses) {
    PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, 3, 1, "root position", &pose.root_position));
    pose.rotations.resize(num_joints);
    for (Eigen::Quaterniond& rotation : pose.rotations) {
      PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, 4, 1, "rotation", &rotation.coeffs()));
    }
  }
  TrainingCheckpoint::Fit fit;
  PLEAT_ASSIGN_OR_RETURN(fit.track, PoseTrack::Create(std::move(parts)));
  PLEAT_ASSIGN_OR_RETURN(fit.jitter_rad, reader->Read<double>("jitter"));
  PLEAT_ASSIGN_OR_RETURN(fit.unsmoothed_jitter_rad, reader->Read<double>("unsmoothed jitter"));
  PLEAT_ASSIGN_OR_RETURN(fit.unsmoothed_rms_m, reader->Read<double>("unsmoothed error"));
  return fit;
}

void WriteChoice(const TrainingCheckpoint::Choice& choice, ByteWriter* writer) {
  writer->WriteString(ChoiceName(choice.learner));
  writer->Write(static_cast<int32_t>(choice.validation.num_held_out_frames));
  writer->Write(static_cast<uint32_t>(choice.validation.mean_percent.size()));
  for (const auto& [name, percent] : choice.validation.mean_percent) {
    writer->WriteString(name);
    writer->Write(percent);
  }
}

absl::StatusOr<TrainingCheckpoint::Choice> ReadChoice(ByteReader* reader) {
  TrainingCheckpoint::Choice choice;
  PLEAT_ASSIGN_OR_RETURN(const std::string learner, reader->ReadString(kMaxNameBytes, "learner"));
  PLEAT_ASSIGN_OR_RETURN(choice.learner, ParseChoice<LearnerChoice>("learner", learner));
  PLEAT_ASSIGN_OR_RETURN(choice.validation.num_held_out_frames,
                         reader->Read<int32_t>("held-out frames"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_learners, reader->Read<uint32_t>("learner count"));
  if (num_learners > kMaxLearners) {
    return absl::ResourceExhaustedError(
        absl::StrCat(num_learners, " learners, the limit is ", kMaxLearners));
  }
  for (uint32_t i = 0; i < num_learners; ++i) {
    PLEAT_ASSIGN_OR_RETURN(std::string name, reader->ReadString(kMaxNameBytes, "learner"));
    PLEAT_ASSIGN_OR_RETURN(choice.validation.mean_percent[std::move(name)],
                           reader->Read<double>("error of a learner"));
  }
  return choice;
}

absl::Status ReadStages(ByteReader* reader, LastStage last, const MeshLimits& limits,
                        TrainingCheckpoint* checkpoint) {
  PLEAT_ASSIGN_OR_RETURN(checkpoint->rigging, ReadRigging(reader, limits));
  if (last >= LastStage::kFit) {
    PLEAT_ASSIGN_OR_RETURN(checkpoint->fit, ReadFit(reader));
  }
  if (last >= LastStage::kValidate) {
    PLEAT_ASSIGN_OR_RETURN(checkpoint->choice, ReadChoice(reader));
  }
  if (last < LastStage::kLearn) return absl::OkStatus();
  PLEAT_ASSIGN_OR_RETURN(DetailModelParameters parameters,
                         ReadDetail(reader, kModelVersion, limits.max_unfolded_bytes));
  PLEAT_ASSIGN_OR_RETURN(DetailModel model, DetailModel::FromParameters(std::move(parameters)));
  checkpoint->detail_model = std::make_shared<const DetailModel>(std::move(model));
  return absl::OkStatus();
}

}  // namespace

std::string EncodeCheckpoint(const CheckpointFile& file) {
  const TrainingCheckpoint& checkpoint = file.checkpoint;
  ByteWriter writer;
  WriteFileKind(kCheckpointKind, &writer);
  writer.WriteString(file.job_id);
  writer.WriteString(file.inputs);
  writer.Write(static_cast<uint32_t>(LastStageOf(checkpoint)));
  WriteRigging(*checkpoint.rigging, &writer);
  if (checkpoint.fit) WriteFit(*checkpoint.fit, &writer);
  if (checkpoint.choice) WriteChoice(*checkpoint.choice, &writer);
  if (checkpoint.detail_model) WriteDetail(checkpoint.detail_model->parameters(), &writer);
  return SealFile(&writer);
}

absl::StatusOr<CheckpointFile> DecodeCheckpoint(std::string_view bytes, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const SealedFile sealed, OpenSealedFile(kCheckpointKind, bytes));
  ByteReader reader(sealed.bytes.substr(kFileKindBytes));
  CheckpointFile file;
  PLEAT_ASSIGN_OR_RETURN(file.job_id, reader.ReadString(kMaxJobIdBytes, "job id"));
  if (file.job_id.empty()) return absl::InvalidArgumentError("a checkpoint without a job id");
  PLEAT_ASSIGN_OR_RETURN(file.inputs, reader.ReadString(kMaxCheckpointInputsBytes, "inputs"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t last, reader.Read<uint32_t>("last stage"));
  if (last < static_cast<uint32_t>(LastStage::kRig) ||
      last > static_cast<uint32_t>(LastStage::kLearn)) {
    return absl::InvalidArgumentError(absl::StrCat("stage ", last, " is unknown"));
  }
  PLEAT_RETURN_IF_ERROR(
      ReadStages(&reader, static_cast<LastStage>(last), limits, &file.checkpoint));
  if (reader.remaining() != 0) {
    return absl::DataLossError(absl::StrCat(reader.remaining(), " bytes too many"));
  }
  return file;
}

}  // namespace pleat
