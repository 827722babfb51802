// A* over partial placements. Joints are placed one by one in the order of the search tree; a state
// is a placement of the first joints, and its children put the next joint on each of its candidate
// spheres. With 7 joints and a hundred or so candidates each there are far too many placements to
// look at, so two things have to be good: the bound on what a partial placement will still cost,
// and the refusal of what cannot end well.
//
// The bound. Placing joint j costs a *pair* penalty, which depends on j's sphere and its parent's
// alone, and a *context* penalty, which depends on other joints placed before. Context penalties
// are never negative, so leaving them out bounds from below. What is left is a sum over the edges
// of a tree, and its minimum comes from dynamic programming from the leaves up:
//
//   rest(k, p) = min over candidates c of k of
//                    [ pair(k, c, p) + sum over children j of k of rest(j, c) ]
//
// At a partial placement the open joints fall into subtrees that hang on placed joints, and
// subtrees do not see each other in pair penalties; so the sum of their rest(k, p) never exceeds
// the true cost to come. The bound is tighter than the published one. With an admissible bound the
// first complete placement that leaves the queue is a cheapest one: whatever is still queued has a
// bound that is not lower.
//
// Deepening. Best-first search alone would keep every state that costs less than the optimum. For a
// facing that does not fit the optimum is expensive, and that is nearly everything. So states whose
// bound exceeds a limit are not kept at all, the limit starts at .02 and doubles until a placement
// is found. Either the search ends with an exact optimum, or the limit itself is a proof that
// nothing is cheaper. Repeating the earlier levels costs little, since the number of states grows
// steeply with the limit. max_states ends a search whose states are many and all bad.
//
// A state stores only its last candidate and the index of the state before it; a placement is read
// by walking back. Pair penalties need a path each, so they are tabulated once per model and serve
// all limits. The context penalty is the expensive part of a child: it is computed only when the
// pair penalty leaves the child under the limit. Ties go to the state that was made first, so the
// result does not depend on anything but the input.

#include "pleat/rigging/embedding_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr double kCapMargin = .05;  // facings are measured up to a margin above the best one

struct State {
  double cost = 0;  // cost of the joints placed
  int num_placed = 0;
  int previous = -1;   // state without the last joint
  int candidate = -1;  // candidate of the last joint placed
};

}  // namespace

// The pair penalties of all joints and the admissible remainders made from them. A parent has a
// lower index than its children, so counting down visits leaves first. Forbidden pairs are
// infinite, and so is the remainder where no candidate is left.
class EmbeddingSearch::PairTable {
 public:
  // Placements that cost more than `cap` are not told apart.
  PairTable(const PenaltyModel& model, double cap) {
    const SearchTree& tree = model.tree();
    const int num_joints = static_cast<int>(tree.size());
    costs_.resize(num_joints);
    remainders_.resize(num_joints);
    std::vector<Eigen::VectorXd> subtree(num_joints);  // sum of the children's, per own candidate
    for (int j = 0; j < num_joints; ++j) subtree[j].setZero(model.candidates(j).size());
    for (int j = num_joints - 1; j > 0; --j) {
      const std::vector<int>& own = model.candidates(j);
      const std::vector<int>& parents = model.candidates(tree[j].parent);
      costs_[j].resize(own.size(), parents.size());
      for (size_t p = 0; p < parents.size(); ++p) {
        for (size_t c = 0; c < own.size(); ++c) {
          costs_[j](c, p) = model.PairPenalty(j, c, p, cap);
        }
      }
      remainders_[j] = (costs_[j].colwise() + subtree[j]).colwise().minCoeff().transpose();
      subtree[tree[j].parent] += remainders_[j];
    }
  }

  // The cost of joint j on its candidate c with its parent on the parent's candidate p.
  double cost(int j, int c, int p) const { return costs_[j](c, p); }
  // The least sum of pair penalties of the subtree of joint j, its own included.
  double remainder(int j, int p) const { return remainders_[j][p]; }

 private:
  std::vector<Eigen::MatrixXd> costs_;       // candidates x parent's candidates
  std::vector<Eigen::VectorXd> remainders_;  // parent's candidates
};

// One best-first search under one bound.
class EmbeddingSearch::BestFirst {
 public:
  BestFirst(const PenaltyModel& model, const PairTable& table, const SearchOptions& options,
            const Progress& progress)
      : model_(model), table_(table), options_(options), progress_(progress) {}

  // Returns the cheapest placement that costs at most `limit`; kNotFound when there is none.
  absl::StatusOr<SearchResult> Run(double limit) {
    states_ = {State{}};
    for (size_t j = 0; j < model_.tree().size(); ++j) {
      if (model_.candidates(static_cast<int>(j)).empty()) {
        return absl::NotFoundError("a joint has no sphere to lie on");
      }
    }
    queue_.push({0, 0});
    const int num_joints = static_cast<int>(model_.tree().size());
    while (!queue_.empty()) {
      const int index = queue_.top().second;
      queue_.pop();
      if (states_[index].num_placed == num_joints) return Result(index);
      if (progress_.cancelled()) return progress_.Report(0);
      Expand(index, limit);
      if (static_cast<int>(states_.size()) > options_.max_states) {
        return absl::ResourceExhaustedError(
            absl::StrCat("the embedding search kept more than ", options_.max_states, " states"));
      }
    }
    return absl::NotFoundError(absl::StrCat("no embedding costs less than ", limit));
  }

 private:
  std::vector<int> PlacedCandidates(int index) const {
    std::vector<int> candidates(states_[index].num_placed);
    for (int i = index, j = states_[index].num_placed - 1; j >= 0; --j, i = states_[i].previous) {
      candidates[j] = states_[i].candidate;
    }
    return candidates;
  }

  SearchResult Result(int index) const {
    SearchResult result;
    const std::vector<int> candidates = PlacedCandidates(index);
    for (size_t j = 0; j < candidates.size(); ++j) {
      result.spheres.push_back(model_.candidates(static_cast<int>(j))[candidates[j]]);
    }
    result.penalty = states_[index].cost;
    result.num_states = num_generated_;
    return result;
  }

  void Expand(int index, double limit) {
    const State state = states_[index];
    const SearchTree& tree = model_.tree();
    const int j = state.num_placed;
    std::vector<int> placed = PlacedCandidates(index);
    std::vector<int> spheres(j);
    for (int k = 0; k < j; ++k) spheres[k] = model_.candidates(k)[placed[k]];
    const PlacementContext context = model_.MakeContext(j, spheres);
    // The remainder of the open subtrees that hang on joints placed before j; those that hang on j
    // itself depend on its candidate.
    double others = 0;
    for (size_t k = j + 1; k < tree.size(); ++k) {
      if (tree[k].parent < j)
        others += table_.remainder(static_cast<int>(k), placed[tree[k].parent]);
    }
    const std::vector<int>& candidates = model_.candidates(j);
    for (size_t c = 0; c < candidates.size(); ++c) {
      double cost = state.cost;
      if (j > 0) cost += table_.cost(j, static_cast<int>(c), placed[tree[j].parent]);
      double remainder = others;
      for (size_t k = j + 1; k < tree.size(); ++k) {
        if (tree[k].parent == j) {
          remainder += table_.remainder(static_cast<int>(k), static_cast<int>(c));
        }
      }
      if (!(cost + remainder <= limit)) continue;
      ++num_generated_;
      cost += model_.ContextPenalty(context, candidates[c]);
      if (!(cost + remainder <= limit)) continue;
      states_.push_back({cost, j + 1, index, static_cast<int>(c)});
      queue_.push({cost + remainder, static_cast<int>(states_.size()) - 1});
    }
  }

  using Entry = std::pair<double, int>;  // bound, state; the state breaks ties
  const PenaltyModel& model_;
  const PairTable& table_;
  const SearchOptions& options_;
  const Progress& progress_;
  std::vector<State> states_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue_;
  int num_generated_ = 0;
};

EmbeddingSearch::EmbeddingSearch(const PenaltyModel& model, const SearchOptions& options)
    : model_(model),
      options_(options),
      table_(std::make_unique<const PairTable>(model, options.max_bound + kCapMargin)) {}

EmbeddingSearch::~EmbeddingSearch() = default;

absl::StatusOr<SearchResult> EmbeddingSearch::Run(double bound, const Progress& progress) const {
  return BestFirst(model_, *table_, options_, progress).Run(bound);
}

absl::StatusOr<SearchResult> SearchEmbedding(const PenaltyModel& model,
                                             const SearchOptions& options,
                                             const Progress& progress) {
  const EmbeddingSearch search(model, options);
  for (double bound = options.first_bound; bound <= options.max_bound; bound *= 2) {
    absl::StatusOr<SearchResult> found = search.Run(bound, progress);
    if (found.ok() || !absl::IsNotFound(found.status())) return found;
  }
  return absl::NotFoundError(
      absl::StrCat("no placement of the skeleton costs less than ", options.max_bound));
}

}  // namespace pleat
