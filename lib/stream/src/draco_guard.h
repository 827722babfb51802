// What frames of a stream and Draco files from anywhere have in common: reading the header before
// Draco does, and running a decoder. The layout follows the Draco bitstream specification
// (google.github.io/draco/spec), sections "Draco header", "Sequential decoder" and "EdgeBreaker
// decoder".
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <new>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "draco/compression/config/decoder_options.h"
#include "draco/core/decoder_buffer.h"
#include "draco/point_cloud/point_cloud.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"

namespace pleat {

enum class DracoType : uint8_t { kPointCloud = 0, kMesh = 1 };
// Encoding methods. The meaning of 1 depends on the geometry type.
inline constexpr uint8_t kDracoSequential = 0;   // meshes and point clouds
inline constexpr uint8_t kDracoEdgebreaker = 1;  // meshes
inline constexpr uint8_t kDracoKdTree = 1;       // point clouds

inline absl::Status MalformedDraco(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("malformed Draco frame: ", why));
}

struct DracoHeader {
  uint8_t major = 0, minor = 0, type = 0, method = 0;
  uint16_t flags = 0;
  bool has_metadata() const { return (flags & 0x8000) != 0; }
};

// Reads the first 11 bytes.
inline absl::StatusOr<DracoHeader> ReadDracoHeader(ByteReader* reader) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view magic, reader->ReadRaw(5, "Draco magic"));
  if (magic != "DRACO") return MalformedDraco("no Draco header");
  DracoHeader header;
  PLEAT_ASSIGN_OR_RETURN(header.major, reader->Read<uint8_t>("Draco header"));
  PLEAT_ASSIGN_OR_RETURN(header.minor, reader->Read<uint8_t>("Draco header"));
  PLEAT_ASSIGN_OR_RETURN(header.type, reader->Read<uint8_t>("Draco header"));
  PLEAT_ASSIGN_OR_RETURN(header.method, reader->Read<uint8_t>("Draco header"));
  PLEAT_ASSIGN_OR_RETURN(header.flags, reader->Read<uint16_t>("Draco flags"));
  // Draco has written these versions of the bitstream since its release 1.1.
  const uint8_t minor = header.type == static_cast<uint8_t>(DracoType::kMesh) ? 2 : 3;
  const bool is_older = header.major < 2 || (header.major == 2 && header.minor < minor);
  if (is_older) {
    return absl::DataLossError(absl::StrCat("Draco bitstream ", header.major, ".", header.minor,
                                            " is too old, encode again with Draco 1.x"));
  }
  if (header.major != 2 || header.minor != minor) {
    return absl::DataLossError(absl::StrCat("Draco bitstream ", header.major, ".", header.minor,
                                            " is newer than 2.", minor,
                                            ", the last that is known"));
  }
  return header;
}

inline absl::StatusOr<uint64_t> ReadDracoVarint(ByteReader* reader, absl::string_view what) {
  uint64_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    PLEAT_ASSIGN_OR_RETURN(const uint8_t byte, reader->Read<uint8_t>(what));
    value |= static_cast<uint64_t>(byte & 0x7f) << shift;
    if ((byte & 0x80) == 0) return value;
  }
  return MalformedDraco(absl::StrCat(what, " is too long"));
}

// The counts that follow the header of a mesh.
struct DracoMeshCounts {
  uint64_t num_points = 0;  // for edgebreaker: the encoded vertices, before it splits any
  uint64_t num_faces = 0;
  uint8_t num_attribute_data = 0;  // edgebreaker only
};
inline absl::StatusOr<DracoMeshCounts> ReadDracoMeshCounts(ByteReader* reader, uint8_t method) {
  DracoMeshCounts counts;
  if (method == kDracoEdgebreaker) {
    PLEAT_ASSIGN_OR_RETURN(const uint8_t traversal, reader->Read<uint8_t>("traversal type"));
    if (traversal > 2) return MalformedDraco("unknown traversal type");
    PLEAT_ASSIGN_OR_RETURN(counts.num_points, ReadDracoVarint(reader, "vertices"));
    PLEAT_ASSIGN_OR_RETURN(counts.num_faces, ReadDracoVarint(reader, "faces"));
    PLEAT_ASSIGN_OR_RETURN(counts.num_attribute_data, reader->Read<uint8_t>("attribute data"));
    return counts;
  }
  if (method != kDracoSequential) return MalformedDraco("unknown mesh encoding method");
  PLEAT_ASSIGN_OR_RETURN(counts.num_faces, ReadDracoVarint(reader, "faces"));
  PLEAT_ASSIGN_OR_RETURN(counts.num_points, ReadDracoVarint(reader, "points"));
  return counts;
}

// Says whether the declared attributes may be decoded.
using AttributeCheck = std::function<bool(const draco::PointCloud&)>;

// A Draco decoder that looks at the declared attributes before it decodes their values.
// DecodeAllAttributes is the one hook between the two: Draco calls it when the declarations have
// been read and nothing has been allocated for the values.
template <typename Decoder>
class GuardedDecoder final : public Decoder {
 public:
  explicit GuardedDecoder(AttributeCheck check) : check_(std::move(check)) {}

 protected:
  bool DecodeAllAttributes() override {
    return check_(*this->point_cloud()) && Decoder::DecodeAllAttributes();
  }

 private:
  AttributeCheck check_;
};

// Decodes `bytes` into `geometry`. Draco reports most damage by its status, and some by exceptions
// of the standard library, which end here: kDataLoss, or kResourceExhausted when memory ran out.
template <typename Decoder, typename Geometry>
absl::Status RunDracoDecoder(std::string_view bytes, AttributeCheck check, Geometry* geometry) {
  GuardedDecoder<Decoder> decoder(std::move(check));
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  try {
    const draco::Status status = decoder.Decode(options, &buffer, geometry);
    if (!status.ok()) return MalformedDraco(status.error_msg_string());
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("a Draco frame needs more memory than it is allowed");
  } catch (const std::exception&) {  // std::length_error
    return MalformedDraco("it declares more than memory can hold");
  }
  return absl::OkStatus();
}

}  // namespace pleat
