// The text form of OpenUSD: the schemas UsdGeomMesh, UsdGeomSubset and UsdShadeMaterial
// (docs/formats/usda.md).
#include "pleat/formats/usda_writer.h"

#include <charconv>
#include <set>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"

namespace pleat {
namespace {

template <typename T>
void AppendDigits(T value, std::string* text) {
  char buffer[32];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  text->append(buffer, result.ptr);
}

void AppendTuple(const float* values, int count, std::string* text) {
  for (int k = 0; k < count; ++k) {
    text->append(k == 0 ? "(" : ", ");
    AppendDigits(values[k], text);
  }
  text->push_back(')');
}

void AppendPoints(const Eigen::Matrix3Xf& points, std::string* text) {
  text->push_back('[');
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    if (v > 0) text->append(", ");
    AppendTuple(points.data() + 3 * v, 3, text);
  }
  text->push_back(']');
}

void AppendIntegers(const std::vector<int32_t>& values, std::string* text) {
  for (size_t i = 0; i < values.size(); ++i) {
    text->append(i == 0 ? "[" : ", ");
    AppendDigits(values[i], text);
  }
  text->append(values.empty() ? "[]" : "]");
}

// A text in quotes; what cannot stand there is escaped.
std::string QuotedText(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted.push_back('\\');
    quoted.push_back(c == '\n' || c == '\r' || c == '\0' ? ' ' : c);
  }
  return quoted + "\"";
}

// A name that a prim may have: letters, digits and _ of ASCII, no digit at the front.
std::string PrimName(std::string_view name, const char* otherwise) {
  std::string result;
  for (const char c : name.substr(0, 200)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80) continue;  // the rest of a letter beyond ASCII
    result.push_back(absl::ascii_isalnum(byte) ? c : '_');
  }
  if (result.empty()) return otherwise;
  return absl::ascii_isdigit(static_cast<unsigned char>(result[0])) ? "_" + result : result;
}

class UsdaText {
 public:
  UsdaText(const MeshSequence& sequence, const UsdaOptions& options)
      : sequence_(sequence), options_(options), root_(PrimName(sequence.name(), "mesh")) {}

  std::string Encode() {
    NameMaterials();
    AddHeader();
    absl::StrAppend(&text_, "def Xform \"", root_,
                    "\" (\n    displayName = ", QuotedText(sequence_.name()),
                    "\n    kind = \"component\"\n)\n{\n");
    AddMesh();
    AddMaterials();
    text_.append("}\n");
    return std::move(text_);
  }

 private:
  void NameMaterials() {
    const MeshAppearance& appearance = sequence_.appearance();
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

  void Setting(const char* name, double value) {
    absl::StrAppend(&text_, "    ", name, " = ");
    AppendDigits(value, &text_);
    text_.push_back('\n');
  }

  void AddHeader() {
    const double fps = sequence_.frame_rate().fps();
    absl::StrAppend(&text_, "#usda 1.0\n(\n    defaultPrim = \"", root_,
                    "\"\n    doc = \"Written by Pleat\"\n");
    Setting("endTimeCode", options_.first_frame + sequence_.num_frames() - 1);
    Setting("framesPerSecond", fps);
    Setting("metersPerUnit", options_.meters_per_unit);
    Setting("startTimeCode", options_.first_frame);
    Setting("timeCodesPerSecond", fps);
    absl::StrAppend(&text_, "    upAxis = \"", options_.is_z_up ? "Z" : "Y", "\"\n)\n\n");
  }

  // A value for each frame, or one for a single frame.
  template <typename Append>
  void AddSamples(const char* attribute, Append&& append) {
    if (sequence_.num_frames() == 1) {
      absl::StrAppend(&text_, "        ", attribute, " = ");
      append(sequence_.frame(0));
      text_.push_back('\n');
      return;
    }
    absl::StrAppend(&text_, "        ", attribute, ".timeSamples = {\n");
    for (int t = 0; t < sequence_.num_frames(); ++t) {
      text_.append("            ");
      AppendDigits(options_.first_frame + t, &text_);
      text_.append(": ");
      append(sequence_.frame(t));
      text_.append(",\n");
    }
    text_.append("        }\n");
  }

  void AddMesh() {
    const Topology& topology = sequence_.topology();
    text_.append("    def Mesh \"mesh\"");
    if (!materials_.empty()) {
      text_.append(" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )");
    }
    text_.append("\n    {\n");
    AddSamples("float3[] extent", [&](const Eigen::Matrix3Xf& frame) {
      Eigen::Matrix3Xf box(3, 2);
      box << frame.rowwise().minCoeff(), frame.rowwise().maxCoeff();
      AppendPoints(box, &text_);
    });
    std::vector<int32_t> sizes;
    for (int f = 0; f < topology.num_faces(); ++f) {
      sizes.push_back(static_cast<int32_t>(topology.face(f).size()));
    }
    text_.append("        int[] faceVertexCounts = ");
    AppendIntegers(sizes, &text_);
    text_.append("\n        int[] faceVertexIndices = ");
    AppendIntegers(topology.corner_vertices(), &text_);
    text_.append("\n        uniform token orientation = \"rightHanded\"\n");
    AddSamples("point3f[] points",
               [&](const Eigen::Matrix3Xf& frame) { AppendPoints(frame, &text_); });
    if (!sequence_.appearance().corner_texcoords.empty()) AddTexcoords();
    text_.append("        uniform token subdivisionScheme = \"none\"\n");
    AddSubsets();
    text_.append("    }\n");
  }

  void AddTexcoords() {
    const MeshAppearance& appearance = sequence_.appearance();
    std::vector<Eigen::Vector2f> values = appearance.texcoords;
    std::vector<int32_t> indices = appearance.corner_texcoords;
    bool is_missing = false;
    for (int32_t& index : indices) {
      if (index >= 0) continue;
      index = static_cast<int32_t>(appearance.texcoords.size());
      is_missing = true;
    }
    if (is_missing) values.emplace_back(0, 0);
    text_.append("        texCoord2f[] primvars:st = [");
    for (size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text_.append(", ");
      AppendTuple(values[i].data(), 2, &text_);
    }
    text_.append(
        "] (\n            interpolation = \"faceVarying\"\n        )\n"
        "        int[] primvars:st:indices = ");
    AppendIntegers(indices, &text_);
    text_.push_back('\n');
  }

  void AddSubsets() {
    for (size_t m = 0; m < materials_.size(); ++m) {
      if (faces_[m].empty()) continue;
      absl::StrAppend(&text_, "\n        def GeomSubset \"", materials_[m],
                      "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n"
                      "        {\n            uniform token elementType = \"face\"\n"
                      "            uniform token familyName = \"materialBind\"\n"
                      "            int[] indices = ");
      AppendIntegers(faces_[m], &text_);
      absl::StrAppend(&text_, "\n            rel material:binding = </", root_, "/Materials/",
                      materials_[m], ">\n        }\n");
    }
  }

  void AddMaterials() {
    if (materials_.empty()) return;
    text_.append("\n    def Scope \"Materials\"\n    {\n");
    for (size_t m = 0; m < materials_.size(); ++m) {
      absl::StrAppend(
          &text_, "        def Material \"", materials_[m],
          "\" (\n            displayName = ", QuotedText(sequence_.appearance().material_names[m]),
          "\n        )\n        {\n        }\n");
    }
    text_.append("    }\n");
  }

  const MeshSequence& sequence_;
  const UsdaOptions& options_;
  const std::string root_;
  std::vector<std::string> materials_;       // the names of their prims
  std::vector<std::vector<int32_t>> faces_;  // of each material
  std::string text_;
};

}  // namespace

std::string EncodeUsda(const MeshSequence& sequence, const UsdaOptions& options) {
  return UsdaText(sequence, options).Encode();
}

absl::Status WriteUsda(const std::string& path, const MeshSequence& sequence,
                       const UsdaOptions& options) {
  return WriteFile(path, EncodeUsda(sequence, options));
}

}  // namespace pleat
