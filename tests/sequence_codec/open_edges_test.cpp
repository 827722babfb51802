#include "open_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(OpenEdgesTest, EdgesAreDirectedAndTheNewestStandLast) {
  OpenEdges edges(4, 12);
  edges.Add(0, 1);
  edges.Add(0, 2);
  edges.Add(3, 2);
  EXPECT_TRUE(edges.Contains(0, 1));
  EXPECT_FALSE(edges.Contains(1, 0));
  EXPECT_THAT(edges.EndsFrom(0), ElementsAre(1, 2));
  EXPECT_THAT(edges.StartsTo(2), ElementsAre(0, 3));
  EXPECT_THAT(edges.EndsFrom(1), IsEmpty());
  EXPECT_THAT(edges.StartsTo(0), IsEmpty());
}

TEST(OpenEdgesTest, RemovingTakesOneOfBothListsAndKeepsTheOrderOfTheRest) {
  OpenEdges edges(5, 12);
  for (const int end : {1, 2, 3, 2}) edges.Add(0, end);  // (0, 2) twice: a doubled face
  EXPECT_TRUE(edges.Remove(0, 2));
  EXPECT_THAT(edges.EndsFrom(0), ElementsAre(1, 3, 2));
  EXPECT_THAT(edges.StartsTo(2), ElementsAre(0));
  EXPECT_TRUE(edges.Contains(0, 2));
  EXPECT_TRUE(edges.Remove(0, 2));
  EXPECT_FALSE(edges.Contains(0, 2));
  EXPECT_FALSE(edges.Remove(0, 2));
  EXPECT_FALSE(edges.Remove(4, 0));
  EXPECT_THAT(edges.EndsFrom(0), ElementsAre(1, 3));
}

TEST(OpenEdgesTest, OneVertexWithEveryEdgeRunsOutOfEffort) {
  constexpr int kNumEdges = 200'000;
  OpenEdges edges(2, 3);
  for (int i = 0; i < kNumEdges; ++i) edges.Add(0, 0);
  EXPECT_THAT(edges.CheckEffort(), IsOk());
  // Each question counts all edges of the vertex: 2^28 / 200000 are 1343.
  int num_questions = 0;
  while (edges.CheckEffort().ok() && num_questions < 5000) {
    edges.Contains(0, 0);
    ++num_questions;
  }
  EXPECT_NEAR(num_questions, (1 << 28) / kNumEdges, 2);
  EXPECT_THAT(edges.CheckEffort(), HasStatus(absl::StatusCode::kResourceExhausted,
                                             "too many open edges meet at one vertex"));
}

}  // namespace
}  // namespace pleat
