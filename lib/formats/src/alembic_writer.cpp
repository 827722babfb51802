#include "pleat/formats/alembic_writer.h"

#include <algorithm>
#include <limits>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "alembic_builder.h"
#include "pleat/base/file.h"
#include "pleat/base/utf8.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

constexpr char kPointMetadata[] = "geoScope=vtx;interpretation=point";
constexpr char kBoxMetadata[] = "interpretation=box";
constexpr char kTexcoordMetadata[] =
    "arrayExtent=1;geoScope=fvr;interpretation=vector;isGeomParam=true;podExtent=2;"
    "podName=float32_t";

std::string SchemaMetadata(std::string_view schema, bool is_geometry) {
  return absl::StrCat("schema=", std::string(schema),
                      is_geometry ? ";schemaBaseType=AbcGeom_GeomBase_v1" : "");
}

// The metadata of an object names its schema and the compound that holds it.
std::string ObjectMetadata(std::string_view schema, bool is_geometry, const char* compound) {
  return absl::StrCat(SchemaMetadata(schema, is_geometry), ";schemaObjTitle=", std::string(schema),
                      ":", compound);
}

// A name that an object may have: slashes separate the names of a path.
std::string ObjectName(std::string_view name, std::string_view otherwise) {
  constexpr size_t kRoomForSuffix = 32;
  std::string result(Utf8Prefix(name, kMaxNameBytes - kRoomForSuffix));
  std::ranges::replace(result, '/', '_');
  std::ranges::replace(result, '\0', '_');
  return result.empty() ? std::string(otherwise) : result;
}

WrittenSample AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                     AlembicBuilder* builder) {
  const double corners[] = {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
  return builder->AddSample(std::span<const double>(corners));
}

template <typename T>
WrittenSample AddList(const std::vector<T>& values, AlembicBuilder* builder) {
  return builder->AddSample(std::span<const T>(values));
}

// The corners of all faces, each face the other way around. corners: one entry for each corner.
std::vector<int32_t> TurnFaces(const Topology& topology, const std::vector<int32_t>& corners) {
  std::vector<int32_t> turned = corners;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto begin = turned.begin() + topology.face_start(f);
    std::reverse(begin, begin + static_cast<std::ptrdiff_t>(topology.face(f).size()));
  }
  return turned;
}

// `uv`: the values and an index for each corner. A corner without a coordinate gets 0 0.
PropertyToWrite Texcoords(const MeshSequence& sequence, uint32_t sampling,
                          AlembicBuilder* builder) {
  const MeshAppearance& appearance = sequence.appearance();
  std::vector<float> values;
  for (const Eigen::Vector2f& texcoord : appearance.texcoords) {
    values.insert(values.end(), {texcoord.x(), texcoord.y()});
  }
  const auto none = static_cast<int32_t>(appearance.texcoords.size());
  std::vector<int32_t> indices = TurnFaces(sequence.topology(), appearance.corner_texcoords);
  if (std::ranges::count(indices, -1) > 0) {
    values.insert(values.end(), {0, 0});
    std::ranges::replace(indices, -1, none);
  }
  PropertyToWrite uv = {.name = "uv", .metadata = kTexcoordMetadata};
  uv.properties.push_back({.name = ".vals",
                           .metadata = kTexcoordMetadata,
                           .kind = AlembicKind::kArray,
                           .type = AlembicType::kFloat32,
                           .extent = 2,
                           .time_sampling = sampling,
                           .samples = {AddList(values, builder)}});
  uv.properties.push_back({.name = ".indices",
                           .kind = AlembicKind::kArray,
                           .type = AlembicType::kUint32,
                           .time_sampling = sampling,
                           .samples = {AddList(indices, builder)}});
  return uv;
}

// `.selfBnds` and `P`, a sample for each frame.
void AddFrames(const MeshSequence& sequence, uint32_t sampling, AlembicBuilder* builder,
               std::vector<PropertyToWrite>* properties) {
  PropertyToWrite bounds = {.name = ".selfBnds",
                            .metadata = kBoxMetadata,
                            .kind = AlembicKind::kScalar,
                            .type = AlembicType::kFloat64,
                            .extent = 6,
                            .time_sampling = sampling};
  PropertyToWrite positions = {.name = "P",
                               .metadata = kPointMetadata,
                               .kind = AlembicKind::kArray,
                               .type = AlembicType::kFloat32,
                               .extent = 3,
                               .time_sampling = sampling};
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    const std::span<const float> values(frame.data(), static_cast<size_t>(frame.size()));
    positions.samples.push_back(builder->AddSample(values));
    bounds.samples.push_back(AddBox(frame.rowwise().minCoeff().cast<double>(),
                                    frame.rowwise().maxCoeff().cast<double>(), builder));
  }
  properties->push_back(std::move(bounds));
  properties->push_back(std::move(positions));
}

// A face set for each material that a face has.
std::vector<ObjectToWrite> FaceSets(const MeshAppearance& appearance, AlembicBuilder* builder) {
  std::vector<std::vector<int32_t>> faces(appearance.material_names.size());
  for (size_t f = 0; f < appearance.face_materials.size(); ++f) {
    const int32_t material = appearance.face_materials[f];
    if (material >= 0) faces[material].push_back(static_cast<int32_t>(f));
  }
  // The box of a face set is never filled in.
  const Eigen::Vector3d most = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  std::vector<ObjectToWrite> sets;
  std::set<std::string> names;
  for (size_t m = 0; m < faces.size(); ++m) {
    if (faces[m].empty()) continue;
    const std::string wanted = ObjectName(appearance.material_names[m], "material");
    std::string name = wanted;
    for (int copy = 2; !names.insert(name).second; ++copy) name = absl::StrCat(wanted, "_", copy);
    PropertyToWrite set = {.name = ".faceset", .metadata = SchemaMetadata(kFaceSetSchema, true)};
    set.properties.push_back({.name = ".selfBnds",
                              .metadata = kBoxMetadata,
                              .kind = AlembicKind::kScalar,
                              .type = AlembicType::kFloat64,
                              .extent = 6,
                              .samples = {AddBox(most, -most, builder)}});
    set.properties.push_back({.name = ".faces",
                              .kind = AlembicKind::kArray,
                              .type = AlembicType::kInt32,
                              .samples = {AddList(faces[m], builder)}});
    sets.push_back({.name = name,
                    .metadata = ObjectMetadata(kFaceSetSchema, true, ".faceset"),
                    .properties = {std::move(set)}});
  }
  return sets;
}

}  // namespace

std::string EncodeAlembic(const MeshSequence& sequence, double first_frame) {
  AlembicBuilder builder;
  const MeshCounts counts = {.num_vertices = sequence.num_vertices(),
                             .num_frames = sequence.num_frames()};
  constexpr size_t kFrameOverhead = 256;  // keys, sizes, boxes and references
  builder.Reserve(counts.position_bytes() + kFrameOverhead * sequence.num_frames() +
                  sequence.topology().corner_vertices().size() * 2 * sizeof(int32_t));
  const FrameRate rate = sequence.frame_rate();
  const double step = static_cast<double>(rate.denominator) / static_cast<double>(rate.numerator);
  const uint32_t sampling = builder.AddTimeSampling({step, {first_frame * step}});
  const Topology& topology = sequence.topology();
  std::vector<int32_t> sizes;
  for (int f = 0; f < topology.num_faces(); ++f) {
    sizes.push_back(static_cast<int32_t>(topology.face(f).size()));
  }
  PropertyToWrite geometry = {.name = ".geom", .metadata = SchemaMetadata(kPolyMeshSchema, true)};
  AddFrames(sequence, sampling, &builder, &geometry.properties);
  const std::pair<const char*, std::vector<int32_t>> lists[] = {
      {".faceIndices", TurnFaces(topology, topology.corner_vertices())}, {".faceCounts", sizes}};
  for (const auto& [name, values] : lists) {
    geometry.properties.push_back({.name = name,
                                   .kind = AlembicKind::kArray,
                                   .type = AlembicType::kInt32,
                                   .time_sampling = sampling,
                                   .samples = {AddList(values, &builder)}});
  }
  if (!sequence.appearance().corner_texcoords.empty()) {
    geometry.properties.push_back(Texcoords(sequence, sampling, &builder));
  }
  const std::string name = ObjectName(sequence.name(), "mesh");
  ObjectToWrite mesh = {.name = name + "Shape",
                        .metadata = ObjectMetadata(kPolyMeshSchema, true, ".geom"),
                        .properties = {std::move(geometry)},
                        .children = FaceSets(sequence.appearance(), &builder)};
  const uint8_t yes = 1;
  PropertyToWrite xform = {.name = ".xform", .metadata = SchemaMetadata(kXformSchema, false)};
  xform.properties.push_back({.name = ".inherits",
                              .kind = AlembicKind::kScalar,
                              .type = AlembicType::kBool,
                              .samples = {builder.AddSample(std::span<const uint8_t>(&yes, 1))}});
  const ObjectToWrite top = {.name = name,
                             .metadata = ObjectMetadata(kXformSchema, false, ".xform"),
                             .properties = {std::move(xform)},
                             .children = {std::move(mesh)}};
  return builder.Finish({top}, absl::StrFormat("_ai_AlembicVersion=Alembic 1.8 (by Pleat);"
                                               "_ai_Application=Pleat;_ai_DCC_FPS=%.9g",
                                               rate.fps()));
}

absl::Status WriteAlembic(const std::string& path, const MeshSequence& sequence,
                          double first_frame) {
  return WriteFile(path, EncodeAlembic(sequence, first_frame));
}

}  // namespace pleat
