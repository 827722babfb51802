// Three lines of defense stand around Draco, each for what the one before cannot see:
//
//   1. Our own reading of the header compares the counts with what the stream declared, before
//      Draco sees the bytes and allocates by those counts.
//   2. AttributesAreExpected runs inside Draco (see GuardedDecoder), after it has decoded the
//      connectivity and the declarations of the attributes, and before it allocates and decodes
//      their values.
//   3. ReadPositions and ReadMesh check every index and number afterwards. Sequential meshes with
//      faces beyond their points decode without complaint.
#include "draco_decode.h"

#include "absl/strings/str_cat.h"
#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "draco/compression/mesh/mesh_sequential_decoder.h"
#include "draco/compression/point_cloud/point_cloud_sequential_decoder.h"
#include "draco_guard.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status ExpectCount(uint64_t found, uint64_t expected, absl::string_view what) {
  if (found == expected) return absl::OkStatus();
  return MalformedDraco(absl::StrCat(found, " ", what, ", the stream declared ", expected));
}

// Reads the header and returns the encoding method.
absl::StatusOr<uint8_t> ReadHeader(ByteReader* reader, DracoType type) {
  PLEAT_ASSIGN_OR_RETURN(const DracoHeader header, ReadDracoHeader(reader));
  if (header.type != static_cast<uint8_t>(type)) {
    return MalformedDraco("not the geometry type of this stream");
  }
  if (header.flags != 0) return MalformedDraco("metadata is not part of this stream");
  return header.method;
}

enum class Contents { kPositions, kPositionsAndIds, kResiduals };

bool IsInteger(const draco::PointAttribute& attribute) {
  return attribute.attribute_type() == draco::GeometryAttribute::GENERIC &&
         attribute.data_type() == draco::DT_INT32 && attribute.num_components() == 1;
}

// Says whether the values may be decoded. This check alone bounds the memory that they take.
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

template <typename Decoder, typename Geometry>
absl::Status RunDecoder(std::string_view bytes, int num_points, Contents contents,
                        Geometry* geometry) {
  return RunDracoDecoder<Decoder>(
      bytes,
      [num_points, contents](const draco::PointCloud& cloud) {
        return AttributesAreExpected(cloud, num_points, contents);
      },
      geometry);
}

absl::Status ReadPositions(const draco::PointCloud& cloud, Eigen::Matrix3Xf* positions) {
  const draco::PointAttribute& attribute = *cloud.attribute(0);
  positions->resize(3, cloud.num_points());
  for (uint32_t p = 0; p < cloud.num_points(); ++p) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(p));
    if (index.value() >= attribute.size()) return MalformedDraco("a point without position");
    attribute.GetValue(index, positions->col(p).data());
  }
  if (!positions->allFinite()) return MalformedDraco("a position that is not finite");
  return absl::OkStatus();
}

absl::Status CheckMeshHeader(ByteReader* reader, uint8_t method, int num_points,
                             int num_triangles) {
  PLEAT_ASSIGN_OR_RETURN(const DracoMeshCounts counts, ReadDracoMeshCounts(reader, method));
  if (method == kDracoSequential) {
    PLEAT_RETURN_IF_ERROR(ExpectCount(counts.num_points, num_points, "points"));
  } else if (counts.num_points > static_cast<uint64_t>(num_points)) {
    return MalformedDraco("too many vertices");
  } else if (counts.num_attribute_data > 1) {
    return MalformedDraco("too many attributes");
  }
  return ExpectCount(counts.num_faces, num_triangles, "triangles");
}

absl::Status ReadMesh(const draco::Mesh& mesh, int num_vertices, Eigen::Matrix3Xf* positions,
                      std::vector<int32_t>* point_vertices, Eigen::Matrix3Xi* triangles) {
  PLEAT_RETURN_IF_ERROR(ReadPositions(mesh, positions));
  const draco::PointAttribute& ids = *mesh.attribute(1);
  point_vertices->resize(mesh.num_points());
  for (uint32_t p = 0; p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex index = ids.mapped_index(draco::PointIndex(p));
    if (index.value() >= ids.size()) return MalformedDraco("a point without vertex number");
    int32_t vertex = -1;
    ids.GetValue(index, &vertex);
    if (vertex < 0 || vertex >= num_vertices) return MalformedDraco("a vertex number out of range");
    (*point_vertices)[p] = vertex;
  }
  triangles->resize(3, mesh.num_faces());
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    for (int corner = 0; corner < 3; ++corner) {
      if (face[corner].value() >= mesh.num_points())
        return MalformedDraco("a triangle out of range");
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
  PLEAT_ASSIGN_OR_RETURN(const uint8_t method, ReadHeader(&reader, DracoType::kMesh));
  PLEAT_RETURN_IF_ERROR(CheckMeshHeader(&reader, method, num_points, num_triangles));
  draco::Mesh mesh;
  PLEAT_RETURN_IF_ERROR(method == kDracoEdgebreaker
                            ? RunDecoder<draco::MeshEdgebreakerDecoder>(
                                  bytes, num_points, Contents::kPositionsAndIds, &mesh)
                            : RunDecoder<draco::MeshSequentialDecoder>(
                                  bytes, num_points, Contents::kPositionsAndIds, &mesh));
  PLEAT_RETURN_IF_ERROR(ExpectCount(mesh.num_faces(), num_triangles, "triangles"));
  return ReadMesh(mesh, num_vertices, positions, point_vertices, triangles);
}

namespace {

absl::Status DecodeCloud(std::string_view bytes, int num_points, Contents contents,
                         draco::PointCloud* cloud) {
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const uint8_t method, ReadHeader(&reader, DracoType::kPointCloud));
  if (method != kDracoSequential) return MalformedDraco("not a sequential point cloud");
  PLEAT_ASSIGN_OR_RETURN(const int32_t points, reader.Read<int32_t>("points"));
  if (points < 0) return MalformedDraco("a negative number of points");
  PLEAT_RETURN_IF_ERROR(ExpectCount(points, num_points, "points"));
  return RunDecoder<draco::PointCloudSequentialDecoder>(bytes, num_points, contents, cloud);
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
      if (index.value() >= attribute.size()) return MalformedDraco("a point without residual");
      attribute.GetValue(index, &(*residuals)(c, i));
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
