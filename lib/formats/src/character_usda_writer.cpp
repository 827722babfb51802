// UsdSkel of OpenUSD: SkelRoot, Skeleton, SkelAnimation and SkelBindingAPI.
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "export_skin.h"
#include "pleat/base/file.h"
#include "pleat/formats/character_file.h"
#include "pleat/formats/joint_clip.h"
#include "usda_mesh.h"
#include "usda_text.h"

namespace pleat {
namespace {

class CharacterUsda {
 public:
  explicit CharacterUsda(const CharacterFile& character)
      : character_(character),
        root_(PrimName(character.name, "character")),
        mesh_(character.topology, character.appearance, root_),
        joints_(MakeExportJoints(character.rig.skeleton)),
        clip_(ClipFromPoses(character.rig.skeleton, character.track)) {
    NameJoints();
  }

  std::string Encode() {
    AppendUsdaHead({.default_prim = root_,
                    .first_frame = 0,
                    .last_frame = static_cast<double>(clip_.num_frames()) - 1,
                    .fps = character_.frame_rate.fps()},
                   &text_);
    absl::StrAppend(&text_, "def SkelRoot \"", root_,
                    "\" (\n    displayName = ", QuotedText(character_.name),
                    "\n    kind = \"component\"\n)\n{\n");
    AddSkeleton();
    AddSkinnedMesh();
    if (!character_.points.empty()) AddFullMesh();
    mesh_.AppendMaterials(&text_);
    text_.append("}\n");
    return std::move(text_);
  }

 private:
  // Joints are paths of names that prims may have, none twice.
  void NameJoints() {
    std::set<std::string> taken;
    for (const ExportJoint& joint : joints_) {
      const std::string wanted = PrimName(joint.name, "joint");
      std::string unique = wanted;
      for (int copy = 2; !taken.insert(unique).second; ++copy) {
        unique = absl::StrCat(wanted, "_", copy);
      }
      paths_.push_back(joint.parent < 0
                           ? unique
                           : absl::StrCat(paths_[static_cast<size_t>(joint.parent)], "/", unique));
    }
  }

  template <typename Append>
  void AddList(const std::string& attribute, size_t count, Append&& append) {
    absl::StrAppend(&text_, attribute, " = [");
    for (size_t i = 0; i < count; ++i) {
      if (i > 0) text_.append(", ");
      append(i);
    }
    text_.append("]\n");
  }

  void AddJointPaths(const char* indent) {
    AddList(absl::StrCat(indent, "uniform token[] joints"), paths_.size(),
            [&](size_t e) { text_.append(QuotedText(paths_[e])); });
  }

  // USD multiplies rows: a translation is the last row.
  void AddTranslations(const char* attribute, const std::vector<Eigen::Vector3d>& translations) {
    AddList(attribute, translations.size(), [&](size_t e) {
      text_.append("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (");
      for (int k = 0; k < 3; ++k) {
        AppendDigits(translations[e][k], &text_);
        text_.append(", ");
      }
      text_.append("1))");
    });
  }

  void AddSkeleton() {
    absl::StrAppend(&text_, "    def Skeleton \"skeleton\" (\n",
                    "        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n");
    std::vector<Eigen::Vector3d> binds, rests;
    for (size_t e = 0; e < joints_.size(); ++e) {
      binds.push_back(joints_[e].rest_position);
      rests.push_back(clip_.joints[e].offset);
    }
    AddTranslations("        uniform matrix4d[] bindTransforms", binds);
    AddList("        uniform token[] jointNames", joints_.size(),
            [&](size_t e) { text_.append(QuotedText(joints_[e].name)); });
    AddJointPaths("        ");
    AddTranslations("        uniform matrix4d[] restTransforms", rests);
    if (character_.track.num_frames() > 0) {
      absl::StrAppend(&text_, "        rel skel:animationSource = </", root_,
                      "/skeleton/animation>\n\n");
      AddAnimation();
    }
    text_.append("    }\n\n");
  }

  void AddAnimation() {
    const size_t num_joints = joints_.size();
    text_.append("        def SkelAnimation \"animation\"\n        {\n");
    AddJointPaths("            ");
    AddSamples("quatf[] rotations", [&](size_t frame, size_t joint) {
      const Eigen::Quaternionf q =
          clip_.rotations[frame * num_joints + joint].normalized().cast<float>();
      const float wxyz[] = {q.w(), q.x(), q.y(), q.z()};
      AppendTuple(wxyz, 4, &text_);
    });
    AddList("            half3[] scales", num_joints, [&](size_t) { text_.append("(1, 1, 1)"); });
    AddSamples("float3[] translations", [&](size_t frame, size_t joint) {
      const Eigen::Vector3f place = clip_.translations[frame * num_joints + joint].cast<float>();
      AppendTuple(place.data(), 3, &text_);
    });
    text_.append("        }\n");
  }

  template <typename Append>
  void AddSamples(const char* attribute, Append&& append) {
    absl::StrAppend(&text_, "            ", attribute, ".timeSamples = {\n");
    for (size_t t = 0; t < clip_.num_frames(); ++t) {
      absl::StrAppend(&text_, "                ", t, ": [");
      for (size_t e = 0; e < joints_.size(); ++e) {
        if (e > 0) text_.append(", ");
        append(t, e);
      }
      text_.append("],\n");
    }
    text_.append("            }\n");
  }

  void OpenMesh(const char* name, bool is_skinned) {
    std::vector<std::string> schemas;
    if (is_skinned) schemas.emplace_back("\"SkelBindingAPI\"");
    if (mesh_.has_materials()) schemas.emplace_back("\"MaterialBindingAPI\"");
    absl::StrAppend(&text_, "    def Mesh \"", name, "\"");
    for (size_t i = 0; i < schemas.size(); ++i) {
      absl::StrAppend(&text_, i == 0 ? " (\n        prepend apiSchemas = [" : ", ", schemas[i]);
    }
    text_.append(schemas.empty() ? "\n    {\n" : "]\n    )\n    {\n");
  }

  void CloseMesh() {
    mesh_.AppendTexcoords(&text_);
    text_.append("        uniform token subdivisionScheme = \"none\"\n");
    mesh_.AppendSubsets(&text_);
    text_.append("    }\n\n");
  }

  static Eigen::Matrix3Xf Box(const Eigen::Matrix3Xf& points) {
    Eigen::Matrix3Xf box(3, 2);
    box << points.rowwise().minCoeff(), points.rowwise().maxCoeff();
    return box;
  }

  void AddSkinnedMesh() {
    const Eigen::Matrix3Xf rest = character_.rig.rest_positions.cast<float>();
    OpenMesh("mesh", true);
    text_.append("        float3[] extent = ");
    AppendPoints(Box(rest), &text_);
    text_.push_back('\n');
    mesh_.AppendFaces(&text_);
    text_.append("        point3f[] points = ");
    AppendPoints(rest, &text_);
    text_.append(
        "\n        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), "
        "(0, 0, 1, 0), (0, 0, 0, 1))\n");
    AddInfluences();
    absl::StrAppend(&text_, "        rel skel:skeleton = </", root_, "/skeleton>\n");
    // Two meshes in one place would shimmer through each other.
    if (!character_.points.empty()) text_.append("        token visibility = \"invisible\"\n");
    CloseMesh();
  }

  void AddInfluences() {
    const std::vector<ExportInfluences> influences =
        MakeExportInfluences(character_.rig.weights, joints_);
    const auto per_vertex = static_cast<size_t>(MostInfluences(character_.rig.weights));
    const std::string end = absl::StrCat(" (\n            elementSize = ", per_vertex,
                                         "\n            interpolation = \"vertex\"\n        )\n");
    const size_t count = influences.size() * per_vertex;
    AddList("        int[] primvars:skel:jointIndices", count, [&](size_t i) {
      AppendDigits(influences[i / per_vertex].joints[i % per_vertex], &text_);
    });
    text_.pop_back();
    text_.append(end);
    AddList("        float[] primvars:skel:jointWeights", count, [&](size_t i) {
      AppendDigits(influences[i / per_vertex].weights[i % per_vertex], &text_);
    });
    text_.pop_back();
    text_.append(end);
  }

  template <typename Value>
  void AddPointSamples(const char* attribute, Value&& value) {
    absl::StrAppend(&text_, "        ", attribute, ".timeSamples = {\n");
    for (size_t t = 0; t < character_.points.size(); ++t) {
      absl::StrAppend(&text_, "            ", t, ": ");
      AppendPoints(value(character_.points[t]), &text_);
      text_.append(",\n");
    }
    text_.append("        }\n");
  }

  // The mesh with its folds, frame by frame.
  void AddFullMesh() {
    OpenMesh("full_mesh", false);
    AddPointSamples("float3[] extent", Box);
    mesh_.AppendFaces(&text_);
    AddPointSamples(
        "point3f[] points",
        [](const Eigen::Matrix3Xf& points) -> const Eigen::Matrix3Xf& { return points; });
    CloseMesh();
  }

  const CharacterFile& character_;
  const std::string root_;
  const UsdaMesh mesh_;
  const std::vector<ExportJoint> joints_;
  const JointClip clip_;
  std::vector<std::string> paths_;  // of the joints
  std::string text_;
};

}  // namespace

std::string EncodeCharacterUsda(const CharacterFile& character) {
  return CharacterUsda(character).Encode();
}

absl::Status WriteCharacterUsda(const std::string& path, const CharacterFile& character) {
  return WriteFile(path, EncodeCharacterUsda(character));
}

}  // namespace pleat
