// Queries of callers.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "pleat.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/mesh/vertex_rows.h"

namespace pleat {

// The arguments of one query as the evaluator wants them. It keeps its memory.
struct QuerySlot {
  std::vector<Pose> poses;
  std::vector<const Pose*> pointers;
  std::vector<double> bone_scales;
  EvaluatedFrame frame;  // its confidence; the positions go to the caller
};

// Where the frame of a query goes.
struct QueryTarget {
  VertexRows positions, normals;  // normals.data is null when nobody wants them
};

inline bool IsSkinnedOnly(const pleat_query& query) {
  return (query.flags & PLEAT_SKINNED_ONLY) != 0;
}

// kInvalidArgument when the size of the struct is not one that a header had.
absl::Status CheckQuerySize(const pleat_query& query);
// kInvalidArgument when there are flags that this version does not know.
absl::Status CheckFlags(const pleat_query& query);

// Checks that the memory of the caller holds the rows of all vertices. name: what messages call
// them.
absl::StatusOr<VertexRows> TakeRows(absl::string_view name, const pleat_rows& given,
                                    int num_vertices);
// The same for positions and normals of a query.
absl::StatusOr<QueryTarget> TakeTarget(const pleat_query& query, int num_vertices);

// Copies the poses that the model looks at, or the factors of the bones.
absl::Status TakePoses(const pleat_query& query, const CharacterModel& character, QuerySlot* slot);
void TakeScales(const pleat_query& query, int num_joints, QuerySlot* slot);

// Writes what is left when the positions of a query are there: normals, confidence and code.
void Finish(const CharacterModel& character, const QueryTarget& target, double confidence,
            pleat_query* query);

}  // namespace pleat
