// Small Alembic archives for tests, put together from parts.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alembic_archive.h"
#include "alembic_builder.h"

namespace pleat {

template <typename T>
PropertyToWrite ArrayProperty(AlembicBuilder* builder, const std::string& name, AlembicType type,
                              int extent, const std::vector<std::vector<T>>& samples,
                              uint32_t sampling = 0, AlembicKind kind = AlembicKind::kArray) {
  PropertyToWrite property = {
      .name = name, .kind = kind, .type = type, .extent = extent, .time_sampling = sampling};
  for (const std::vector<T>& values : samples) {
    property.samples.push_back(builder->AddSample(std::span<const T>(values)));
  }
  return property;
}

// A mesh before it is written. Faces run clockwise, as in the file.
struct SceneMesh {
  std::string name = "mesh";
  std::string schema = std::string(kPolyMeshSchema);
  std::vector<std::vector<float>> frames = {};  // x y z x y z ...
  std::vector<std::vector<int32_t>> counts = {{4}};
  std::vector<std::vector<int32_t>> indices = {{0, 1, 2, 3}};
  uint32_t sampling = 0;
  std::vector<PropertyToWrite> more = {};
  std::vector<ObjectToWrite> children = {};
};

// A square in the plane z = `height`.
inline std::vector<float> Square(float height) {
  return {0, 0, height, 1, 0, height, 1, 1, height, 0, 1, height};
}

inline ObjectToWrite MeshObject(AlembicBuilder* builder, SceneMesh mesh) {
  PropertyToWrite geometry = {.name = ".geom", .metadata = "schema=" + mesh.schema};
  geometry.properties.push_back(
      ArrayProperty(builder, "P", AlembicType::kFloat32, 3, mesh.frames, mesh.sampling));
  geometry.properties.push_back(
      ArrayProperty(builder, ".faceIndices", AlembicType::kInt32, 1, mesh.indices, mesh.sampling));
  geometry.properties.push_back(
      ArrayProperty(builder, ".faceCounts", AlembicType::kInt32, 1, mesh.counts, mesh.sampling));
  for (PropertyToWrite& property : mesh.more) geometry.properties.push_back(std::move(property));
  return {.name = mesh.name,
          .metadata = "schema=" + mesh.schema + ";schemaObjTitle=" + mesh.schema + ":.geom",
          .properties = {std::move(geometry)},
          .children = std::move(mesh.children)};
}

struct SceneXform {
  std::string name = "xform";
  std::vector<uint8_t> operations = {};
  std::vector<std::vector<double>> samples = {};  // the numbers of all operations
  uint32_t sampling = 0;
  std::vector<std::vector<uint8_t>> inherits = {{1}};
  std::vector<ObjectToWrite> children = {};
};

inline ObjectToWrite XformObject(AlembicBuilder* builder, SceneXform xform) {
  PropertyToWrite compound = {.name = ".xform", .metadata = "schema=AbcGeom_Xform_v3"};
  compound.properties.push_back(ArrayProperty(builder, ".inherits", AlembicType::kBool, 1,
                                              xform.inherits, xform.sampling,
                                              AlembicKind::kScalar));
  if (!xform.operations.empty()) {
    compound.properties.push_back(ArrayProperty<uint8_t>(
        builder, ".ops", AlembicType::kUint8, static_cast<int>(xform.operations.size()),
        {xform.operations}, 0, AlembicKind::kScalar));
    compound.properties.push_back(ArrayProperty(
        builder, ".vals", AlembicType::kFloat64, static_cast<int>(xform.samples[0].size()),
        xform.samples, xform.sampling, AlembicKind::kScalar));
  }
  return {.name = xform.name,
          .metadata = "schema=AbcGeom_Xform_v3;schemaObjTitle=AbcGeom_Xform_v3:.xform",
          .properties = {std::move(compound)},
          .children = std::move(xform.children)};
}

inline ObjectToWrite FaceSetObject(AlembicBuilder* builder, const std::string& name,
                                   const std::vector<std::vector<int32_t>>& samples) {
  PropertyToWrite set = {.name = ".faceset"};
  set.properties.push_back(ArrayProperty(builder, ".faces", AlembicType::kInt32, 1, samples));
  return {.name = name, .metadata = "schema=AbcGeom_FaceSet_v1", .properties = {std::move(set)}};
}

// A time sampling of `fps`, from `start`.
inline AlembicTimeSampling Uniform(double fps, double start = 0) { return {1 / fps, {start}}; }

}  // namespace pleat
