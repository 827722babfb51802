#include "pleat/rigging/embedding_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;

// A scattered cloud of spheres, joined when near.
SphereGraph RandomGraph(uint64_t seed, int num_spheres) {
  Random random(seed);
  std::vector<Sphere> spheres;
  for (int i = 0; i < num_spheres; ++i) {
    spheres.push_back({{random.Uniform(-.3, .3), random.Uniform(0, 1), random.Uniform(-.2, .2)},
                       random.Uniform(.02, .1)});
  }
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < num_spheres; ++i) {
    for (int j = 0; j < i; ++j) {
      if ((spheres[i].center - spheres[j].center).norm() < .55) edges.push_back({i, j});
    }
  }
  return SphereGraph(spheres, edges);
}

// The spheres of the first joints, of which candidate each is said.
std::vector<int> SpheresOf(const PenaltyModel& model, const std::vector<size_t>& placed) {
  std::vector<int> spheres;
  for (size_t j = 0; j < placed.size(); ++j) {
    spheres.push_back(model.candidates(static_cast<int>(j))[placed[j]]);
  }
  return spheres;
}

double BruteForce(const PenaltyModel& model, std::vector<size_t>* placed, double cost) {
  const int j = static_cast<int>(placed->size());
  if (j == static_cast<int>(model.tree().size())) return cost;
  double best = std::numeric_limits<double>::infinity();
  const PlacementContext context = model.MakeContext(j, SpheresOf(model, *placed));
  for (size_t c = 0; c < model.candidates(j).size(); ++c) {
    double step = 0;
    if (j > 0) step = model.PairPenalty(j, c, (*placed)[model.tree()[j].parent]);
    if (std::isfinite(step)) step += model.ContextPenalty(context, model.candidates(j)[c]);
    if (!std::isfinite(step)) continue;
    placed->push_back(c);
    best = std::min(best, BruteForce(model, placed, cost + step));
    placed->pop_back();
  }
  return best;
}

TEST(EmbeddingSearchTest, FindsTheCheapestPlacementOfAll) {
  int num_found = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const SphereGraph graph = RandomGraph(seed, 8);
    const SearchTree tree = MakeHumanSearchTree(1, 0);
    PenaltyOptions penalties;
    penalties.max_deep_candidates = 4;
    penalties.template_scale = .3;
    const PenaltyModel model(graph, tree, 0, 1, penalties);
    std::vector<size_t> placed;
    const double truth = BruteForce(model, &placed, 0);
    SearchOptions options;
    options.max_bound = 10.24;
    const absl::StatusOr<SearchResult> found = SearchEmbedding(model, options);
    if (!std::isfinite(truth) || truth > options.max_bound) {
      EXPECT_THAT(found, HasStatus(absl::StatusCode::kNotFound, _));
      continue;
    }
    ++num_found;
    ASSERT_THAT(found, IsOk());
    EXPECT_NEAR(found->penalty, truth, 1e-12) << "seed " << seed;
  }
  EXPECT_GE(num_found, 4);
}

// The search's bound relies on it: adding a joint never makes a placement cheaper.
TEST(EmbeddingSearchTest, NoPenaltyIsNegative) {
  Random random(3);
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const SphereGraph graph = RandomGraph(seed, 12);
    const SearchTree tree = MakeHumanSearchTree(1, .3 * static_cast<double>(seed));
    const PenaltyModel model(graph, tree, 0, 1);
    int num_finite = 0;
    for (int trial = 0; trial < 300; ++trial) {
      std::vector<size_t> placed;
      for (size_t j = 0; j < tree.size(); ++j) {
        placed.push_back(
            random.UniformInt(static_cast<int>(model.candidates(static_cast<int>(j)).size())));
      }
      const std::vector<int> spheres = SpheresOf(model, placed);
      for (size_t k = 1; k < tree.size(); ++k) {
        const int j = static_cast<int>(k);
        const double pair = model.PairPenalty(j, placed[k], placed[tree[k].parent]);
        EXPECT_GE(pair, 0);
        if (!std::isfinite(pair)) continue;
        const std::vector<int> before(spheres.begin(), spheres.begin() + j);
        EXPECT_GE(model.ContextPenalty(model.MakeContext(j, before), spheres[k]), 0);
        ++num_finite;
      }
    }
    EXPECT_GT(num_finite, 20);
  }
}

TEST(EmbeddingSearchTest, BoundsDecideWhatIsFound) {
  const SphereGraph graph = RandomGraph(2, 10);
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  PenaltyOptions penalties;
  penalties.template_scale = .3;
  const PenaltyModel model(graph, tree, 0, 1, penalties);
  SearchOptions options;
  options.max_bound = 10.24;
  PLEAT_ASSERT_OK_AND_ASSIGN(const SearchResult best, SearchEmbedding(model, options));
  const EmbeddingSearch search(model);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SearchResult again, search.Run(best.penalty * 1.001));
  EXPECT_EQ(again.spheres, best.spheres);
  EXPECT_THAT(search.Run(best.penalty * .999), HasStatus(absl::StatusCode::kNotFound, _));
  options.max_states = 3;
  EXPECT_THAT(EmbeddingSearch(model, options).Run(10),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
}

TEST(EmbeddingSearchTest, CanBeCancelled) {
  const SphereGraph graph = RandomGraph(2, 10);
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  const PenaltyModel model(graph, tree, 0, 1);
  const Progress cancelled({}, [] { return true; });
  EXPECT_TRUE(absl::IsCancelled(EmbeddingSearch(model).Run(10, cancelled).status()));
}

TEST(EmbeddingSearchTest, NoSphereMeansNotFound) {
  const SphereGraph graph({}, std::vector<std::pair<int, int>>{});
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  EXPECT_THAT(SearchEmbedding(PenaltyModel(graph, tree, 0, 1)),
              HasStatus(absl::StatusCode::kNotFound, _));
}

}  // namespace
}  // namespace pleat
