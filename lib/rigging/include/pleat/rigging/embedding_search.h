// Step 7 of the embedding, second half: the cheapest placement, by best-first search.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/rigging/penalties.h"

namespace pleat {

struct SearchOptions {
  // Placements that must cost more than a bound are not kept; the bound starts here and doubles
  // until a placement is found, so that a wrong facing is refused in milliseconds.
  double first_bound = .02;
  double max_bound = 1.28;
  int max_states = 400000;  // kept at one bound, against a search without end
};

struct SearchResult {
  std::vector<int> spheres;  // per joint of the search tree
  double penalty = 0;        // the residual of method.md, 2.2
  int num_states = 0;        // generated in all
};

// Places the joints of model.tree() in their order. The remainder of a partial placement is bounded
// from below by the cheapest pair penalties of the open subtrees given their placed parents, which
// the context penalties can only raise: the search is exact (Baran and Popovic 2007, section 3.3,
// with a tighter remainder). kNotFound when every placement costs more than max_bound,
// kResourceExhausted when max_states was reached, kCancelled.
absl::StatusOr<SearchResult> SearchEmbedding(const PenaltyModel& model,
                                             const SearchOptions& options = {},
                                             const Progress& progress = {});

}  // namespace pleat
