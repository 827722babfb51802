#include "alembic_mesh.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <unordered_set>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

size_t PointBytes(const AlembicMesh& mesh) {
  return mesh.positions.type == AlembicType::kFloat64 ? 24 : 12;
}

bool IsPoints(const AlembicProperty& property) {
  return property.Is(AlembicKind::kArray, AlembicType::kFloat32, 3) ||
         property.Is(AlembicKind::kArray, AlembicType::kFloat64, 3);
}

bool IsIntegers(const AlembicProperty& property) {
  return property.Is(AlembicKind::kArray, AlembicType::kInt32, 1) ||
         property.Is(AlembicKind::kArray, AlembicType::kUint32, 1);
}

absl::StatusOr<AlembicProperty> FindArray(const AlembicProperties& properties,
                                          std::string_view name,
                                          bool (*is_right)(const AlembicProperty&)) {
  const AlembicProperty* property = properties.Find(name);
  if (property == nullptr || property->num_samples == 0) {
    return absl::InvalidArgumentError(absl::StrCat("the mesh has no '", std::string(name), "'"));
  }
  if (!is_right(*property)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", std::string(name), "' of the mesh is of type ", static_cast<int>(property->type), "[",
        property->extent, "], which is not read (docs/formats/alembic.md)"));
  }
  return *property;
}

absl::StatusOr<std::vector<int32_t>> ReadIntegers(const AlembicProperty& property,
                                                  AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, ReadSampleValues(property, 0, archive));
  std::vector<int32_t> values(bytes.size() / sizeof(int32_t));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

// The first sample whose content is another than that of sample 0, `num_samples` when there is
// none. Only the size counts for the positions.
absl::StatusOr<uint32_t> FirstOtherSample(const AlembicProperty& property, bool size_only,
                                          uint32_t num_samples, AlembicArchive* archive) {
  num_samples = std::min(num_samples, property.num_samples);
  if (!property.changes()) return num_samples;
  const uint32_t num_stored = std::min(num_samples, property.last_changed + 1);
  PLEAT_ASSIGN_OR_RETURN(const std::string_view first, ReadSampleValues(property, 0, archive));
  std::unordered_set<uint64_t> same;  // places that were compared
  for (uint32_t sample = 1; sample < num_stored; ++sample) {
    PLEAT_ASSIGN_OR_RETURN(const OgawaRef ref, FindSample(property, sample, *archive));
    if (same.contains(ref.bits)) continue;
    PLEAT_ASSIGN_OR_RETURN(const std::string_view other, ReadValues(property, ref, archive));
    if (other.size() != first.size() || (!size_only && other != first)) return sample;
    same.insert(ref.bits);
  }
  return num_samples;
}

void CopyPoints(const AlembicMesh& mesh, std::string_view bytes,
                Eigen::Ref<Eigen::Matrix3Xf> positions) {
  if (mesh.positions.type == AlembicType::kFloat32) {
    std::memcpy(positions.data(), bytes.data(), bytes.size());
    return;
  }
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    double point[3];
    std::memcpy(point, bytes.data() + v * 24, 24);
    for (int i = 0; i < 3; ++i) positions(i, v) = static_cast<float>(point[i]);
  }
}

// Point v in double precision.
Eigen::Vector3d PointAt(const AlembicMesh& mesh, std::string_view bytes, Eigen::Index v) {
  if (mesh.positions.type == AlembicType::kFloat64) {
    Eigen::Vector3d point;
    std::memcpy(point.data(), bytes.data() + v * 24, 24);
    return point;
  }
  Eigen::Vector3f point;
  std::memcpy(point.data(), bytes.data() + v * 12, 12);
  return point.cast<double>();
}

}  // namespace

uint32_t AlembicMesh::num_samples() const {
  return std::max({positions.num_samples, face_indices.num_samples, face_counts.num_samples});
}

bool IsAlembicMesh(const AlembicArchive& archive, int object) {
  const std::string_view schema = archive.schema(object);
  return schema == kPolyMeshSchema || schema == kSubdivisionSchema;
}

absl::StatusOr<AlembicMesh> ReadAlembicMesh(int object, AlembicArchive* archive) {
  AlembicMesh mesh;
  mesh.object = object;
  mesh.is_subdivision = archive->schema(object) == kSubdivisionSchema;
  PLEAT_ASSIGN_OR_RETURN(const AlembicProperties all,
                         AlembicProperties::Read(archive->objects()[object].properties, archive));
  PLEAT_ASSIGN_OR_RETURN(mesh.geometry, all.Compound(".geom", archive));
  PLEAT_ASSIGN_OR_RETURN(mesh.positions, FindArray(mesh.geometry, "P", IsPoints));
  PLEAT_ASSIGN_OR_RETURN(mesh.face_indices, FindArray(mesh.geometry, ".faceIndices", IsIntegers));
  PLEAT_ASSIGN_OR_RETURN(mesh.face_counts, FindArray(mesh.geometry, ".faceCounts", IsIntegers));
  return mesh;
}

absl::StatusOr<int> CountVertices(const AlembicMesh& mesh, const MeshLimits& limits,
                                  AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes,
                         ReadSampleValues(mesh.positions, 0, archive));
  const size_t num_vertices = bytes.size() / PointBytes(mesh);
  if (num_vertices == 0) return absl::InvalidArgumentError("the mesh has no vertices");
  const MeshCounts counts = {.num_vertices = static_cast<int64_t>(num_vertices)};
  PLEAT_RETURN_IF_ERROR(CheckCounts(counts, limits));
  return static_cast<int>(num_vertices);
}

absl::StatusOr<AlembicFaces> ReadFaces(const AlembicMesh& mesh, int num_vertices,
                                       const MeshLimits& limits, AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<int32_t> counts,
                         ReadIntegers(mesh.face_counts, archive));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<int32_t> indices,
                         ReadIntegers(mesh.face_indices, archive));
  const MeshCounts size = {.num_vertices = num_vertices,
                           .num_faces = static_cast<int64_t>(counts.size())};
  PLEAT_RETURN_IF_ERROR(CheckCounts(size, limits));
  if (indices.size() > std::numeric_limits<int32_t>::max()) {
    return absl::ResourceExhaustedError(absl::StrCat(indices.size(), " corners are too many"));
  }
  AlembicFaces faces;
  faces.num_file_faces = static_cast<int>(counts.size());
  faces.num_file_corners = static_cast<int>(indices.size());
  size_t begin = 0;
  for (size_t f = 0; f < counts.size(); ++f) {
    const int32_t count = counts[f];
    if (count < 0 || static_cast<size_t>(count) > indices.size() - begin) {
      return absl::InvalidArgumentError(absl::StrCat("face ", f, " declares ", count,
                                                     " corners but ", indices.size() - begin,
                                                     " are left in .faceIndices"));
    }
    for (size_t c = begin + count; count >= 3 && c-- > begin;) {
      if (indices[c] < 0 || indices[c] >= num_vertices) {
        return absl::InvalidArgumentError(absl::StrCat("face ", f, " names vertex ", indices[c],
                                                       " of ", num_vertices, " vertices"));
      }
      faces.corner_vertices.push_back(indices[c]);
      faces.corner_sources.push_back(static_cast<int32_t>(c));
    }
    if (count >= 3) {
      faces.face_sizes.push_back(count);
      faces.face_sources.push_back(static_cast<int32_t>(f));
    }
    begin += count;
  }
  if (begin == indices.size()) return faces;
  return absl::InvalidArgumentError(
      absl::StrCat("the faces have ", begin, " corners but ", ".faceIndices has ", indices.size()));
}

absl::Status CheckSameTopology(const AlembicMesh& mesh, int num_vertices, uint32_t num_samples,
                               AlembicArchive* archive) {
  const struct {
    const AlembicProperty& property;
    bool size_only;
    const char* what;
  } kParts[] = {{mesh.positions, true, "another number of vertices"},
                {mesh.face_counts, false, "other faces"},
                {mesh.face_indices, false, "other faces"}};
  uint32_t first = num_samples;
  const char* what = "";
  for (const auto& part : kParts) {
    PLEAT_ASSIGN_OR_RETURN(const uint32_t other,
                           FirstOtherSample(part.property, part.size_only, num_samples, archive));
    if (other >= std::min(first, std::min(num_samples, part.property.num_samples))) continue;
    first = other;
    what = part.what;
  }
  if (first == num_samples) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "the topology changes: frame ", first, " has ", what, " than frame 0 (", num_vertices,
      " vertices); a sequence has the same vertices and faces in all frames, so export the frames ",
      "before, or an object that keeps its topology"));
}

absl::Status ReadPositions(const AlembicMesh& mesh, uint32_t sample,
                           const Eigen::Matrix4d& world_rows, AlembicArchive* archive,
                           Eigen::Ref<Eigen::Matrix3Xf> positions) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes,
                         ReadSampleValues(mesh.positions, sample, archive));
  if (bytes.size() != static_cast<size_t>(positions.cols()) * PointBytes(mesh)) {
    return absl::DataLossError(absl::StrCat("sample ", sample, " of the positions has ",
                                            bytes.size(), " bytes for ", positions.cols(),
                                            " vertices"));
  }
  if (world_rows.isIdentity(0)) {
    CopyPoints(mesh, bytes, positions);
    return absl::OkStatus();
  }
  const Eigen::Matrix4d& m = world_rows;
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const Eigen::Vector3d p = PointAt(mesh, bytes, v);
    double sums[4];  // in the order of the reference library, for the same last bits
    for (int k = 0; k < 4; ++k) {
      sums[k] = p.x() * m(0, k) + p.y() * m(1, k) + p.z() * m(2, k) + m(3, k);
    }
    for (int k = 0; k < 3; ++k) positions(k, v) = static_cast<float>(sums[k] / sums[3]);
  }
  return absl::OkStatus();
}

}  // namespace pleat
