#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "compressed_format.h"
#include "integer_model.h"
#include "pleat/base/status.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

absl::Status Damaged() { return absl::DataLossError("the appearance is damaged"); }

// One walk for both directions: texture coordinates, then corners, then materials.
class AppearanceWalk {
 public:
  AppearanceWalk(const Topology& topology, BinaryCoder* coder, MeshAppearance* appearance)
      : topology_(topology), coder_(coder), appearance_(*appearance) {}

  absl::Status CodeTexcoords() {
    for (Eigen::Vector2f& coordinates : appearance_.texcoords) {
      for (int c = 0; c < 2; ++c) {
        const uint32_t bits = coder_->CodeBits(std::bit_cast<uint32_t>(coordinates[c]), 32);
        coordinates[c] = std::bit_cast<float>(bits);
      }
      if (coder_->overrun()) return Damaged();
    }
    return absl::OkStatus();
  }

  // Mostly the index used before at this vertex, or the first that was not used yet.
  absl::Status CodeCorners() {
    std::vector<int32_t> used(topology_.num_vertices(), -1);
    IntegerModel<1> kinds({3}, 1), jumps({1}, 1);
    int next = 0, last_kind = 0;
    for (int i = 0; i < topology_.num_corners(); ++i) {
      int32_t& index = appearance_.corner_texcoords[i];
      int32_t& before = used[topology_.corner_vertices()[i]];
      int kind = index == before && before >= 0 ? 0 : index == next ? 1 : 2;
      kind = kinds.CodeUnsigned(coder_, kind, {last_kind}, 0);
      if (kind > 2 || coder_->overrun()) return Damaged();
      last_kind = kind;
      if (kind < 2) {
        index = kind == 0 ? before : next;
      } else {
        index = next + jumps.CodeSigned(coder_, index - next, {0}, 0);
      }
      if (index < -1 || index >= static_cast<int>(appearance_.texcoords.size())) return Damaged();
      before = index;
      next = std::max(next, index + 1);
    }
    return absl::OkStatus();
  }

  absl::Status CodeMaterials() {
    IntegerModel<1> jumps({1}, 1);
    int last = 0;
    for (int32_t& material : appearance_.face_materials) {
      material = last + jumps.CodeSigned(coder_, material - last, {0}, 0);
      if (material < -1 || material >= static_cast<int>(appearance_.material_names.size()) ||
          coder_->overrun()) {
        return Damaged();
      }
      last = material;
    }
    return absl::OkStatus();
  }

  absl::Status Run() {
    PLEAT_RETURN_IF_ERROR(CodeTexcoords());
    if (!appearance_.corner_texcoords.empty()) PLEAT_RETURN_IF_ERROR(CodeCorners());
    return CodeMaterials();
  }

 private:
  const Topology& topology_;
  BinaryCoder* coder_;
  MeshAppearance& appearance_;
};

}  // namespace

std::string EncodeAppearance(const MeshAppearance& appearance, const Topology& topology) {
  BinaryCoder coder = BinaryCoder::ForEncoding();
  MeshAppearance copy = appearance;
  AppearanceWalk(topology, &coder, &copy).Run().IgnoreError();  // only damaged code fails
  return coder.Finish();
}

absl::Status DecodeAppearance(std::string_view payload, const CompressedHeader& header,
                              const Topology& topology, MeshAppearance* appearance) {
  BinaryCoder coder = BinaryCoder::ForDecoding(payload);
  // Coordinates are not compressed; corners and faces are counted by the topology, which is there.
  if (header.num_texcoords > payload.size() / 8) return Damaged();
  appearance->texcoords.resize(header.num_texcoords);
  if (header.appearance_flags & kHasCornerTexcoords) {
    appearance->corner_texcoords.resize(topology.num_corners());
  }
  if (header.appearance_flags & kHasFaceMaterials) {
    appearance->face_materials.resize(topology.num_faces());
  }
  return AppearanceWalk(topology, &coder, appearance).Run();
}

}  // namespace pleat
