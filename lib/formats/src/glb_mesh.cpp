// Khronos, glTF 2.0 specification, sections 3.7.2 (meshes) and 3.7.3 (skins). Only geometry is
// read, and every index is checked here: no other file is opened and no image is decoded.
#include "glb_mesh.h"

#include <Eigen/LU>
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr int kTriangles = 4, kTriangleFan = 6;  // modes of primitives; 5 is a strip
constexpr size_t kMaxDropped = 16;               // kinds of attributes that are named
// Nodes may share a mesh and pieces of a mesh their vertices, so a small file could ask for a walk
// that never ends. Large scenes have some ten thousand pieces.
constexpr size_t kMaxVisits = 4'000'000;

// The corners of triangle t of a strip or a fan, of which consecutive ones share vertices. Every
// second triangle of a strip is turned around, so that all are wound alike.
std::array<size_t, 3> ConnectedCorners(int mode, size_t t) {
  if (mode == kTriangleFan) return {t + 1, t + 2, 0};
  const size_t odd = t % 2;
  return {t, t + 1 + odd, t + 2 - odd};
}

class MeshReader {
 public:
  MeshReader(const GlbContainer& glb, const GlbNodes& nodes, bool is_still,
             const MeshLimits& limits)
      : glb_(glb), nodes_(nodes), is_still_(is_still), limits_(limits) {}

  absl::StatusOr<GlbMesh> Read() {
    result_.skins.resize(glb_.List("skins").size());
    for (const int node : nodes_.shown()) {
      PLEAT_RETURN_IF_ERROR(ReadNode(node));
    }
    return Finish();
  }

 private:
  // What the corners of a primitive refer to.
  struct VertexRange {
    int first = 0, count = 0;
    int first_texcoord = -1;  // -1 = none
  };

  absl::Status ReadNode(int node) {
    const json& entry = glb_.List("nodes")[static_cast<size_t>(node)];
    const auto index = entry.find("mesh");
    if (index == entry.end()) return absl::OkStatus();
    const json& mesh = glb_.Entry("meshes", *index);
    const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
    if (!mesh.is_object() || primitives == mesh.end() || !primitives->is_array()) {
      return GlbFault(absl::StrCat("node ", node, ": its mesh has no primitives"));
    }
    PLEAT_ASSIGN_OR_RETURN(const int skin, ReadSkinOf(entry));
    // Exporters split a mesh by its materials and leave all its vertices to each piece.
    std::map<std::string, VertexRange> ranges;
    for (const json& primitive : *primitives) {
      PLEAT_RETURN_IF_ERROR(ReadPrimitive(primitive, node, skin, &ranges));
    }
    return absl::OkStatus();
  }

  // Returns the index of the skin of a node, -1 = none.
  absl::StatusOr<int> ReadSkinOf(const json& node) {
    const auto index = node.find("skin");
    if (index == node.end()) return -1;
    if (glb_.Entry("skins", *index).is_null()) return GlbFault("the skin of a node is missing");
    const auto skin = index->get<size_t>();
    if (result_.skins[skin].joint_nodes.empty()) {
      PLEAT_ASSIGN_OR_RETURN(result_.skins[skin], ReadGlbSkin(glb_, nodes_, skin));
    }
    return static_cast<int>(skin);
  }

  absl::Status ReadPrimitive(const json& primitive, int node, int skin,
                             std::map<std::string, VertexRange>* ranges) {
    const auto attributes = primitive.is_object() ? primitive.find("attributes") : primitive.end();
    if (!primitive.is_object() || attributes == primitive.end() || !attributes->is_object() ||
        !attributes->contains("POSITION")) {
      return GlbFault(absl::StrCat("node ", node, ": a primitive of its mesh has no POSITION"));
    }
    num_visits_ += 1 + attributes->size();
    if (num_visits_ > kMaxVisits) {
      return absl::ResourceExhaustedError(
          absl::StrCat("GLB: more than ", kMaxVisits, " pieces of meshes and their attributes"));
    }
    const json mode = primitive.value("mode", json(kTriangles));
    if (!mode.is_number_integer() || mode < 0 || mode > kTriangleFan) {
      return GlbFault(absl::StrCat("node ", node, ": a primitive has an unknown mode"));
    }
    if (mode < kTriangles) {
      dropped_.insert("lines and points");
      return absl::OkStatus();
    }
    NoteDropped(primitive, *attributes);
    const auto [range, is_new] = ranges->try_emplace(KeyOf(*attributes) + TargetsKey(primitive));
    if (is_new) {
      PLEAT_ASSIGN_OR_RETURN(range->second, ReadVertices(primitive, *attributes, node, skin));
    }
    return ReadFaces(primitive, mode.get<int>(), node, range->second);
  }

  // Names the accessors of all attributes. Those that are no numbers are refused where they are
  // needed.
  static std::string KeyOf(const json& attributes) {
    std::string key;
    for (const auto& item : attributes.items()) {
      const json& index = item.value();
      absl::StrAppend(&key, item.key(), "=",
                      index.is_number_integer() ? index.get<int64_t>() : int64_t{-1}, " ");
    }
    return key;
  }

  static std::string TargetsKey(const json& primitive) {
    const auto targets = primitive.find("targets");
    return targets == primitive.end()
               ? ""
               : targets->dump(-1, ' ', true, json::error_handler_t::replace);
  }

  void NoteDropped(const json& primitive, const json& attributes) {
    for (const auto& item : attributes.items()) {
      const std::string& name = item.key();
      const bool is_normal = name == "NORMAL" || name == "TANGENT";  // computed where needed
      if (name == "POSITION" || (!is_still_ && name == "_VERTEX_ID") || name == "TEXCOORD_0" ||
          is_normal || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
          dropped_.size() > kMaxDropped) {
        continue;
      }
      dropped_.insert(EscapeControls(name));
    }
    if (is_still_ && primitive.contains("targets")) dropped_.insert("morph targets");
  }

  // The morph targets of a primitive, which change its positions. Targets of other attributes alone
  // count, but change nothing.
  absl::Status ReadTargets(const json& primitive, GlbPart* part) {
    const auto targets = primitive.find("targets");
    if (is_still_ || targets == primitive.end()) return absl::OkStatus();
    if (!targets->is_array()) return GlbFault("the morph targets of a primitive are no list");
    num_visits_ += targets->size();
    const auto num_vertices = static_cast<size_t>(part->positions.cols());
    for (const json& target : *targets) {
      std::optional<GlbAccessor>& points = part->targets.emplace_back();
      if (!target.is_object() || !target.contains("POSITION")) continue;
      PLEAT_ASSIGN_OR_RETURN(points, glb_.Access(target["POSITION"], "VEC3"));
      if (points->count() != num_vertices) {
        return GlbFault(absl::StrCat("a morph target has ", points->count(), " vertices, its mesh ",
                                     num_vertices));
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<VertexRange> ReadVertices(const json& primitive, const json& attributes, int node,
                                           int skin) {
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor points, glb_.Access(attributes["POSITION"], "VEC3"));
    if (num_vertices_ + points.count() > static_cast<size_t>(limits_.max_vertices)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("GLB: more than ", limits_.max_vertices, " vertices"));
    }
    VertexRange range = {.first = static_cast<int>(num_vertices_),
                         .count = static_cast<int>(points.count())};
    GlbPart part = {.node = node, .first_vertex = range.first, .skin = skin};
    part.positions.resize(3, range.count);
    for (int v = 0; v < range.count; ++v) {
      for (int k = 0; k < 3; ++k) part.positions(k, v) = points.At(static_cast<size_t>(v), k);
    }
    if (skin >= 0) {
      const size_t num_joints = result_.skins[static_cast<size_t>(skin)].joint_nodes.size();
      PLEAT_ASSIGN_OR_RETURN(part.influences,
                             ReadGlbInfluences(glb_, attributes, points.count(), num_joints));
    }
    PLEAT_RETURN_IF_ERROR(ReadTargets(primitive, &part));
    if (!is_still_ && attributes.contains("_VERTEX_ID")) {
      PLEAT_ASSIGN_OR_RETURN(part.vertex_ids, glb_.Access(attributes["_VERTEX_ID"], "SCALAR"));
    }
    if (attributes.contains("TEXCOORD_0")) {
      PLEAT_ASSIGN_OR_RETURN(range.first_texcoord,
                             ReadTexcoords(attributes["TEXCOORD_0"], points.count()));
    }
    num_vertices_ += points.count();
    result_.parts.push_back(std::move(part));
    return range;
  }

  absl::StatusOr<int> ReadTexcoords(const json& index, size_t num_vertices) {
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor accessor, glb_.Access(index, "VEC2"));
    if (accessor.count() != num_vertices) {
      return GlbFault("POSITION and TEXCOORD_0 of a primitive differ in length");
    }
    std::vector<Eigen::Vector2f>& texcoords = result_.appearance.texcoords;
    const auto first = static_cast<int>(texcoords.size());
    for (size_t v = 0; v < num_vertices; ++v) {
      texcoords.emplace_back(static_cast<float>(accessor.At(v, 0)),
                             static_cast<float>(1 - accessor.At(v, 1)));
    }
    return first;
  }

  absl::Status ReadFaces(const json& primitive, int mode, int node, const VertexRange& range) {
    std::optional<GlbAccessor> indices;
    if (primitive.contains("indices")) {
      PLEAT_ASSIGN_OR_RETURN(indices, glb_.Access(primitive["indices"], "SCALAR"));
    }
    const size_t num_indices = indices ? indices->count() : static_cast<size_t>(range.count);
    const size_t num_triangles = mode == kTriangles ? num_indices / 3
                                 : num_indices < 3  ? 0
                                                    : num_indices - 2;
    if (face_materials_.size() + num_triangles > static_cast<size_t>(limits_.max_faces)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("GLB: more than ", limits_.max_faces, " triangles"));
    }
    if (mode == kTriangles && num_indices % 3 != 0) ++num_cut_off_;
    const int32_t material = MaterialOf(primitive);
    // A node that mirrors its mesh turns the triangles inside out (section 3.7.2.1).
    const bool is_mirrored = nodes_.world_from_node(node).topLeftCorner<3, 3>().determinant() < 0;
    for (size_t t = 0; t < num_triangles; ++t) {
      std::array<size_t, 3> at = mode == kTriangles
                                     ? std::array<size_t, 3>{3 * t, 3 * t + 1, 3 * t + 2}
                                     : ConnectedCorners(mode, t);
      if (is_mirrored) std::swap(at[1], at[2]);
      std::array<int, 3> corners{};
      for (size_t c = 0; c < 3; ++c) {
        const double vertex = indices ? indices->At(at[c], 0) : static_cast<double>(at[c]);
        if (!(vertex >= 0 && vertex < range.count)) {
          return GlbFault(absl::StrCat("node ", node, ": index ", at[c],
                                       " of its mesh names vertex ", vertex, " of ", range.count));
        }
        corners[c] = static_cast<int>(vertex);
      }
      // Strips repeat vertices to turn corners; the triangles that this makes are none.
      const bool is_flat =
          corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2];
      if (mode == kTriangles || !is_flat) AddTriangle(corners, range, material);
    }
    return absl::OkStatus();
  }

  void AddTriangle(const std::array<int, 3>& corners, const VertexRange& range, int32_t material) {
    for (const int corner : corners) {
      corner_vertices_.push_back(range.first + corner);
      corner_texcoords_.push_back(range.first_texcoord < 0 ? -1 : range.first_texcoord + corner);
    }
    face_materials_.push_back(material);
  }

  // Returns the index of the primitive's material in the appearance, -1 = none.
  int32_t MaterialOf(const json& primitive) {
    const json& material = glb_.Entry("materials", primitive.value("material", json()));
    if (!material.is_object()) return -1;
    const auto index = primitive["material"].get<size_t>();
    std::vector<std::string>& names = result_.appearance.material_names;
    const auto [known, is_new] = materials_.try_emplace(index, static_cast<int32_t>(names.size()));
    if (is_new) {
      const json name = material.value("name", json());
      names.push_back(name.is_string() && !name.get<std::string>().empty()
                          ? NameToUtf8(name.get<std::string>())
                          : absl::StrCat("material_", index));
    }
    return known->second;
  }

  void Note(NoteSeverity severity, const char* kind, std::string text) {
    result_.notes.push_back({.severity = severity, .kind = kind, .text = std::move(text)});
  }

  void AddNotes() {
    if (!dropped_.empty()) {
      Note(NoteSeverity::kNote, "not_kept",
           absl::StrCat("not kept: ", absl::StrJoin(dropped_, ", ")));
    }
    if (num_cut_off_ > 0) {
      Note(NoteSeverity::kNote, "faces_left_out",
           absl::StrCat(num_cut_off_, num_cut_off_ == 1 ? " face" : " faces",
                        " with fewer than 3 corners left out at the end of a list"));
    }
    const size_t num_animations = glb_.List("animations").size();
    if (is_still_ && num_animations > 0) {
      Note(NoteSeverity::kWarning, "animation_not_read",
           absl::StrCat("the file holds ", num_animations,
                        num_animations == 1 ? " animation" : " animations",
                        ", of which this is one pose, that of its nodes; give the file alone to "
                        "read its frames"));
    }
  }

  absl::StatusOr<GlbMesh> Finish() {
    if (face_materials_.empty()) {
      return GlbFault(absl::StrCat("the scene shows no triangles: ", nodes_.shown().size(),
                                   " nodes, ", num_vertices_, " vertices"));
    }
    AddNotes();
    const size_t num_faces = face_materials_.size();
    MeshAppearance& appearance = result_.appearance;
    if (!appearance.texcoords.empty()) appearance.corner_texcoords = std::move(corner_texcoords_);
    if (!appearance.material_names.empty()) appearance.face_materials = std::move(face_materials_);
    absl::StatusOr<Topology> topology =
        Topology::Create(static_cast<int>(num_vertices_), std::move(corner_vertices_),
                         std::vector<int32_t>(num_faces, 3));
    if (!topology.ok()) return GlbFault(std::string(topology.status().message()));
    result_.topology = *std::move(topology);
    return std::move(result_);
  }

  const GlbContainer& glb_;
  const GlbNodes& nodes_;
  const bool is_still_;
  const MeshLimits& limits_;
  GlbMesh result_;
  size_t num_vertices_ = 0, num_visits_ = 0;
  std::vector<int32_t> corner_vertices_, corner_texcoords_;
  std::vector<int32_t> face_materials_;  // one per triangle
  std::map<size_t, int32_t> materials_;  // by their number in the file
  std::set<std::string> dropped_;
  int num_cut_off_ = 0;  // lists of triangles that end inside one
};

}  // namespace

absl::StatusOr<GlbMesh> ReadGlbMesh(const GlbContainer& glb, const GlbNodes& nodes, bool is_still,
                                    const MeshLimits& limits) {
  return MeshReader(glb, nodes, is_still, limits).Read();
}

}  // namespace pleat
