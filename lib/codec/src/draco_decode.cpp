// Header layout: Draco bitstream specification (google.github.io/draco/spec), sections "Draco
// header", "Sequential decoder" and "EdgeBreaker decoder".
#include "draco_decode.h"

#include <cstring>
#include <exception>
#include <memory>

#include "absl/strings/str_cat.h"
#include "draco/compression/config/decoder_options.h"
#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "draco/compression/mesh/mesh_sequential_decoder.h"
#include "draco/compression/point_cloud/point_cloud_sequential_decoder.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr uint8_t kPointCloudType = 0, kMeshType = 1;
constexpr uint8_t kSequentialMethod = 0, kEdgebreakerMethod = 1;

absl::Status Malformed(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("malformed Draco frame: ", why));
}

absl::StatusOr<uint64_t> ReadVarint(ByteReader* reader, absl::string_view what) {
  uint64_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    PLEAT_ASSIGN_OR_RETURN(const uint8_t byte, reader->Read<uint8_t>(what));
    value |= static_cast<uint64_t>(byte & 0x7f) << shift;
    if ((byte & 0x80) == 0) return value;
  }
  return Malformed(absl::StrCat(what, " is too long"));
}

absl::Status ExpectCount(uint64_t found, uint64_t expected, absl::string_view what) {
  if (found == expected) return absl::OkStatus();
  return Malformed(absl::StrCat(found, " ", what, ", the stream declared ", expected));
}

// Reads the 11 header bytes; returns the encoding method.
absl::StatusOr<uint8_t> ReadHeader(ByteReader* reader, uint8_t type, uint8_t minor_version) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view magic, reader->ReadRaw(5, "Draco magic"));
  if (magic != "DRACO") return Malformed("no Draco header");
  uint8_t fields[4];
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint8_t>(fields), "Draco header"));
  PLEAT_ASSIGN_OR_RETURN(const uint16_t flags, reader->Read<uint16_t>("Draco flags"));
  if (fields[0] != 2 || fields[1] != minor_version) {
    return Malformed(absl::StrCat("bitstream version ", fields[0], ".", fields[1]));
  }
  if (fields[2] != type) return Malformed("not the geometry type of this stream");
  if (flags != 0) return Malformed("metadata is not part of this stream");
  return fields[3];
}

enum class Contents { kPositions, kPositionsAndIds, kResiduals };

bool IsInteger(const draco::PointAttribute& attribute) {
  return attribute.attribute_type() == draco::GeometryAttribute::GENERIC &&
         attribute.data_type() == draco::DT_INT32 && attribute.num_components() == 1;
}

// What must hold before attribute values are decoded: this alone bounds Draco's memory.
bool AttributesAreExpected(const draco::PointCloud& cloud, uint32_t num_points, Contents contents) {
  if (cloud.num_points() != num_points) return false;
  if (contents == Contents::kResiduals) {
    return cloud.num_attributes() == 3 && IsInteger(*cloud.attribute(0)) &&
           IsInteger(*cloud.attribute(1)) && IsInteger(*cloud.attribute(2));
  }
  const bool with_ids = contents == Contents::kPositionsAndIds;
  if (cloud.num_attributes() != (with_ids ? 2 : 1)) return false;
  const draco::PointAttribute& position = *cloud.attribute(0);
  if (position.attribute_type() != draco::GeometryAttribute::POSITION ||
      position.data_type() != draco::DT_FLOAT32 || position.num_components() != 3) {
    return false;
  }
  return !with_ids || IsInteger(*cloud.attribute(1));
}

// A Draco decoder that looks at the declared attributes before it decodes their values.
template <typename Decoder>
class Guarded final : public Decoder {
 public:
  Guarded(int num_points, Contents contents) : num_points_(num_points), contents_(contents) {}

 protected:
  bool DecodeAllAttributes() override {
    return AttributesAreExpected(*this->point_cloud(), num_points_, contents_) &&
           Decoder::DecodeAllAttributes();
  }

 private:
  uint32_t num_points_;
  Contents contents_;
};

template <typename Decoder, typename Geometry>
absl::Status Run(std::string_view bytes, int num_points, Contents contents, Geometry* geometry) {
  Guarded<Decoder> decoder(num_points, contents);
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  try {
    const draco::Status status = decoder.Decode(options, &buffer, geometry);
    if (!status.ok()) return Malformed(status.error_msg_string());
  } catch (const std::exception& error) {  // std::bad_alloc, std::length_error
    return Malformed(error.what());
  }
  return absl::OkStatus();
}

absl::Status ReadPositions(const draco::PointCloud& cloud, Eigen::Matrix3Xf* positions) {
  const draco::PointAttribute& attribute = *cloud.attribute(0);
  positions->resize(3, cloud.num_points());
  for (uint32_t p = 0; p < cloud.num_points(); ++p) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(p));
    if (index.value() >= attribute.size()) return Malformed("a point without position");
    attribute.GetValue(index, positions->col(p).data());
  }
  if (!positions->allFinite()) return Malformed("a position that is not finite");
  return absl::OkStatus();
}

absl::Status CheckEdgebreakerHeader(ByteReader* reader, int num_points, int num_triangles) {
  PLEAT_ASSIGN_OR_RETURN(const uint8_t traversal, reader->Read<uint8_t>("traversal type"));
  if (traversal > 2) return Malformed("unknown traversal type");
  PLEAT_ASSIGN_OR_RETURN(const uint64_t num_vertices, ReadVarint(reader, "vertices"));
  PLEAT_ASSIGN_OR_RETURN(const uint64_t num_faces, ReadVarint(reader, "faces"));
  PLEAT_ASSIGN_OR_RETURN(const uint8_t num_data, reader->Read<uint8_t>("attribute data"));
  if (num_vertices > static_cast<uint64_t>(num_points)) return Malformed("too many vertices");
  if (num_data > 1) return Malformed("too many attributes");
  return ExpectCount(num_faces, num_triangles, "triangles");
}

absl::Status CheckSequentialMeshHeader(ByteReader* reader, int num_points, int num_triangles) {
  PLEAT_ASSIGN_OR_RETURN(const uint64_t num_faces, ReadVarint(reader, "faces"));
  PLEAT_ASSIGN_OR_RETURN(const uint64_t points, ReadVarint(reader, "points"));
  PLEAT_RETURN_IF_ERROR(ExpectCount(points, num_points, "points"));
  return ExpectCount(num_faces, num_triangles, "triangles");
}

absl::Status ReadMesh(const draco::Mesh& mesh, int num_vertices, Eigen::Matrix3Xf* positions,
                      std::vector<int32_t>* point_vertices, Eigen::Matrix3Xi* triangles) {
  PLEAT_RETURN_IF_ERROR(ReadPositions(mesh, positions));
  const draco::PointAttribute& ids = *mesh.attribute(1);
  point_vertices->resize(mesh.num_points());
  for (uint32_t p = 0; p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex index = ids.mapped_index(draco::PointIndex(p));
    if (index.value() >= ids.size()) return Malformed("a point without vertex number");
    int32_t vertex = -1;
    ids.GetValue(index, &vertex);
    if (vertex < 0 || vertex >= num_vertices) return Malformed("a vertex number out of range");
    (*point_vertices)[p] = vertex;
  }
  triangles->resize(3, mesh.num_faces());
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    for (int corner = 0; corner < 3; ++corner) {
      if (face[corner].value() >= mesh.num_points()) return Malformed("a triangle out of range");
      (*triangles)(corner, f) = static_cast<int>(face[corner].value());
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status DecodeDracoMesh(std::string_view bytes, int num_points, int num_triangles,
                             int num_vertices, Eigen::Matrix3Xf* positions,
                             std::vector<int32_t>* point_vertices, Eigen::Matrix3Xi* triangles) {
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const uint8_t method, ReadHeader(&reader, kMeshType, 2));
  draco::Mesh mesh;
  if (method == kEdgebreakerMethod) {
    PLEAT_RETURN_IF_ERROR(CheckEdgebreakerHeader(&reader, num_points, num_triangles));
    PLEAT_RETURN_IF_ERROR(
        Run<draco::MeshEdgebreakerDecoder>(bytes, num_points, Contents::kPositionsAndIds, &mesh));
  } else if (method == kSequentialMethod) {
    PLEAT_RETURN_IF_ERROR(CheckSequentialMeshHeader(&reader, num_points, num_triangles));
    PLEAT_RETURN_IF_ERROR(
        Run<draco::MeshSequentialDecoder>(bytes, num_points, Contents::kPositionsAndIds, &mesh));
  } else {
    return Malformed("unknown mesh encoding method");
  }
  PLEAT_RETURN_IF_ERROR(ExpectCount(mesh.num_faces(), num_triangles, "triangles"));
  return ReadMesh(mesh, num_vertices, positions, point_vertices, triangles);
}

namespace {

absl::Status DecodeCloud(std::string_view bytes, int num_points, Contents contents,
                         draco::PointCloud* cloud) {
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const uint8_t method, ReadHeader(&reader, kPointCloudType, 3));
  if (method != kSequentialMethod) return Malformed("not a sequential point cloud");
  PLEAT_ASSIGN_OR_RETURN(const int32_t points, reader.Read<int32_t>("points"));
  if (points < 0) return Malformed("a negative number of points");
  PLEAT_RETURN_IF_ERROR(ExpectCount(points, num_points, "points"));
  return Run<draco::PointCloudSequentialDecoder>(bytes, num_points, contents, cloud);
}

}  // namespace

absl::Status DecodeDracoPointCloud(std::string_view bytes, int num_points,
                                   Eigen::Matrix3Xf* positions) {
  draco::PointCloud cloud;
  PLEAT_RETURN_IF_ERROR(DecodeCloud(bytes, num_points, Contents::kPositions, &cloud));
  return ReadPositions(cloud, positions);
}

absl::Status DecodeDracoResiduals(std::string_view bytes, int num_points,
                                  Eigen::Matrix3Xi* residuals) {
  draco::PointCloud cloud;
  PLEAT_RETURN_IF_ERROR(DecodeCloud(bytes, num_points, Contents::kResiduals, &cloud));
  residuals->resize(3, num_points);
  for (int c = 0; c < 3; ++c) {
    const draco::PointAttribute& attribute = *cloud.attribute(c);
    for (int i = 0; i < num_points; ++i) {
      const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
      if (index.value() >= attribute.size()) return Malformed("a point without residual");
      attribute.GetValue(index, &(*residuals)(c, i));
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
