#include "model_sections.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "model_versions.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

constexpr size_t kMaxJointNameBytes = 256;
constexpr uint32_t kMaxJoints = 65'535, kMaxWarnings = 10'000;

// Reads `N` counts at once.
template <size_t N>
absl::StatusOr<std::array<uint32_t, N>> ReadCounts(ByteReader* reader, absl::string_view what) {
  std::array<uint32_t, N> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), what));
  return counts;
}

std::array<double, 6> ErrorNumbers(const ErrorSummary& error) {
  return {error.mean_percent, error.rms_percent, error.p95_percent,
          error.max_percent,  error.mean_mm,     error.motion_mean_percent};
}

absl::Status ReadError(ByteReader* reader, ErrorSummary* error) {
  std::array<double, 6> numbers;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<double>(numbers), "errors"));
  error->mean_percent = numbers[0];
  error->rms_percent = numbers[1];
  error->p95_percent = numbers[2];
  error->max_percent = numbers[3];
  error->mean_mm = numbers[4];
  error->motion_mean_percent = numbers[5];
  return absl::OkStatus();
}

}  // namespace

void WriteInfo(const CharacterModel::Parts& parts, ByteWriter* writer) {
  WriteName(parts.name, writer);
  writer->Write(static_cast<uint32_t>(parts.frame_rate.numerator));
  writer->Write(static_cast<uint32_t>(parts.frame_rate.denominator));
}

absl::Status ReadInfo(ByteReader* reader, std::string* name, FrameRate* frame_rate) {
  PLEAT_ASSIGN_OR_RETURN(*name, ReadName(reader, "name"));
  PLEAT_ASSIGN_OR_RETURN(const auto rate, ReadCounts<2>(reader, "frame rate"));
  PLEAT_ASSIGN_OR_RETURN(*frame_rate, MakeFrameRate(rate[0], rate[1]));
  return absl::OkStatus();
}

void WriteTopology(const Topology& topology, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(topology.num_vertices()));
  writer->Write(static_cast<uint32_t>(topology.num_faces()));
  writer->Write(static_cast<uint32_t>(topology.num_corners()));
  WriteFaces(topology, writer);
}

absl::StatusOr<Topology> ReadTopology(ByteReader* reader, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const auto counts, ReadCounts<3>(reader, "mesh sizes"));
  const auto [num_vertices, num_faces, num_corners] = counts;
  PLEAT_RETURN_IF_ERROR(
      CheckCounts({.num_vertices = num_vertices, .num_faces = num_faces}, limits));
  return ReadFaces(reader, num_vertices, num_faces, num_corners);
}

void WriteAppearance(const MeshAppearance& appearance, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(appearance.texcoords.size()));
  writer->Write(static_cast<uint32_t>(appearance.material_names.size()));
  writer->Write(AppearanceFlags(appearance));
  WriteMaterialNames(appearance, writer);
  WriteAppearanceLists(appearance, writer);
}

absl::StatusOr<MeshAppearance> ReadAppearance(ByteReader* reader, const Topology& topology) {
  PLEAT_ASSIGN_OR_RETURN(const auto counts, ReadCounts<3>(reader, "appearance sizes"));
  const auto [num_texcoords, num_materials, flags] = counts;
  PLEAT_RETURN_IF_ERROR(CheckAppearanceFlags(flags, static_cast<uint32_t>(topology.num_corners()),
                                             static_cast<uint32_t>(topology.num_faces())));
  MeshAppearance appearance;
  PLEAT_RETURN_IF_ERROR(ReadMaterialNames(reader, num_materials, &appearance));
  PLEAT_RETURN_IF_ERROR(ReadAppearanceLists(reader, num_texcoords, flags, topology, &appearance));
  PLEAT_RETURN_IF_ERROR(CheckAppearance(appearance, topology));
  return appearance;
}

void WriteSkeleton(const Skeleton& skeleton, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(skeleton.num_joints()));
  for (const Joint& joint : skeleton.joints()) {
    writer->WriteString(std::string_view(joint.name).substr(0, kMaxJointNameBytes));
    writer->Write(static_cast<int32_t>(joint.parent));
    WriteMatrix(joint.rest_position, writer);
  }
}

absl::StatusOr<Skeleton> ReadSkeleton(ByteReader* reader) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_joints, reader->Read<uint32_t>("joint count"));
  if (num_joints > kMaxJoints) {
    return absl::ResourceExhaustedError(
        absl::StrCat(num_joints, " joints, the limit is ", kMaxJoints));
  }
  constexpr uint64_t kMinJointBytes = 4 + 4 + 3 * sizeof(double);
  PLEAT_RETURN_IF_ERROR(reader->Require(num_joints, kMinJointBytes, "joints"));
  std::vector<Joint> joints(num_joints);
  for (Joint& joint : joints) {
    PLEAT_ASSIGN_OR_RETURN(joint.name, reader->ReadString(kMaxJointNameBytes, "joint name"));
    PLEAT_ASSIGN_OR_RETURN(joint.parent, reader->Read<int32_t>("joint parent"));
    PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, 3, 1, "joint position", &joint.rest_position));
  }
  return Skeleton::Create(std::move(joints));
}

void WriteSkin(const Rig& rig, ByteWriter* writer) {
  WriteMatrix(rig.rest_positions, writer);
  const auto count = static_cast<size_t>(rig.weights.most_influences());
  writer->Write(static_cast<uint32_t>(count));
  for (const VertexInfluences& vertex : rig.weights.influences()) {
    writer->WriteArray(std::span<const uint16_t>(vertex.bones).first(count));
    writer->WriteArray(std::span<const float>(vertex.weights).first(count));
  }
  writer->Write(static_cast<uint32_t>(rig.fit_weights.size() > 0));
  WriteMatrix(rig.fit_weights, writer);
}

absl::StatusOr<Rig> ReadSkin(ByteReader* reader, uint32_t version, const Skeleton& skeleton,
                             int num_vertices) {
  const auto count = static_cast<uint64_t>(num_vertices);
  Eigen::Matrix3Xd rest_positions;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, 3, count, "rest positions", &rest_positions));
  uint32_t most = kStandardInfluences;
  if (version >= kFirstWithInfluences) {
    PLEAT_ASSIGN_OR_RETURN(most, reader->Read<uint32_t>("influence count"));
  }
  if (most < 1 || most > kMaxInfluences) {
    return absl::InvalidArgumentError(
        absl::StrCat(most, " influences of a vertex, expected 1 to ", kMaxInfluences));
  }
  PLEAT_RETURN_IF_ERROR(
      reader->Require(count, most * (sizeof(uint16_t) + sizeof(float)), "skin weights"));
  std::vector<VertexInfluences> influences(count);
  for (VertexInfluences& vertex : influences) {
    PLEAT_RETURN_IF_ERROR(
        reader->ReadArray(std::span<uint16_t>(vertex.bones).first(most), "bones"));
    PLEAT_RETURN_IF_ERROR(
        reader->ReadArray(std::span<float>(vertex.weights).first(most), "skin weights"));
  }
  PLEAT_ASSIGN_OR_RETURN(SkinWeights weights,
                         SkinWeights::Create(skeleton.num_joints(), std::move(influences)));
  Rig rig{skeleton, std::move(weights), std::move(rest_positions)};
  if (version < kFirstWithInfluences) return rig;
  PLEAT_ASSIGN_OR_RETURN(const uint32_t has_fit_weights, reader->Read<uint32_t>("fit weight flag"));
  if (has_fit_weights > 1) return absl::InvalidArgumentError("unknown fit weight flag");
  if (has_fit_weights == 0) return rig;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, count, 1, "fit weights", &rig.fit_weights));
  if (!(rig.fit_weights.minCoeff() > 0) || !(rig.fit_weights.maxCoeff() < 1e6f)) {
    return absl::InvalidArgumentError("a fit weight is not positive, or out of range");
  }
  return rig;
}

void WriteControl(const CharacterModel::Parts& parts, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(parts.control_vertices.size()));
  writer->WriteArray(std::span<const int32_t>(parts.control_vertices));
  writer->Write(static_cast<uint32_t>(parts.upsampler.has_value()));
  if (!parts.upsampler) return;
  const RbfUpsampler::Matrix& matrix = parts.upsampler->matrix();
  // The sparse V x C matrix is written as the number of entries of each row, then all columns, then
  // all values.
  std::vector<uint32_t> row_sizes;
  std::vector<int32_t> columns;
  std::vector<float> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    const size_t begin = columns.size();
    for (RbfUpsampler::Matrix::InnerIterator entry(matrix, row); entry; ++entry) {
      columns.push_back(static_cast<int32_t>(entry.col()));
      values.push_back(entry.value());
    }
    row_sizes.push_back(static_cast<uint32_t>(columns.size() - begin));
  }
  writer->WriteArray(std::span<const uint32_t>(row_sizes));
  writer->WriteArray(std::span<const int32_t>(columns));
  writer->WriteArray(std::span<const float>(values));
}

absl::Status ReadControl(ByteReader* reader, int num_vertices, std::vector<int>* control_vertices,
                         std::optional<RbfUpsampler>* upsampler) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_control, reader->Read<uint32_t>("control count"));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_control, "control vertices", control_vertices));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t has_upsampler, reader->Read<uint32_t>("upsampler flag"));
  if (has_upsampler > 1) return absl::InvalidArgumentError("unknown upsampler flag");
  if (has_upsampler == 0) return absl::OkStatus();
  std::vector<uint32_t> row_sizes;
  PLEAT_RETURN_IF_ERROR(
      ReadVector(reader, static_cast<uint64_t>(num_vertices), "upsampler rows", &row_sizes));
  // The sum of 32-bit sizes cannot overflow here, and ReadVector checks it against the bytes left.
  uint64_t num_entries = 0;
  for (const uint32_t size : row_sizes) num_entries += size;
  std::vector<int32_t> columns;
  std::vector<float> values;
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_entries, "upsampler columns", &columns));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_entries, "upsampler values", &values));
  if (num_entries > std::numeric_limits<int32_t>::max()) {
    return absl::ResourceExhaustedError(absl::StrCat(num_entries, " upsampler entries"));
  }
  std::vector<int32_t> row_starts = {0};
  for (const uint32_t size : row_sizes) {
    row_starts.push_back(row_starts.back() + static_cast<int32_t>(size));
  }
  PLEAT_ASSIGN_OR_RETURN(*upsampler, RbfUpsampler::FromRows(static_cast<int>(num_control),
                                                            row_starts, columns, values));
  return absl::OkStatus();
}

void WriteRecord(const TrainingRecord& record, ByteWriter* writer) {
  WriteName(record.learner, writer);
  writer->Write(static_cast<int32_t>(record.num_frames));
  writer->Write(static_cast<int32_t>(record.rest_frame));
  writer->Write(record.yaw_degrees);
  writer->Write(record.rig_residual);
  writer->Write(record.diagonal_m);
  for (const ErrorSummary* error : {&record.fit, &record.reconstruction}) {
    const std::array<double, 6> numbers = ErrorNumbers(*error);
    writer->WriteArray(std::span<const double>(numbers));
  }
  const size_t num_warnings = std::min<size_t>(record.warnings.size(), kMaxWarnings);
  writer->Write(static_cast<uint32_t>(num_warnings));
  for (size_t i = 0; i < num_warnings; ++i) WriteName(record.warnings[i], writer);
  writer->Write(static_cast<uint32_t>(record.worst_frames.size()));
  for (const FrameError& error : record.worst_frames) {
    writer->Write(static_cast<int32_t>(error.clip));
    writer->Write(static_cast<int32_t>(error.frame));
    writer->Write(error.mean_percent);
  }
  writer->Write(static_cast<uint32_t>(record.joint_fit_percent.size()));
  for (const double percent : record.joint_fit_percent) writer->Write(percent);
  writer->Write(record.pose_jitter_degrees);
  writer->Write(record.unsmoothed_jitter_degrees);
  writer->Write(record.unsmoothed_rms_percent);
  writer->Write(static_cast<int32_t>(record.validation.num_held_out_frames));
  writer->Write(static_cast<uint32_t>(record.validation.mean_percent.size()));
  for (const auto& [learner, percent] : record.validation.mean_percent) {
    WriteName(learner, writer);
    writer->Write(percent);
  }
}

namespace {

// Reads the part of the record that the first files of this version lack.
absl::Status ReadFitReport(ByteReader* reader, TrainingRecord* record) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_frames, reader->Read<uint32_t>("worst frame count"));
  for (uint32_t i = 0; i < num_frames; ++i) {
    FrameError error;
    PLEAT_ASSIGN_OR_RETURN(error.clip, reader->Read<int32_t>("clip of a worst frame"));
    PLEAT_ASSIGN_OR_RETURN(error.frame, reader->Read<int32_t>("worst frame"));
    PLEAT_ASSIGN_OR_RETURN(error.mean_percent, reader->Read<double>("error of a worst frame"));
    record->worst_frames.push_back(error);
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_joints, reader->Read<uint32_t>("joint error count"));
  for (uint32_t j = 0; j < num_joints; ++j) {
    PLEAT_ASSIGN_OR_RETURN(const double percent, reader->Read<double>("error of a joint"));
    record->joint_fit_percent.push_back(percent);
  }
  PLEAT_ASSIGN_OR_RETURN(record->pose_jitter_degrees, reader->Read<double>("pose jitter"));
  PLEAT_ASSIGN_OR_RETURN(record->unsmoothed_jitter_degrees, reader->Read<double>("pose jitter"));
  PLEAT_ASSIGN_OR_RETURN(record->unsmoothed_rms_percent, reader->Read<double>("pose error"));
  return absl::OkStatus();
}

// Reads what the learner was chosen by, which older files of this version lack.
absl::Status ReadValidation(ByteReader* reader, LearnerValidation* validation) {
  PLEAT_ASSIGN_OR_RETURN(validation->num_held_out_frames,
                         reader->Read<int32_t>("held-out frame count"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t count, reader->Read<uint32_t>("learner count"));
  for (uint32_t i = 0; i < count; ++i) {
    PLEAT_ASSIGN_OR_RETURN(const std::string learner, ReadName(reader, "validated learner"));
    PLEAT_ASSIGN_OR_RETURN(validation->mean_percent[learner],
                           reader->Read<double>("validation error"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TrainingRecord> ReadRecord(ByteReader* reader) {
  TrainingRecord record;
  PLEAT_ASSIGN_OR_RETURN(record.learner, ReadName(reader, "learner"));
  PLEAT_ASSIGN_OR_RETURN(record.num_frames, reader->Read<int32_t>("frame count"));
  PLEAT_ASSIGN_OR_RETURN(record.rest_frame, reader->Read<int32_t>("rest frame"));
  PLEAT_ASSIGN_OR_RETURN(record.yaw_degrees, reader->Read<double>("facing"));
  PLEAT_ASSIGN_OR_RETURN(record.rig_residual, reader->Read<double>("rig residual"));
  PLEAT_ASSIGN_OR_RETURN(record.diagonal_m, reader->Read<double>("diagonal"));
  PLEAT_RETURN_IF_ERROR(ReadError(reader, &record.fit));
  PLEAT_RETURN_IF_ERROR(ReadError(reader, &record.reconstruction));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_warnings, reader->Read<uint32_t>("warning count"));
  if (num_warnings > kMaxWarnings) {
    return absl::ResourceExhaustedError(
        absl::StrCat(num_warnings, " warnings, the limit is ", kMaxWarnings));
  }
  for (uint32_t i = 0; i < num_warnings; ++i) {
    PLEAT_ASSIGN_OR_RETURN(std::string warning, ReadName(reader, "warning"));
    record.warnings.push_back(std::move(warning));
  }
  if (reader->remaining() > 0) PLEAT_RETURN_IF_ERROR(ReadFitReport(reader, &record));
  if (reader->remaining() > 0) PLEAT_RETURN_IF_ERROR(ReadValidation(reader, &record.validation));
  return record;
}

}  // namespace pleat
