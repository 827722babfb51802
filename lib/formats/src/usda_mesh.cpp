// The schemas UsdGeomMesh, UsdGeomSubset and UsdShadeMaterial.
#include "usda_mesh.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "usda_text.h"

namespace pleat {

UsdaMesh::UsdaMesh(const Topology& topology, const MeshAppearance& appearance, std::string root)
    : topology_(topology), appearance_(appearance), root_(std::move(root)) {
  faces_.resize(appearance.material_names.size());
  for (size_t f = 0; f < appearance.face_materials.size(); ++f) {
    const int32_t material = appearance.face_materials[f];
    if (material >= 0) faces_[material].push_back(static_cast<int32_t>(f));
  }
  std::set<std::string> taken;
  for (const std::string& name : appearance.material_names) {
    const std::string wanted = PrimName(name, "material");
    std::string unique = wanted;
    for (int copy = 2; !taken.insert(unique).second; ++copy) {
      unique = absl::StrCat(wanted, "_", copy);
    }
    materials_.push_back(unique);
  }
}

void UsdaMesh::AppendFaces(std::string* text) const {
  std::vector<int32_t> sizes;
  for (int f = 0; f < topology_.num_faces(); ++f) {
    sizes.push_back(static_cast<int32_t>(topology_.face(f).size()));
  }
  text->append("        int[] faceVertexCounts = ");
  AppendIntegers(sizes, text);
  text->append("\n        int[] faceVertexIndices = ");
  AppendIntegers(topology_.corner_vertices(), text);
  text->append("\n        uniform token orientation = \"rightHanded\"\n");
}

void UsdaMesh::AppendTexcoords(std::string* text) const {
  if (appearance_.corner_texcoords.empty()) return;
  std::vector<Eigen::Vector2f> values = appearance_.texcoords;
  std::vector<int32_t> indices = appearance_.corner_texcoords;
  bool is_missing = false;
  for (int32_t& index : indices) {
    if (index >= 0) continue;
    index = static_cast<int32_t>(appearance_.texcoords.size());
    is_missing = true;
  }
  if (is_missing) values.emplace_back(0, 0);
  text->append("        texCoord2f[] primvars:st = [");
  for (size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text->append(", ");
    AppendTuple(values[i].data(), 2, text);
  }
  text->append(
      "] (\n            interpolation = \"faceVarying\"\n        )\n"
      "        int[] primvars:st:indices = ");
  AppendIntegers(indices, text);
  text->push_back('\n');
}

void UsdaMesh::AppendSubsets(std::string* text) const {
  for (size_t m = 0; m < materials_.size(); ++m) {
    if (faces_[m].empty()) continue;
    absl::StrAppend(text, "\n        def GeomSubset \"", materials_[m],
                    "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n"
                    "        {\n            uniform token elementType = \"face\"\n"
                    "            uniform token familyName = \"materialBind\"\n"
                    "            int[] indices = ");
    AppendIntegers(faces_[m], text);
    absl::StrAppend(text, "\n            rel material:binding = </", root_, "/Materials/",
                    materials_[m], ">\n        }\n");
  }
}

void UsdaMesh::AppendMaterials(std::string* text) const {
  if (materials_.empty()) return;
  text->append("\n    def Scope \"Materials\"\n    {\n");
  for (size_t m = 0; m < materials_.size(); ++m) {
    absl::StrAppend(text, "        def Material \"", materials_[m],
                    "\" (\n            displayName = ", QuotedText(appearance_.material_names[m]),
                    "\n        )\n        {\n        }\n");
  }
  text->append("    }\n");
}

}  // namespace pleat
