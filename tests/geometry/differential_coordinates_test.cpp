#include "pleat/geometry/differential_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "pleat/mesh/adjacency.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

std::vector<int> AllVertices(const MeshShape& shape) {
  std::vector<int> all(shape.topology.num_vertices());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

TEST(DifferentialCoordinatesTest, AreTheDifferenceToTheMeanOfTheNeighbors) {
  const MeshShape shape = MakeGrid(5, 4, 1, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto coordinates,
      DifferentialCoordinates::Build(shape.topology, shape.positions, AllVertices(shape), .25));
  Eigen::MatrixXd rows(1, 3 * shape.topology.num_vertices());
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows(0, i) = std::sin(3. * double(i));
  const Eigen::MatrixXd encoded = coordinates.Encode(rows);
  const VertexAdjacency adjacency(shape.topology);
  for (int v = 0; v < shape.topology.num_vertices(); ++v) {
    const auto neighbors = adjacency.neighbors(v);
    EXPECT_EQ(coordinates.num_neighbors()[v], static_cast<int>(neighbors.size()));
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (const int n : neighbors) mean += rows.middleCols<3>(3 * n);
    mean /= static_cast<double>(neighbors.size());
    const Eigen::RowVector3d expected = 1.25 * rows.middleCols<3>(3 * v) - mean;
    EXPECT_LT((encoded.middleCols<3>(3 * v) - expected).norm(), 1e-12) << v;
  }
}

TEST(DifferentialCoordinatesTest, DecodingIsTheInverseOnAnySubset) {
  const MeshShape sphere = MakeUvSphere(1, 12, 16);
  for (const int step : {1, 3, 17}) {
    std::vector<int> control;
    for (int v = 0; v < sphere.topology.num_vertices(); v += step) control.push_back(v);
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const auto coordinates,
        DifferentialCoordinates::Build(sphere.topology, sphere.positions, control));
    for (const int count : coordinates.num_neighbors()) EXPECT_GT(count, 0);
    Eigen::MatrixXd rows(4, 3 * control.size());
    for (Eigen::Index i = 0; i < rows.size(); ++i) rows(i) = std::sin(7. * double(i));
    const Eigen::MatrixXd back =
        coordinates.DecodeColumns(coordinates.Encode(rows).transpose()).transpose();
    EXPECT_LT((back - rows).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(DifferentialCoordinatesTest, AConstantIsCarriedByTheAnchorAlone) {
  const MeshShape sphere = MakeUvSphere(1, 8, 12);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto coordinates,
      DifferentialCoordinates::Build(sphere.topology, sphere.positions, AllVertices(sphere), .01));
  const Eigen::MatrixXd rows =
      Eigen::MatrixXd::Constant(1, 3 * sphere.topology.num_vertices(), 2.0);
  EXPECT_LT((coordinates.Encode(rows).array() - .02).abs().maxCoeff(), 1e-12);
}

TEST(DifferentialCoordinatesTest, RefusesWhatDoesNotFit) {
  const MeshShape box = MakeBox({1, 1, 1});
  const auto words = [&](const Eigen::Matrix3Xd& reference, const std::vector<int>& control,
                         double anchor, const std::string& expected) {
    EXPECT_THAT(DifferentialCoordinates::Build(box.topology, reference, control, anchor),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(expected)));
  };
  words(box.positions.leftCols(3), {0}, .1, "reference");
  words(box.positions, {}, .1, "no control");
  words(box.positions, {8}, .1, "vertex 8");
  words(box.positions, {0}, 0, "anchor");
}

}  // namespace
}  // namespace pleat
