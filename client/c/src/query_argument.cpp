#include "query_argument.h"

#include <algorithm>
#include <cstdint>

#include "error_report.h"
#include "pleat/base/status.h"
#include "pleat/mesh/normals.h"
#include "pose_argument.h"

namespace pleat {

absl::StatusOr<VertexRows> TakeRows(absl::string_view name, const pleat_rows& given,
                                    int num_vertices) {
  constexpr size_t kRowBytes = 3 * sizeof(float);
  const size_t stride = given.stride == 0 ? kRowBytes : given.stride;
  if (given.data == nullptr) return IsNull(name);
  if (stride < kRowBytes || stride % sizeof(float) != 0 ||
      reinterpret_cast<uintptr_t>(given.data) % sizeof(float) != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(name, ": the stride is ", stride,
                     "; rows take at least 12 bytes and begin at multiples of 4"));
  }
  const auto rows_before_the_last = static_cast<size_t>(num_vertices) - 1;
  if (given.num_bytes < kRowBytes ||
      rows_before_the_last > (given.num_bytes - kRowBytes) / stride) {
    return absl::InvalidArgumentError(absl::StrCat(name, ": ", given.num_bytes, " bytes for ",
                                                   num_vertices, " vertices that are ", stride,
                                                   " bytes apart"));
  }
  return VertexRows{.data = given.data, .stride = static_cast<ptrdiff_t>(stride / sizeof(float))};
}

absl::Status CheckQuerySize(const pleat_query& query) {
  PLEAT_RETURN_IF_ERROR(CheckStructSize("pleat_query", query.struct_size, sizeof(pleat_query)));
  if (query.struct_size % alignof(pleat_query) == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("pleat_query.struct_size is ", query.struct_size,
                                                 ", which is the size of no struct"));
}

absl::Status CheckFlags(const pleat_query& query) {
  if ((query.flags & ~uint32_t{PLEAT_SKINNED_ONLY}) == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("flags ", query.flags, " are not known to version " PLEAT_VERSION));
}

absl::StatusOr<QueryTarget> TakeTarget(const pleat_query& query, int num_vertices) {
  QueryTarget target;
  PLEAT_ASSIGN_OR_RETURN(target.positions, TakeRows("positions", query.positions, num_vertices));
  if (query.normals.data != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(target.normals, TakeRows("normals", query.normals, num_vertices));
  }
  return target;
}

absl::Status TakePoses(const pleat_query& query, const CharacterModel& character, QuerySlot* slot) {
  if (query.num_poses == 0) return absl::InvalidArgumentError("a query needs at least one pose");
  if (query.poses == nullptr) return IsNull("poses");
  const size_t looked_at =
      IsSkinnedOnly(query) ? 1 : static_cast<size_t>(character.options().history);
  const size_t num_poses = std::min(query.num_poses, looked_at);
  if (slot->poses.size() < num_poses) slot->poses.resize(num_poses);
  slot->pointers.clear();
  for (size_t h = 0; h < num_poses; ++h) {
    PLEAT_RETURN_IF_ERROR(
        TakePose(query.poses[h], character.skeleton().num_joints(), &slot->poses[h]));
    slot->pointers.push_back(&slot->poses[h]);
  }
  return absl::OkStatus();
}

void TakeScales(const pleat_query& query, int num_joints, QuerySlot* slot) {
  slot->bone_scales.clear();
  if (query.bone_scales != nullptr) {
    slot->bone_scales.assign(query.bone_scales, query.bone_scales + num_joints);
  }
}

void Finish(const CharacterModel& character, const QueryTarget& target, double confidence,
            pleat_query* query) {
  query->confidence = confidence;
  query->code = PLEAT_OK;
  if (target.normals.data == nullptr) return;
  ComputeVertexNormals(target.positions, character.num_vertices(), character.topology().triangles(),
                       target.normals);
}

}  // namespace pleat
