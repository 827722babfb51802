#include "pleat/formats/sequence_file.h"

#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/bytes.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/sealed_file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

constexpr FileKind kSequenceKind = {"PLEATSEQ", 1, 1, "sequence file"};

// Fields 3 to 11 of the file, without padding, so that they can be read at once.
struct Header {
  uint32_t num_vertices = 0, num_faces = 0, num_corners = 0, num_frames = 0;
  uint32_t rate_numerator = 0, rate_denominator = 0;
  uint32_t num_texcoords = 0, num_materials = 0;
  uint32_t flags = 0;
};
static_assert(sizeof(Header) == 36);

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
  header.flags = AppearanceFlags(appearance);
  return header;
}

absl::StatusOr<Header> ReadHeader(ByteReader* reader, const MeshLimits& limits) {
  Header header;
  PLEAT_RETURN_IF_ERROR(
      reader->ReadArray(std::span(reinterpret_cast<uint32_t*>(&header), 9), "header"));
  PLEAT_RETURN_IF_ERROR(CheckSequenceCounts({.num_vertices = header.num_vertices,
                                             .num_faces = header.num_faces,
                                             .num_frames = header.num_frames},
                                            limits));
  PLEAT_RETURN_IF_ERROR(CheckAppearanceFlags(header.flags, header.num_corners, header.num_faces));
  return header;
}

absl::StatusOr<MeshSequenceOptions> ReadNames(ByteReader* reader, const Header& header) {
  MeshSequenceOptions options;
  PLEAT_ASSIGN_OR_RETURN(options.frame_rate,
                         MakeFrameRate(header.rate_numerator, header.rate_denominator));
  PLEAT_ASSIGN_OR_RETURN(options.name, ReadName(reader, "name"));
  PLEAT_RETURN_IF_ERROR(ReadMaterialNames(reader, header.num_materials, &options.appearance));
  return options;
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
  const Header header = MakeHeader(sequence);
  ByteWriter writer;
  WriteFileKind(kSequenceKind, &writer);
  writer.WriteArray(std::span(reinterpret_cast<const uint32_t*>(&header), 9));
  WriteName(sequence.name(), &writer);
  WriteMaterialNames(sequence.appearance(), &writer);
  WriteFaces(sequence.topology(), &writer);
  WriteAppearanceLists(sequence.appearance(), &writer);
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    writer.WriteArray(std::span(frame.data(), static_cast<size_t>(frame.size())));
  }
  return SealFile(&writer);
}

absl::StatusOr<MeshSequence> DecodeSequence(std::string_view bytes, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const SealedFile file, OpenSealedFile(kSequenceKind, bytes));
  ByteReader reader(file.bytes.substr(kFileKindBytes));
  PLEAT_ASSIGN_OR_RETURN(const Header header, ReadHeader(&reader, limits));
  PLEAT_ASSIGN_OR_RETURN(MeshSequenceOptions options, ReadNames(&reader, header));
  PLEAT_ASSIGN_OR_RETURN(Topology topology, ReadFaces(&reader, header.num_vertices,
                                                      header.num_faces, header.num_corners));
  PLEAT_RETURN_IF_ERROR(ReadAppearanceLists(&reader, header.num_texcoords, header.flags, topology,
                                            &options.appearance));
  PLEAT_ASSIGN_OR_RETURN(std::vector<Eigen::Matrix3Xf> frames, ReadFrames(&reader, header));
  return MeshSequence::Create(std::move(topology), std::move(frames), std::move(options));
}

absl::StatusOr<MeshSequence> ReadSequenceFile(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  PLEAT_RETURN_IF_ERROR(RefuseForeignBytes(bytes, path));
  return WithContext(path, DecodeSequence(bytes, limits));
}

absl::Status WriteSequenceFile(const std::string& path, const MeshSequence& sequence) {
  return WriteFile(path, EncodeSequence(sequence));
}

std::string SequenceId(std::string_view bytes) { return ToHex(ComputeSha256(bytes)); }

}  // namespace pleat
