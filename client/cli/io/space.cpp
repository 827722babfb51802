#include "cli/io/space.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/exit_code.h"

namespace pleat {
namespace {

struct Unit {
  const char* name;
  const char* plural;
  double meters;
};
constexpr Unit kUnits[] = {{"m", "meters", 1},           {"cm", "centimeters", 0.01},
                           {"mm", "millimeters", 0.001}, {"km", "kilometers", 1000},
                           {"in", "inches", 0.0254},     {"ft", "feet", 0.3048},
                           {"yd", "yards", 0.9144}};

}  // namespace

absl::StatusOr<double> ParseUnit(const std::string& flag, const std::string& text) {
  for (const Unit& unit : kUnits) {
    if (text == unit.name) return unit.meters;
  }
  double meters = 0;
  if (absl::SimpleAtod(text, &meters) && meters >= 1e-9 && meters <= 1e9) return meters;
  return UsageError(absl::StrCat(flag, ": '", text,
                                 "' is no unit; write m, cm, mm, km, in, ft, yd, or how many "
                                 "meters it has"));
}

absl::StatusOr<UpAxis> ParseUp(const std::string& flag, const std::string& text) {
  const std::string axis = absl::AsciiStrToLower(text);
  if (axis == "y") return UpAxis::kY;
  if (axis == "z") return UpAxis::kZ;
  return UsageError(absl::StrCat(flag, ": '", text, "' is no axis that points up; write y or z"));
}

std::string DescribeSpace(const Space& space) {
  std::string unit = absl::StrFormat("units of %g m", space.unit_m);
  for (const Unit& known : kUnits) {
    if (known.meters == space.unit_m) unit = known.plural;
  }
  return absl::StrCat(unit, space.up == UpAxis::kY ? ", Y up" : ", Z up");
}

const std::vector<PackagePreset>& PackagePresets() {
  // Blender turns what its importers know as Y up (OBJ, glTF, Alembic), and leaves caches alone.
  // Unreal's preset "Maya" takes Alembic in centimeters with Y up.
  static const std::vector<PackagePreset>& presets = *new std::vector<PackagePreset>{
      {"blender", {1, UpAxis::kY}, {".abc", ".glb", ".usda", ".pc2", ".mdd", "obj", "ply"}},
      {"maya", {0.01, UpAxis::kY}, {".abc", ".usda", "obj"}},
      {"houdini", {1, UpAxis::kY}, {".abc", ".usda", ".glb", ".mdd", "obj", "ply"}},
      {"unreal", {0.01, UpAxis::kY}, {".abc", ".usda", ".glb"}},
      {"unity", {1, UpAxis::kY}, {".abc", ".glb"}},
      {"godot", {1, UpAxis::kY}, {".glb"}}};
  return presets;
}

absl::StatusOr<PackagePreset> FindPackage(const std::string& name) {
  std::vector<std::string> names;
  for (const PackagePreset& preset : PackagePresets()) {
    if (preset.name == name) return preset;
    names.push_back(preset.name);
  }
  return UsageError(
      absl::StrCat("--for '", name, "' is unknown; known are ", absl::StrJoin(names, ", ")));
}

absl::StatusOr<MeshSequence> InSpace(const MeshSequence& sequence, const Space& from,
                                     const Space& to) {
  if (from == to) return sequence;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // to_from_from
  if (from.up == UpAxis::kY && to.up == UpAxis::kZ) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (from.up == UpAxis::kZ && to.up == UpAxis::kY) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  turn *= from.unit_m / to.unit_m;
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    frames.emplace_back((turn * sequence.FrameAsDouble(t)).cast<float>());
  }
  return MeshSequence::Create(sequence.topology(), std::move(frames),
                              {.name = sequence.name(),
                               .frame_rate = sequence.frame_rate(),
                               .appearance = sequence.appearance()});
}

}  // namespace pleat
