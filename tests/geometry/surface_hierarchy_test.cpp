#include "pleat/geometry/surface_hierarchy.h"

#include <gtest/gtest.h>

#include <set>

#include "support/test_meshes.h"

namespace pleat {
namespace {

TEST(SurfaceHierarchyTest, OrderHoldsEveryVertexAfterItsNeighbors) {
  const TestMesh mesh = WithExtra(MakeTorus(24, 12, 5), 2, {});  // two lonely vertices
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  std::set<int> seen;
  for (const int v : hierarchy.order()) {
    for (const int n : hierarchy.neighbors(v)) {
      EXPECT_TRUE(seen.contains(n));
      EXPECT_GT(hierarchy.level(n), hierarchy.level(v));
    }
    EXPECT_TRUE(seen.insert(v).second);
    EXPECT_GT(hierarchy.weight(v), 0);
  }
  EXPECT_EQ(static_cast<int>(seen.size()), mesh.topology.num_vertices());
}

TEST(SurfaceHierarchyTest, SynthesisUndoesAnalysis) {
  const TestMesh mesh = MakeTorus(24, 12, 5);
  const Eigen::Matrix3Xf* const none = nullptr;
  for (const Eigen::Matrix3Xf* rest : {&mesh.positions, none}) {
    const SurfaceHierarchy hierarchy(mesh.topology, rest);
    const FieldMatrix fields = FieldMatrix::Random(mesh.positions.cols(), 5);
    FieldMatrix changed = fields;
    hierarchy.Analyze(&changed);
    EXPECT_GT((changed - fields).norm(), 0.1);
    hierarchy.Synthesize(&changed);
    EXPECT_LT((changed - fields).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// Smooth fields must become mostly small coefficients, or there is no compression.
TEST(SurfaceHierarchyTest, SmoothFieldsBecomeSmallCoefficients) {
  const TestMesh mesh = MakeTorus(40, 20, 5);
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  FieldMatrix fields = mesh.positions.transpose();
  hierarchy.Analyze(&fields);
  double fine = 0;
  int count = 0;
  for (const int v : hierarchy.order()) {
    if (hierarchy.level(v) != 0) continue;
    fine += fields.row(v).squaredNorm();
    ++count;
  }
  EXPECT_LT(std::sqrt(fine / count), 0.05 * std::sqrt(mesh.positions.squaredNorm() / 800));
}

// Both ways keep what they must: sums of constants, and columns that know nothing of each other.
TEST(SurfaceHierarchyTest, AConstantHasNoCoefficientsButTheCoarsest) {
  const TestMesh mesh = MakeTorus(24, 12, 5);
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  FieldMatrix fields = FieldMatrix::Constant(mesh.positions.cols(), 2, 3.f);
  hierarchy.Analyze(&fields);
  for (const int v : hierarchy.order()) {
    const float expected = hierarchy.neighbors(v).empty() ? 3.f : 0.f;
    EXPECT_NEAR(fields(v, 0), expected, 1e-5) << v;
  }
}

TEST(SurfaceHierarchyTest, ColumnsAreIndependentAndTheTransformIsLinear) {
  const TestMesh mesh = MakeTorus(16, 8, 5);
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  const FieldMatrix a = FieldMatrix::Random(mesh.positions.cols(), 3);
  const FieldMatrix b = FieldMatrix::Random(mesh.positions.cols(), 3);
  FieldMatrix of_a = a, of_b = b, of_sum = 2 * a - b, alone = a.col(1);
  for (FieldMatrix* fields : {&of_a, &of_b, &of_sum, &alone}) hierarchy.Analyze(fields);
  EXPECT_EQ(FieldMatrix(of_a.col(1)), alone);  // to the bit, for any number of columns
  EXPECT_LT((of_sum - (2 * of_a - of_b)).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(SurfaceHierarchyTest, MeshesThatHardlyHaveLevelsComeBackToo) {
  for (const TestMesh& mesh :
       {MakeTorus(3, 3, 1), WithExtra(MakeTorus(5, 5, 1), 3, {}),
        TestMesh{*Topology::Create(40, {}, {}), Eigen::Matrix3Xf::Zero(3, 40)},
        TestMesh{*Topology::Create(1, {}, {}), Eigen::Matrix3Xf::Zero(3, 1)}}) {
    const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
    EXPECT_EQ(static_cast<int>(hierarchy.order().size()), mesh.topology.num_vertices());
    const FieldMatrix fields = FieldMatrix::Random(mesh.positions.cols(), 2);
    FieldMatrix changed = fields;
    hierarchy.Analyze(&changed);
    hierarchy.Synthesize(&changed);
    EXPECT_LT((changed - fields).cwiseAbs().maxCoeff(), 1e-5);
  }
}

}  // namespace
}  // namespace pleat
