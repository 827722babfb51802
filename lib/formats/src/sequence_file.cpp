#include "pleat/formats/sequence_file.h"

#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "array_io.h"
#include "pleat/base/bytes.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "sealed_file.h"

namespace pleat {
namespace {

constexpr SealedFileKind kKind = {"PLEATSEQ", 1, 1, "sequence file"};
constexpr size_t kMaxNameBytes = 4096;
constexpr uint32_t kHasCornerTexcoords = 1, kHasFaceMaterials = 2;

// Fields 3 to 11.
struct Header {
  uint32_t num_vertices = 0, num_faces = 0, num_corners = 0, num_frames = 0;
  uint32_t rate_numerator = 0, rate_denominator = 0;
  uint32_t num_texcoords = 0, num_materials = 0;
  uint32_t flags = 0;
};
static_assert(sizeof(Header) == 36);

std::span<const float> Coordinates(const std::vector<Eigen::Vector2f>& texcoords) {
  static_assert(sizeof(Eigen::Vector2f) == 2 * sizeof(float));
  return {texcoords.empty() ? nullptr : texcoords[0].data(), texcoords.size() * 2};
}

std::string_view Clip(const std::string& name) {
  return std::string_view(name).substr(0, kMaxNameBytes);
}

Header MakeHeader(const MeshSequence& sequence) {
  const MeshAppearance& appearance = sequence.appearance();
  Header header;
  header.num_vertices = static_cast<uint32_t>(sequence.num_vertices());
  header.num_faces = static_cast<uint32_t>(sequence.topology().num_faces());
  header.num_corners = static_cast<uint32_t>(sequence.topology().num_corners());
  header.num_frames = static_cast<uint32_t>(sequence.num_frames());
  header.rate_numerator = static_cast<uint32_t>(sequence.frame_rate().numerator);
  header.rate_denominator = static_cast<uint32_t>(sequence.frame_rate().denominator);
  header.num_texcoords = static_cast<uint32_t>(appearance.texcoords.size());
  header.num_materials = static_cast<uint32_t>(appearance.material_names.size());
  header.flags = (appearance.corner_texcoords.empty() ? 0 : kHasCornerTexcoords) |
                 (appearance.face_materials.empty() ? 0 : kHasFaceMaterials);
  return header;
}

absl::StatusOr<Header> ReadHeader(ByteReader* reader, const MeshFileLimits& limits) {
  Header header;
  PLEAT_RETURN_IF_ERROR(
      reader->ReadArray(std::span(reinterpret_cast<uint32_t*>(&header), 9), "header"));
  const uint64_t position_bytes = uint64_t{12} * header.num_vertices * header.num_frames;
  if (header.num_vertices > limits.max_vertices || header.num_faces > limits.max_faces ||
      header.num_frames > limits.max_frames || position_bytes > limits.max_sequence_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        header.num_frames, " frames of ", header.num_vertices, " vertices and ", header.num_faces,
        " faces are over the limit of ", limits.max_frames, " frames, ", limits.max_vertices,
        " vertices, ", limits.max_faces, " faces, ", limits.max_sequence_bytes, " bytes"));
  }
  constexpr uint32_t kMaxRate = 0x7fffffff;
  if (header.rate_numerator > kMaxRate || header.rate_denominator > kMaxRate) {
    return absl::InvalidArgumentError("the frame rate is out of range");
  }
  // A flag for an empty list would give one sequence two forms, and two ids.
  const uint32_t known_flags = (header.num_corners > 0 ? kHasCornerTexcoords : 0) |
                               (header.num_faces > 0 ? kHasFaceMaterials : 0);
  if ((header.flags & ~known_flags) != 0) {
    return absl::InvalidArgumentError(absl::StrCat("unknown flags ", header.flags));
  }
  return header;
}

absl::StatusOr<MeshSequenceOptions> ReadNames(ByteReader* reader, const Header& header) {
  MeshSequenceOptions options;
  options.frame_rate = {static_cast<int32_t>(header.rate_numerator),
                        static_cast<int32_t>(header.rate_denominator)};
  PLEAT_ASSIGN_OR_RETURN(options.name, reader->ReadString(kMaxNameBytes, "name"));
  PLEAT_ASSIGN_OR_RETURN(options.appearance.material_library,
                         reader->ReadString(kMaxNameBytes, "material library"));
  PLEAT_RETURN_IF_ERROR(reader->Require(header.num_materials, 4, "material names"));
  for (uint32_t m = 0; m < header.num_materials; ++m) {
    PLEAT_ASSIGN_OR_RETURN(std::string name, reader->ReadString(kMaxNameBytes, "material name"));
    options.appearance.material_names.push_back(std::move(name));
  }
  return options;
}

absl::Status ReadAppearance(ByteReader* reader, const Header& header, MeshAppearance* appearance) {
  std::vector<float> coordinates;
  PLEAT_RETURN_IF_ERROR(
      ReadVector(reader, uint64_t{2} * header.num_texcoords, "texture coordinates", &coordinates));
  for (size_t i = 0; i < coordinates.size(); i += 2) {
    appearance->texcoords.emplace_back(coordinates[i], coordinates[i + 1]);
  }
  if (header.flags & kHasCornerTexcoords) {
    PLEAT_RETURN_IF_ERROR(ReadVector(reader, header.num_corners, "corner texture coordinates",
                                     &appearance->corner_texcoords));
  }
  if (header.flags & kHasFaceMaterials) {
    PLEAT_RETURN_IF_ERROR(
        ReadVector(reader, header.num_faces, "face materials", &appearance->face_materials));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Eigen::Matrix3Xf>> ReadFrames(ByteReader* reader, const Header& header) {
  const uint64_t frame_bytes = uint64_t{12} * header.num_vertices;
  if (frame_bytes == 0) return absl::InvalidArgumentError("the sequence has no vertices");
  PLEAT_RETURN_IF_ERROR(reader->Require(header.num_frames, frame_bytes, "positions"));
  std::vector<Eigen::Matrix3Xf> frames(header.num_frames);
  for (Eigen::Matrix3Xf& frame : frames) {
    frame.resize(3, header.num_vertices);
    PLEAT_RETURN_IF_ERROR(
        reader->ReadArray(std::span(frame.data(), static_cast<size_t>(frame.size())), "positions"));
  }
  if (reader->remaining() != 0) {
    return absl::DataLossError(
        absl::StrCat(reader->remaining(), " bytes too many between positions and checksum"));
  }
  return frames;
}

}  // namespace

std::string EncodeSequence(const MeshSequence& sequence) {
  const MeshAppearance& appearance = sequence.appearance();
  const Topology& topology = sequence.topology();
  const Header header = MakeHeader(sequence);
  ByteWriter writer;
  BeginSealedFile(kKind, &writer);
  writer.WriteArray(std::span(reinterpret_cast<const uint32_t*>(&header), 9));
  writer.WriteString(Clip(sequence.name()));
  writer.WriteString(Clip(appearance.material_library));
  for (const std::string& name : appearance.material_names) writer.WriteString(Clip(name));
  for (int f = 0; f < topology.num_faces(); ++f) {
    writer.Write(static_cast<int32_t>(topology.face(f).size()));
  }
  writer.WriteArray(std::span(topology.corner_vertices()));
  writer.WriteArray(Coordinates(appearance.texcoords));
  writer.WriteArray(std::span(appearance.corner_texcoords));
  writer.WriteArray(std::span(appearance.face_materials));
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    writer.WriteArray(std::span(frame.data(), static_cast<size_t>(frame.size())));
  }
  return SealFile(&writer);
}

absl::StatusOr<MeshSequence> DecodeSequence(std::string_view bytes, const MeshFileLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view content, OpenSealedFile(kKind, bytes));
  ByteReader reader(content.substr(kSealedHeaderBytes));
  PLEAT_ASSIGN_OR_RETURN(const Header header, ReadHeader(&reader, limits));
  PLEAT_ASSIGN_OR_RETURN(MeshSequenceOptions options, ReadNames(&reader, header));
  std::vector<int32_t> face_sizes, corner_vertices;
  PLEAT_RETURN_IF_ERROR(ReadVector(&reader, header.num_faces, "face sizes", &face_sizes));
  PLEAT_RETURN_IF_ERROR(
      ReadVector(&reader, header.num_corners, "corner vertices", &corner_vertices));
  PLEAT_RETURN_IF_ERROR(ReadAppearance(&reader, header, &options.appearance));
  PLEAT_ASSIGN_OR_RETURN(std::vector<Eigen::Matrix3Xf> frames, ReadFrames(&reader, header));
  PLEAT_ASSIGN_OR_RETURN(Topology topology,
                         Topology::Create(static_cast<int>(header.num_vertices),
                                          std::move(corner_vertices), std::move(face_sizes)));
  return MeshSequence::Create(std::move(topology), std::move(frames), std::move(options));
}

absl::StatusOr<MeshSequence> ReadSequenceFile(const std::string& path,
                                              const MeshFileLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  absl::StatusOr<MeshSequence> sequence = DecodeSequence(bytes, limits);
  if (sequence.ok()) return sequence;
  return absl::Status(sequence.status().code(),
                      absl::StrCat(path, ": ", sequence.status().message()));
}

absl::Status WriteSequenceFile(const std::string& path, const MeshSequence& sequence) {
  return WriteFile(path, EncodeSequence(sequence));
}

std::string SequenceId(std::string_view bytes) { return ToHex(ComputeSha256(bytes)); }

}  // namespace pleat
