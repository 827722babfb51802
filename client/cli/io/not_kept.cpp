#include "cli/io/not_kept.h"

#include <algorithm>

namespace pleat {
namespace {

using enum AnimationFormat;

bool HasPolygons(const Topology& topology) {
  return topology.num_triangles() > topology.num_faces();
}

bool HasFaceWithoutMaterial(const MeshAppearance& appearance) {
  return std::ranges::count(appearance.face_materials, -1) > 0;
}

bool IsOneOf(AnimationFormat format, std::initializer_list<AnimationFormat> formats) {
  return std::ranges::count(formats, format) > 0;
}

}  // namespace

bool SaysFrameRate(AnimationFormat format) {
  return IsOneOf(format, {kMdd, kNpz, kAbc, kGlb, kUsda, kPseq, kDraco});
}

bool SaysSpace(AnimationFormat format) { return IsOneOf(format, {kGlb, kUsda}); }

std::vector<std::string> NotKept(AnimationFormat format, const MeshSequence& sequence,
                                 double first_frame) {
  const MeshAppearance& appearance = sequence.appearance();
  std::vector<std::string> lost;
  if (format == kDraco) lost.emplace_back("the last bits of positions (they lie on a grid)");
  if (!SaysFrameRate(format)) lost.emplace_back("the frame rate");
  if (first_frame != 0 && !IsOneOf(format, {kPc2, kMdd, kNpz, kAbc, kUsda})) {
    lost.emplace_back("the number of the first frame");
  }
  if (HasPolygons(sequence.topology()) && IsOneOf(format, {kGlb, kDraco})) {
    lost.emplace_back("polygons (they become triangles)");
  }
  if (!appearance.corner_texcoords.empty() && format == kDraco) {
    lost.emplace_back("texture coordinates");
  }
  if (!appearance.material_names.empty() && IsOneOf(format, {kPly, kDraco})) {
    lost.emplace_back("materials");
  }
  if (!appearance.material_library.empty() && IsOneOf(format, {kGlb, kUsda, kAbc, kPly, kDraco})) {
    lost.emplace_back("the name of the material library");
  }
  if (HasFaceWithoutMaterial(appearance) && IsOneOf(format, {kPc2, kMdd, kNpy, kObj})) {
    lost.emplace_back("that some faces have no material (its name is empty)");
  }
  return lost;
}

}  // namespace pleat
