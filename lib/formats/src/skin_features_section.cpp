#include <array>
#include <span>
#include <utility>
#include <vector>

#include "model_sections.h"
#include "model_versions.h"
#include "planes_section.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"

namespace pleat {
namespace {

void WriteEdges(const SkinEdgesParameters& edges, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(edges.vertices.size()));
  writer->Write(static_cast<uint32_t>(edges.edges.size()));
  writer->WriteArray(std::span<const int32_t>(edges.vertices));
  for (const std::array<int, 2>& edge : edges.edges) {
    writer->WriteArray(std::span<const int32_t>(edge));
  }
  writer->WriteArray(std::span<const float>(edges.lengths));
}

absl::StatusOr<SkinEdgesParameters> ReadEdges(ByteReader* reader) {
  SkinEdgesParameters edges;
  std::array<uint32_t, 2> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "sizes of the skin edges"));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, counts[0], "points of the skin edges", &edges.vertices));
  PLEAT_RETURN_IF_ERROR(reader->Require(counts[1], 2 * sizeof(int32_t), "skin edges"));
  edges.edges.resize(counts[1]);
  for (std::array<int, 2>& edge : edges.edges) {
    PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<int32_t>(edge), "skin edges"));
  }
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, counts[1], "lengths of skin edges", &edges.lengths));
  return edges;
}

absl::StatusOr<SkinFeaturesParameters::Region> ReadRegion(ByteReader* reader, uint32_t version) {
  SkinFeaturesParameters::Region region;
  std::array<uint32_t, 2> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "sizes of a region"));
  const auto [num_edges, num_features] = counts;
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_edges, "edges of a region", &region.edges));
  constexpr const char* kWeights = "weights of a region";
  if (version < kFirstWithPlanes) {  // the floats stand in front of the offset
    PLEAT_ASSIGN_OR_RETURN(region.weights, ReadFloatsAsPlanes(reader, uint64_t{3} * num_edges,
                                                              num_features, kWeights));
  }
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_features, 1, "offset of a region", &region.offset));
  if (version >= kFirstWithPlanes && (num_edges > 0 || num_features > 0)) {
    PLEAT_ASSIGN_OR_RETURN(region.weights, ReadPlaneMatrix(reader, num_features, kWeights));
  }
  return region;
}

}  // namespace

void WriteSkinFeatures(const std::optional<SkinFeatures>& features, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(features.has_value()));
  if (!features) return;
  const SkinFeaturesParameters p = features->parameters();
  WriteEdges(p.edges, writer);
  WriteMatrix(p.center, writer);
  writer->Write(static_cast<uint32_t>(p.regions.size()));
  for (const SkinFeaturesParameters::Region& region : p.regions) {
    writer->Write(static_cast<uint32_t>(region.edges.size()));
    writer->Write(static_cast<uint32_t>(region.offset.size()));
    writer->WriteArray(std::span<const int32_t>(region.edges));
    WriteMatrix(region.offset, writer);
    if (!region.edges.empty()) WritePlaneMatrix(region.weights, writer);
  }
}

absl::StatusOr<std::optional<SkinFeatures>> ReadSkinFeatures(ByteReader* reader, uint32_t version,
                                                             const Rig& rig) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t has_features, reader->Read<uint32_t>("skin feature flag"));
  if (has_features > 1) return absl::InvalidArgumentError("unknown skin feature flag");
  if (has_features == 0) return std::optional<SkinFeatures>();
  SkinFeaturesParameters p;
  PLEAT_ASSIGN_OR_RETURN(p.edges, ReadEdges(reader));
  if (version >= kFirstWithPlanes) {
    PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, uint64_t{3} * p.edges.edges.size(), 1,
                                     "center of the skin edges", &p.center));
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_regions, reader->Read<uint32_t>("region count"));
  PLEAT_RETURN_IF_ERROR(reader->Require(num_regions, 2 * sizeof(uint32_t), "regions"));
  for (uint32_t r = 0; r < num_regions; ++r) {
    PLEAT_ASSIGN_OR_RETURN(SkinFeaturesParameters::Region region, ReadRegion(reader, version));
    p.regions.push_back(std::move(region));
  }
  PLEAT_ASSIGN_OR_RETURN(SkinFeatures features, SkinFeatures::FromParameters(rig, std::move(p)));
  return std::optional<SkinFeatures>(std::move(features));
}

}  // namespace pleat
