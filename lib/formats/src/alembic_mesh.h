// The poly meshes and subdivision meshes of an Alembic archive.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "alembic_archive.h"
#include "alembic_properties.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

// The headers of one mesh. What they hold is read by the functions below.
struct AlembicMesh {
  int object = 0;
  bool is_subdivision = false;
  AlembicProperties geometry;  // all of .geom
  AlembicProperty positions, face_indices, face_counts;

  // As many as the property that has the most.
  uint32_t num_samples() const;
};

bool IsAlembicMesh(const AlembicArchive& archive, int object);

// kInvalidArgument when a property is missing or is no array of the right type, or has no sample.
absl::StatusOr<AlembicMesh> ReadAlembicMesh(int object, AlembicArchive* archive);

// kInvalidArgument when sample 0 has no vertex.
absl::StatusOr<int> CountVertices(const AlembicMesh& mesh, const MeshLimits& limits,
                                  AlembicArchive* archive);

// The faces of sample 0, turned around: they run clockwise in the file.
struct AlembicFaces {
  std::vector<int32_t> corner_vertices;
  std::vector<int32_t> face_sizes;
  std::vector<int32_t> corner_sources;  // the number of each corner in the file
  std::vector<int32_t> face_sources;    // the number of each face in the file
  int num_file_faces = 0, num_file_corners = 0;
};

// Leaves out faces of fewer than three corners. kInvalidArgument when counts and corners disagree
// or a corner names no vertex.
absl::StatusOr<AlembicFaces> ReadFaces(const AlembicMesh& mesh, int num_vertices,
                                       const MeshLimits& limits, AlembicArchive* archive);

// kInvalidArgument names the first of the samples whose vertex count or faces are not those of
// sample 0.
absl::Status CheckSameTopology(const AlembicMesh& mesh, int num_vertices, uint32_t num_samples,
                               AlembicArchive* archive);

// Writes sample `sample` of the positions into columns, transformed for row vectors. The identity
// leaves every bit as it is. CheckSameTopology must have passed.
absl::Status ReadPositions(const AlembicMesh& mesh, uint32_t sample,
                           const Eigen::Matrix4d& world_rows, AlembicArchive* archive,
                           Eigen::Ref<Eigen::Matrix3Xf> positions);

}  // namespace pleat
