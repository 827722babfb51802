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

}  // namespace
}  // namespace pleat
