// The parts of a mesh that Pleat's binary formats write alike: the sequence file, the model file
// and the compressed sequence (docs/formats). Each Write... has a Read... that takes hostile bytes
// and checks every count against the bytes that are there before it allocates.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Names of sequences, materials and material libraries. Longer ones are cut when they are written
// and refused when they are read.
inline constexpr size_t kMaxNameBytes = 4096;
void WriteName(std::string_view name, ByteWriter* writer);
absl::StatusOr<std::string> ReadName(ByteReader* reader, absl::string_view what);

// The material library, then the names of the materials, whose number stands elsewhere.
void WriteMaterialNames(const MeshAppearance& appearance, ByteWriter* writer);
absl::Status ReadMaterialNames(ByteReader* reader, uint32_t num_materials,
                               MeshAppearance* appearance);

// Which of the optional lists of an appearance are there.
inline constexpr uint32_t kHasCornerTexcoords = 1, kHasFaceMaterials = 2;
uint32_t AppearanceFlags(const MeshAppearance& appearance);
// kInvalidArgument for an unknown flag, and for the flag of a list that would be empty: it would
// give the same content two forms, and two ids.
absl::Status CheckAppearanceFlags(uint32_t flags, uint32_t num_corners, uint32_t num_faces);

// Texture coordinates, then the lists that `flags` name. Indices are not checked: CheckAppearance.
void WriteAppearanceLists(const MeshAppearance& appearance, ByteWriter* writer);
absl::Status ReadAppearanceLists(ByteReader* reader, uint32_t num_texcoords, uint32_t flags,
                                 const Topology& topology, MeshAppearance* appearance);

// Corners per face, then the vertex of every corner; the counts stand elsewhere.
void WriteFaces(const Topology& topology, ByteWriter* writer);
absl::StatusOr<Topology> ReadFaces(ByteReader* reader, uint32_t num_vertices, uint32_t num_faces,
                                   uint32_t num_corners);

// kInvalidArgument unless both are positive and below 2^31.
absl::StatusOr<FrameRate> MakeFrameRate(uint32_t numerator, uint32_t denominator);

}  // namespace pleat
