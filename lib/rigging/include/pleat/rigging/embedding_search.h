// Step 7 of the embedding, second half: finds the cheapest placement, by best-first search.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/rigging/penalties.h"

namespace pleat {

struct SearchOptions {
  // Placements that must cost more than a bound are not kept. The bound starts here and doubles
  // until a placement is found, so that a wrong facing is refused in milliseconds.
  double first_bound = .02;
  double max_bound = .32;
  int max_states = 100000;  // kept at one bound, against a search without end
};

struct SearchResult {
  std::vector<int> spheres;  // per joint of the search tree
  double penalty = 0;        // the residual of docs/method/rig.md#the-residual
  int num_states = 0;        // generated
};

// Places the joints of model.tree() in their order. The remainder of a partial placement is bounded
// from below by the cheapest pair penalties of the open subtrees given their placed parents, which
// the context penalties can only raise: the search is exact (Baran and Popovic 2007, section 3.3,
// with a tighter remainder; docs/method/rig.md#best-first-search).
class EmbeddingSearch {
 public:
  // The model must outlive this object.
  explicit EmbeddingSearch(const PenaltyModel& model, const SearchOptions& options = {});
  ~EmbeddingSearch();

  // Returns the cheapest placement of those that cost at most `bound`. The error is kNotFound when
  // there is none, kResourceExhausted when max_states was reached, and kCancelled. Safe to call
  // from several threads.
  absl::StatusOr<SearchResult> Run(double bound, const Progress& progress = {}) const;

 private:
  class PairTable;
  class BestFirst;
  const PenaltyModel& model_;
  SearchOptions options_;
  std::unique_ptr<const PairTable> table_;
};

// Returns the cheapest placement of all, with deepened bounds. The error is kNotFound when every
// placement costs more than max_bound; otherwise as above.
absl::StatusOr<SearchResult> SearchEmbedding(const PenaltyModel& model,
                                             const SearchOptions& options = {},
                                             const Progress& progress = {});

}  // namespace pleat
