// The text form of OpenUSD: the schemas UsdGeomMesh, UsdGeomSubset and UsdShadeMaterial
// (docs/formats/usda.md).
#include "pleat/formats/usda_writer.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "usda_mesh.h"
#include "usda_text.h"

namespace pleat {
namespace {

class UsdaText {
 public:
  UsdaText(const MeshSequence& sequence, const UsdaOptions& options)
      : sequence_(sequence),
        options_(options),
        root_(PrimName(sequence.name(), "mesh")),
        mesh_(sequence.topology(), sequence.appearance(), root_) {}

  std::string Encode() {
    AppendUsdaHead({.default_prim = root_,
                    .meters_per_unit = options_.meters_per_unit,
                    .is_z_up = options_.is_z_up,
                    .first_frame = options_.first_frame,
                    .last_frame = options_.first_frame + sequence_.num_frames() - 1,
                    .fps = sequence_.frame_rate().fps()},
                   &text_);
    absl::StrAppend(&text_, "def Xform \"", root_,
                    "\" (\n    displayName = ", QuotedText(sequence_.name()),
                    "\n    kind = \"component\"\n)\n{\n");
    AddMesh();
    mesh_.AppendMaterials(&text_);
    text_.append("}\n");
    return std::move(text_);
  }

 private:
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
    text_.append("    def Mesh \"mesh\"");
    if (mesh_.has_materials()) {
      text_.append(" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )");
    }
    text_.append("\n    {\n");
    AddSamples("float3[] extent", [&](const Eigen::Matrix3Xf& frame) {
      Eigen::Matrix3Xf box(3, 2);
      box << frame.rowwise().minCoeff(), frame.rowwise().maxCoeff();
      AppendPoints(box, &text_);
    });
    mesh_.AppendFaces(&text_);
    AddSamples("point3f[] points",
               [&](const Eigen::Matrix3Xf& frame) { AppendPoints(frame, &text_); });
    mesh_.AppendTexcoords(&text_);
    text_.append("        uniform token subdivisionScheme = \"none\"\n");
    mesh_.AppendSubsets(&text_);
    text_.append("    }\n");
  }

  const MeshSequence& sequence_;
  const UsdaOptions& options_;
  const std::string root_;
  const UsdaMesh mesh_;
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
