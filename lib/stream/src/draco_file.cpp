#include "pleat/stream/draco_file.h"

#include <algorithm>
#include <memory>

#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "draco/compression/mesh/mesh_sequential_decoder.h"
#include "draco/compression/point_cloud/point_cloud_kd_tree_decoder.h"
#include "draco/compression/point_cloud/point_cloud_sequential_decoder.h"
#include "draco_guard.h"
#include "pleat/base/foreign_file.h"

namespace pleat {
namespace {

constexpr int kMaxAttributes = 64;
constexpr int kMaxComponents = 16;

absl::Status CheckLimit(uint64_t count, int64_t limit, absl::string_view what) {
  if (count <= static_cast<uint64_t>(limit)) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the Draco file declares ", count, " ", what, ", the limit is ", limit));
}

// Says whether the values may be decoded. Edgebreaker may split vertices, so a mesh can have more
// points than vertices; twice as many is generous.
bool AttributesAreSmall(const draco::PointCloud& cloud, const MeshLimits& limits) {
  if (int64_t{cloud.num_points()} > 2 * limits.max_vertices) return false;
  if (cloud.num_attributes() > kMaxAttributes) return false;
  for (int a = 0; a < cloud.num_attributes(); ++a) {
    if (cloud.attribute(a)->num_components() > kMaxComponents) return false;
  }
  return true;
}

absl::StatusOr<const draco::PointAttribute*> FindPositions(const draco::PointCloud& cloud) {
  const draco::PointAttribute* positions =
      cloud.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr || positions->num_components() != 3) {
    return MalformedDraco("no positions of three coordinates");
  }
  // ConvertValue reads each byte of such an attribute as a C++ bool, which is undefined for any
  // byte but 0 and 1, and no program writes positions that are true or false.
  if (positions->data_type() == draco::DT_BOOL) {
    return MalformedDraco("positions that are true or false");
  }
  return positions;
}

// Returns the first int32 generic attribute of one component, or null when there is none.
const draco::PointAttribute* FindNumbers(const draco::PointCloud& cloud) {
  for (int a = 0; a < cloud.num_attributes(); ++a) {
    const draco::PointAttribute* attribute = cloud.attribute(a);
    if (attribute->attribute_type() == draco::GeometryAttribute::GENERIC &&
        attribute->data_type() == draco::DT_INT32 && attribute->num_components() == 1) {
      return attribute;
    }
  }
  return nullptr;
}

absl::StatusOr<uint32_t> ValueOf(const draco::PointAttribute& attribute, uint32_t point) {
  const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(point));
  if (index.value() >= attribute.size()) return MalformedDraco("a point without its value");
  return index.value();
}

// Fills column `column` of the positions with the value `index` of the attribute.
absl::Status ReadPosition(const draco::PointAttribute& attribute, uint32_t index, int column,
                          DracoGeometry* geometry) {
  if (!attribute.ConvertValue<float>(draco::AttributeValueIndex(index), 3,
                                     geometry->positions.col(column).data())) {
    return MalformedDraco("a position that is no number");
  }
  return absl::OkStatus();
}

absl::StatusOr<DracoGeometry> FromPointCloud(const draco::PointCloud& cloud) {
  PLEAT_ASSIGN_OR_RETURN(const draco::PointAttribute* positions, FindPositions(cloud));
  DracoGeometry geometry;
  geometry.positions.resize(3, cloud.num_points());
  for (uint32_t p = 0; p < cloud.num_points(); ++p) {
    PLEAT_ASSIGN_OR_RETURN(const uint32_t index, ValueOf(*positions, p));
    PLEAT_RETURN_IF_ERROR(ReadPosition(*positions, index, static_cast<int>(p), &geometry));
  }
  return geometry;
}

absl::StatusOr<DracoGeometry> FromMesh(const draco::Mesh& mesh) {
  PLEAT_ASSIGN_OR_RETURN(const draco::PointAttribute* positions, FindPositions(mesh));
  const draco::PointAttribute* numbers = FindNumbers(mesh);
  DracoGeometry geometry;
  const auto num_values = static_cast<uint32_t>(positions->size());
  geometry.positions.resize(3, num_values);
  for (uint32_t i = 0; i < num_values; ++i) {
    PLEAT_RETURN_IF_ERROR(ReadPosition(*positions, i, static_cast<int>(i), &geometry));
  }
  if (numbers != nullptr) {
    geometry.vertex_numbers.resize(num_values);
    for (uint32_t p = 0; p < mesh.num_points(); ++p) {
      PLEAT_ASSIGN_OR_RETURN(const uint32_t index, ValueOf(*positions, p));
      PLEAT_ASSIGN_OR_RETURN(const uint32_t number, ValueOf(*numbers, p));
      numbers->GetValue(draco::AttributeValueIndex(number), &geometry.vertex_numbers[index]);
    }
  }
  geometry.triangles.resize(3, mesh.num_faces());
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    for (int corner = 0; corner < 3; ++corner) {
      if (face[corner].value() >= mesh.num_points()) return MalformedDraco("a face out of range");
      PLEAT_ASSIGN_OR_RETURN(const uint32_t index, ValueOf(*positions, face[corner].value()));
      geometry.triangles(corner, f) = static_cast<int>(index);
    }
  }
  return geometry;
}

absl::Status CheckCounts(const DracoHeader& header, const MeshLimits& limits, ByteReader* reader) {
  // Metadata stands before the counts and does not say how long it is, so only Draco can read past
  // it. The checks of the attributes and of the triangles still follow.
  if (header.has_metadata()) return absl::OkStatus();
  if (header.type == static_cast<uint8_t>(DracoType::kMesh)) {
    PLEAT_ASSIGN_OR_RETURN(const DracoMeshCounts counts,
                           ReadDracoMeshCounts(reader, header.method));
    PLEAT_RETURN_IF_ERROR(CheckLimit(counts.num_points, limits.max_vertices, "vertices"));
    return CheckLimit(counts.num_faces, limits.max_faces, "triangles");
  }
  PLEAT_ASSIGN_OR_RETURN(const int32_t num_points, reader->Read<int32_t>("points"));
  if (num_points < 0) return MalformedDraco("a negative number of points");
  return CheckLimit(static_cast<uint64_t>(num_points), limits.max_vertices, "points");
}

}  // namespace

absl::StatusOr<DracoGeometry> DecodeDracoFile(std::string_view bytes, const MeshLimits& limits) {
  if (const std::string other = DescribeForeignBytes(bytes); !other.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("this is ", other));
  }
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const DracoHeader header, ReadDracoHeader(&reader));
  PLEAT_RETURN_IF_ERROR(CheckCounts(header, limits, &reader));
  const AttributeCheck check = [&limits](const draco::PointCloud& cloud) {
    return AttributesAreSmall(cloud, limits);
  };
  if (header.type == static_cast<uint8_t>(DracoType::kMesh)) {
    draco::Mesh mesh;
    PLEAT_RETURN_IF_ERROR(header.method == kDracoEdgebreaker
                              ? RunDracoDecoder<draco::MeshEdgebreakerDecoder>(bytes, check, &mesh)
                              : RunDracoDecoder<draco::MeshSequentialDecoder>(bytes, check, &mesh));
    PLEAT_RETURN_IF_ERROR(CheckLimit(mesh.num_faces(), limits.max_faces, "triangles"));
    return FromMesh(mesh);
  }
  draco::PointCloud cloud;
  PLEAT_RETURN_IF_ERROR(
      header.method == kDracoKdTree
          ? RunDracoDecoder<draco::PointCloudKdTreeDecoder>(bytes, check, &cloud)
          : RunDracoDecoder<draco::PointCloudSequentialDecoder>(bytes, check, &cloud));
  return FromPointCloud(cloud);
}

}  // namespace pleat
