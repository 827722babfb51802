#include "pleat/rigging/penalties.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using ::testing::Contains;
using ::testing::Not;

// Spheres on the joints of the template itself (index = HumanJoint), joined along its bones.
class PenaltiesTest : public ::testing::Test {
 protected:
  PenaltiesTest() : tree_(MakeHumanSearchTree(1, 0)), graph_(Spheres(), Edges()) {}

  static std::vector<Sphere> Spheres() {
    std::vector<Sphere> spheres;
    for (int j = 0; j < kNumHumanJoints; ++j) {
      spheres.push_back({HumanTemplate().rest_position(j), .02});
    }
    return spheres;
  }
  static std::vector<std::pair<int, int>> Edges() {
    std::vector<std::pair<int, int>> edges;
    for (int j = 1; j < kNumHumanJoints; ++j) edges.push_back({HumanTemplate().parent(j), j});
    return edges;
  }
  static std::vector<int> TrueSpheres() {
    return {kChest, kHips, kHead, kLeftToes, kRightToes, kLeftHand, kRightHand};
  }
  // Which candidate of search joint j `sphere` is.
  static size_t CandidateOn(const PenaltyModel& model, int j, int sphere) {
    const std::vector<int>& candidates = model.candidates(j);
    const auto found = std::ranges::find(candidates, sphere);
    EXPECT_NE(found, candidates.end());
    return found - candidates.begin();
  }
  static double Pair(const PenaltyModel& model, int j, int sphere, int parent_sphere) {
    return model.PairPenalty(j, CandidateOn(model, j, sphere),
                             CandidateOn(model, model.tree()[j].parent, parent_sphere));
  }
  static double Total(const PenaltyModel& model, const std::vector<int>& spheres) {
    double total = 0;
    for (int j = 1; j < static_cast<int>(spheres.size()); ++j) {
      total += Pair(model, j, spheres[j], spheres[model.tree()[j].parent]) +
               model.ContextPenalty(model.MakeContext(j, spheres), spheres[j]);
    }
    return total;
  }

  SearchTree tree_;
  SphereGraph graph_;
};

TEST_F(PenaltiesTest, TheTemplateItselfCostsNothing) {
  const PenaltyModel model(graph_, tree_, 0, 1);
  EXPECT_NEAR(Total(model, TrueSpheres()), 0, 1e-5);
}

TEST_F(PenaltiesTest, OnlyExtremitiesMayHoldLeaves) {
  const PenaltyModel model(graph_, tree_, 0, 1);
  for (int leaf : {kHead, kLeftToes, kRightToes, kLeftHand, kRightHand}) {
    EXPECT_THAT(model.candidates(3), Contains(leaf));
  }
  for (int middle : {kLeftLowerLeg, kSpine, kRightLowerArm}) {
    EXPECT_THAT(model.candidates(3), Not(Contains(middle)));
  }
}

TEST_F(PenaltiesTest, WrongPlacementsCostMore) {
  const PenaltyModel model(graph_, tree_, 0, 1);
  std::vector<int> swapped_sides = {kChest,    kHips,      kHead,    kRightToes,
                                    kLeftToes, kRightHand, kLeftHand};
  std::vector<int> one_leg = TrueSpheres(), raised = TrueSpheres(), hand_for_head = TrueSpheres();
  one_leg[4] = kLeftToes;
  raised[3] = kLeftHand;
  std::swap(hand_for_head[2], hand_for_head[5]);
  for (const auto& wrong : {swapped_sides, one_leg, raised, hand_for_head}) {
    EXPECT_GT(Total(model, wrong), .03);
  }
}

TEST_F(PenaltiesTest, ChainsUnderHalfTheShrunkenTemplateAreForbidden) {
  PenaltyOptions options;
  options.template_scale = 1;
  const SearchTree larger = MakeHumanSearchTree(2.1, 0);
  EXPECT_TRUE(std::isinf(Pair(PenaltyModel(graph_, larger, 0, 2.1, options), 1, kHips, kChest)));
  const SearchTree smaller = MakeHumanSearchTree(1.9, 0);
  EXPECT_TRUE(
      std::isfinite(Pair(PenaltyModel(graph_, smaller, 0, 1.9, options), 1, kHips, kChest)));
}

TEST_F(PenaltiesTest, ReversedTemplateCostsMore) {
  const SearchTree reversed = MakeHumanSearchTree(1, M_PI);
  const PenaltyModel model(graph_, reversed, 0, 1);
  const std::vector<int> mirrored = {kChest,    kHips,      kHead,    kRightToes,
                                     kLeftToes, kRightHand, kLeftHand};
  EXPECT_GT(Total(model, mirrored), .05);  // the feet point backwards
}

}  // namespace
}  // namespace pleat
