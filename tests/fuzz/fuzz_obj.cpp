#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "obj_parser.h"

namespace {

bool SamePositions(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b) {
  if (a.cols() != b.cols()) return false;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!(a(i) == b(i) || (a(i) != a(i) && b(i) != b(i)))) return false;
  }
  return true;
}

}  // namespace

// The file as the first frame of a series, and once more as a frame whose faces are known.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::string file = "fuzz.obj";
  const pleat::MeshLimits limits;
  pleat::ObjFaceText faces;
  const auto first = pleat::ParseObj(text, file, limits, nullptr, &faces);
  if (!first.ok()) return 0;
  if (first->mesh.positions.cols() != first->mesh.topology.num_vertices()) __builtin_trap();
  if (faces.text.empty()) return 0;
  const auto again = pleat::ParseObj(text, file, limits, &faces, nullptr);
  if (!again.ok() || !again->has_known_faces ||
      again->mesh.notes.size() > first->mesh.notes.size() ||  // texture coordinates are not read
      !SamePositions(first->mesh.positions, again->mesh.positions)) {
    __builtin_trap();
  }
  return 0;
}
