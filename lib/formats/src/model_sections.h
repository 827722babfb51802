// Sections 1 to 8 and 10 of the model file (docs/formats/model_file.md). Each function Write...
// writes one section. Each function Read... reads it from hostile bytes and checks what can be
// checked without the other sections; errors are those of DecodeModel.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

void WriteInfo(const CharacterModel::Parts& parts, ByteWriter* writer);
absl::Status ReadInfo(ByteReader* reader, std::string* name, FrameRate* frame_rate);

void WriteTopology(const Topology& topology, ByteWriter* writer);
absl::StatusOr<Topology> ReadTopology(ByteReader* reader, const MeshLimits& limits);

void WriteAppearance(const MeshAppearance& appearance, ByteWriter* writer);
absl::StatusOr<MeshAppearance> ReadAppearance(ByteReader* reader, const Topology& topology);

void WriteSkeleton(const Skeleton& skeleton, ByteWriter* writer);
absl::StatusOr<Skeleton> ReadSkeleton(ByteReader* reader);

void WriteSkin(const Rig& rig, ByteWriter* writer);
absl::StatusOr<Rig> ReadSkin(ByteReader* reader, uint32_t version, const Skeleton& skeleton,
                             int num_vertices);

void WriteSkinFeatures(const std::optional<SkinFeatures>& features, ByteWriter* writer);
absl::StatusOr<std::optional<SkinFeatures>> ReadSkinFeatures(ByteReader* reader, uint32_t version,
                                                             const Rig& rig);

void WriteControl(const CharacterModel::Parts& parts, ByteWriter* writer);
absl::Status ReadControl(ByteReader* reader, int num_vertices, std::vector<int>* control_vertices,
                         std::optional<RbfUpsampler>* upsampler);

void WriteRecord(const TrainingRecord& record, ByteWriter* writer);
absl::StatusOr<TrainingRecord> ReadRecord(ByteReader* reader);

}  // namespace pleat
