#include "alembic_appearance.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

void AddNote(const char* kind, std::string text, std::vector<InputNote>* notes) {
  notes->push_back({.kind = kind, .text = std::move(text)});
}

// `uv` as the file has it.
struct TextureCoordinates {
  AlembicProperty values;                  // float32[2]
  std::optional<AlembicProperty> indices;  // int32 or uint32
  std::string_view scope;                  // "fvr", "vtx", ..., empty when the file does not say
};

absl::StatusOr<std::optional<TextureCoordinates>> FindTexcoords(const AlembicMesh& mesh,
                                                                AlembicArchive* archive) {
  const AlembicProperty* uv = mesh.geometry.Find("uv");
  if (uv == nullptr) return std::nullopt;
  TextureCoordinates found;
  found.scope = MetadataValue(uv->metadata, "geoScope");
  if (uv->kind != AlembicKind::kCompound) {
    found.values = *uv;
  } else {
    PLEAT_ASSIGN_OR_RETURN(const AlembicProperties parts,
                           AlembicProperties::Read(uv->group, archive));
    const AlembicProperty* values = parts.Find(".vals");
    if (values == nullptr) return std::nullopt;
    found.values = *values;
    const AlembicProperty* indices = parts.Find(".indices");
    if (indices != nullptr && indices->num_samples > 0) found.indices = *indices;
  }
  if (found.values.num_samples == 0) return std::nullopt;
  return found;
}

absl::StatusOr<std::vector<int32_t>> ReadIndices(const AlembicProperty& property,
                                                 AlembicArchive* archive) {
  std::vector<int32_t> indices;
  if (property.kind != AlembicKind::kArray || property.extent != 1 ||
      (property.type != AlembicType::kInt32 && property.type != AlembicType::kUint32)) {
    return indices;
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, ReadSampleValues(property, 0, archive));
  indices.resize(bytes.size() / sizeof(int32_t));
  if (!indices.empty()) std::memcpy(indices.data(), bytes.data(), bytes.size());
  return indices;
}

// Texture coordinates that are no numbers become 0 0. Returns whether there were any.
bool MendTexcoords(std::vector<Eigen::Vector2f>* texcoords) {
  bool mended = false;
  for (Eigen::Vector2f& texcoord : *texcoords) {
    if (texcoord.allFinite()) continue;
    texcoord.setZero();
    mended = true;
  }
  return mended;
}

// The index of each corner into the values: entry_of_corner gives the place among the entries of
// the file. False when an entry or an index is not there.
template <typename EntryOfCorner>
bool IndexCorners(size_t num_corners, const std::vector<int32_t>& indices, bool indexed,
                  size_t num_values, const EntryOfCorner& entry_of_corner,
                  std::vector<int32_t>* corner_texcoords) {
  corner_texcoords->resize(num_corners);
  for (size_t c = 0; c < num_corners; ++c) {
    const int32_t entry = entry_of_corner(c);
    const int32_t index = indexed ? indices[entry] : entry;
    if (index < 0 || static_cast<size_t>(index) >= num_values) return false;
    (*corner_texcoords)[c] = index;
  }
  return true;
}

absl::Status ReadTexcoords(const AlembicMesh& mesh, const AlembicFaces& faces, int num_vertices,
                           AlembicArchive* archive, MeshAppearance* appearance,
                           std::vector<InputNote>* notes) {
  PLEAT_ASSIGN_OR_RETURN(const std::optional<TextureCoordinates> uv, FindTexcoords(mesh, archive));
  if (!uv) return absl::OkStatus();
  if (!uv->values.Is(AlembicKind::kArray, AlembicType::kFloat32, 2)) {
    AddNote("texcoords_unreadable", "its texture coordinates are no float32[2] and left out",
            notes);
    return absl::OkStatus();
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, ReadSampleValues(uv->values, 0, archive));
  std::vector<int32_t> indices;
  if (uv->indices) {
    PLEAT_ASSIGN_OR_RETURN(indices, ReadIndices(*uv->indices, archive));
  }
  const size_t num_values = bytes.size() / sizeof(Eigen::Vector2f);
  const size_t num_entries = uv->indices ? indices.size() : num_values;
  if (num_entries == 0) return absl::OkStatus();
  const bool fits_corners = num_entries == static_cast<size_t>(faces.num_file_corners);
  const bool fits_vertices = num_entries == static_cast<size_t>(num_vertices);
  const bool per_vertex =
      fits_vertices && (!fits_corners || uv->scope == "vtx" || uv->scope == "var");
  std::vector<int32_t> corner_texcoords;
  const bool fits =
      (fits_corners || fits_vertices) &&
      IndexCorners(
          faces.corner_vertices.size(), indices, uv->indices.has_value(), num_values,
          [&](size_t c) { return per_vertex ? faces.corner_vertices[c] : faces.corner_sources[c]; },
          &corner_texcoords);
  if (!fits) {
    AddNote("texcoords_unreadable",
            absl::StrCat("its ", num_entries, " texture coordinates fit neither its ",
                         faces.num_file_corners, " corners nor its ", num_vertices,
                         " vertices, or name values that are not there; they are left out"),
            notes);
    return absl::OkStatus();
  }
  appearance->texcoords.resize(num_values);
  if (num_values > 0) std::memcpy(appearance->texcoords[0].data(), bytes.data(), bytes.size());
  appearance->corner_texcoords = std::move(corner_texcoords);
  if (MendTexcoords(&appearance->texcoords)) {
    AddNote("texcoords_unreadable", "texture coordinates that are no numbers become 0 0", notes);
  }
  if (uv->values.changes() || (uv->indices && uv->indices->changes())) {
    AddNote("appearance_first_frame", "its texture coordinates change; those of frame 0 are taken",
            notes);
  }
  return absl::OkStatus();
}

// The face sets are the children of the mesh.
absl::Status ReadFaceSets(const AlembicMesh& mesh, const AlembicFaces& faces,
                          AlembicArchive* archive, MeshAppearance* appearance,
                          std::vector<InputNote>* notes) {
  const std::vector<AlembicObject>& objects = archive->objects();
  std::vector<int32_t> materials;  // of each face in the file, -1 = none
  bool changes = false;
  for (size_t i = mesh.object + 1; i < objects.size() && objects[i].parent >= mesh.object; ++i) {
    const int child = static_cast<int>(i);
    if (objects[i].parent != mesh.object || archive->schema(child) != kFaceSetSchema) continue;
    PLEAT_ASSIGN_OR_RETURN(const AlembicProperties all,
                           AlembicProperties::Read(objects[i].properties, archive));
    PLEAT_ASSIGN_OR_RETURN(const AlembicProperties set, all.Compound(".faceset", archive));
    const AlembicProperty* property = set.Find(".faces");
    if (property == nullptr || property->num_samples == 0) continue;
    changes = changes || property->changes();
    PLEAT_ASSIGN_OR_RETURN(const std::vector<int32_t> set_faces, ReadIndices(*property, archive));
    const auto material = static_cast<int32_t>(appearance->material_names.size());
    materials.resize(static_cast<size_t>(faces.num_file_faces), -1);
    bool is_used = false;
    for (const int32_t f : set_faces) {
      if (f < 0 || f >= faces.num_file_faces || materials[f] >= 0) continue;
      materials[f] = material;
      is_used = true;
    }
    if (is_used) appearance->material_names.push_back(NameToUtf8(objects[i].name));
  }
  if (appearance->material_names.empty()) return absl::OkStatus();
  for (const int32_t f : faces.face_sources) appearance->face_materials.push_back(materials[f]);
  if (changes) {
    AddNote("appearance_first_frame", "its face sets change; those of frame 0 are taken", notes);
  }
  return absl::OkStatus();
}

void NoteWhatIsNotKept(const AlembicMesh& mesh, const AlembicFaces& faces,
                       std::vector<InputNote>* notes) {
  constexpr std::string_view kRead[] = {
      "P", ".faceIndices", ".faceCounts", "uv", ".selfBnds", ".childBnds", "N"};
  std::vector<std::string> others;
  for (const AlembicProperty& property : mesh.geometry.all()) {
    const bool is_empty = property.kind == AlembicKind::kCompound && property.group.position() == 0;
    if (is_empty || std::ranges::find(kRead, property.name) != std::end(kRead)) continue;
    others.push_back(EscapeControls(NameToUtf8(property.name)));
  }
  if (!others.empty()) {
    AddNote("not_kept", absl::StrCat("not kept: ", absl::StrJoin(others, ", ")), notes);
  }
  if (mesh.is_subdivision) {
    AddNote("control_mesh", "it is a subdivision surface; its control mesh is read", notes);
  }
  if (mesh.positions.type == AlembicType::kFloat64) {
    AddNote("positions_rounded", "its positions are float64 and rounded to float32", notes);
  }
  const auto left_out = static_cast<int>(faces.num_file_faces - faces.face_sizes.size());
  if (left_out > 0) {
    AddNote("faces_left_out",
            absl::StrCat(left_out, " of its faces have fewer than three corners and are left out"),
            notes);
  }
}

}  // namespace

absl::StatusOr<MeshAppearance> ReadAlembicAppearance(const AlembicMesh& mesh,
                                                     const AlembicFaces& faces, int num_vertices,
                                                     AlembicArchive* archive,
                                                     std::vector<InputNote>* notes) {
  MeshAppearance appearance;
  PLEAT_RETURN_IF_ERROR(ReadTexcoords(mesh, faces, num_vertices, archive, &appearance, notes));
  PLEAT_RETURN_IF_ERROR(ReadFaceSets(mesh, faces, archive, &appearance, notes));
  NoteWhatIsNotKept(mesh, faces, notes);
  return appearance;
}

}  // namespace pleat
