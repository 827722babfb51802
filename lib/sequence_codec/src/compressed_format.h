// The sections of a compressed sequence (docs/formats/compressed_sequence.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "motion_segment.h"
#include "pleat/base/bytes.h"
#include "pleat/base/sealed_file.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "residual_coder.h"

namespace pleat {

enum class SectionKind : uint8_t {
  kHeader = 1,
  kTopology = 2,
  kAppearance = 3,
  kRest = 4,
  kMotion = 5,
  kGroup = 6,
  kEnd = 7,
  kFaceList = 8,  // the topology in the order of the file, in place of kTopology
};

struct Section {
  SectionKind kind = SectionKind::kEnd;
  std::string_view payload;
};

struct CompressedHeader {
  uint32_t num_vertices = 0, num_faces = 0, num_corners = 0, num_frames = 0;
  FrameRate frame_rate;
  uint32_t num_texcoords = 0, appearance_flags = 0;
  // What is added to every decoded position, for sequences far from the origin of their axes; zero
  // for all others.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  MotionSteps steps;
  ResidualGrid grid;
  std::string name;
  MeshAppearance materials;              // its names alone
  std::vector<uint32_t> segment_frames;  // frames of every segment; their sum is num_frames
};

// Version 1 had no kFaceList.
inline constexpr FileKind kCompressedKind = {"PLEATCMP", 2, 1, "compressed sequence (.plt)"};
inline constexpr int kMaxSegmentFrames = 512;

// First four bytes of the SHA-256.
uint32_t ShortChecksum(std::string_view bytes);
// Of the positions of some frames, as float32.
uint32_t FramesChecksum(const std::vector<Eigen::Matrix3Xf>& frames);

void WriteSection(SectionKind kind, std::string_view payload, ByteWriter* writer);
std::string EncodeHeader(const CompressedHeader& header);

// Magic, version, and every section with its checksum, in the order of the file. kInvalidArgument,
// kDataLoss.
absl::StatusOr<std::vector<Section>> ReadSections(std::string_view bytes);
// All counts are checked against `limits`.
absl::StatusOr<CompressedHeader> DecodeHeader(std::string_view payload, const MeshLimits& limits);

// Texture coordinates and materials; `appearance` has the names already when decoding.
std::string EncodeAppearance(const MeshAppearance& appearance, const Topology& topology);
absl::Status DecodeAppearance(std::string_view payload, const CompressedHeader& header,
                              const Topology& topology, MeshAppearance* appearance);

}  // namespace pleat
