#include "connectivity_coder.h"

#include <gtest/gtest.h>

#include "free_numbers.h"
#include "sequence_codec/topology_code.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

TEST(ConnectivityCoderTest, QuadsInAnyOrderRoundTrip) {
  SurfaceCode::ExpectRoundTrip(MakeTorus(24, 12, 5).topology);
}

TEST(ConnectivityCoderTest, OrderedMeshesAreSmall) {
  // A strip of quads in order: numbers follow each other, so a face costs a few bits.
  std::vector<int32_t> corners, sizes;
  for (int i = 0; i < 2000; ++i) {
    corners.insert(corners.end(), {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
    sizes.push_back(4);
  }
  const Topology strip = *Topology::Create(4002, corners, sizes);
  EXPECT_LT(SurfaceCode::Encode(strip).size(), 1000u);
  SurfaceCode::ExpectRoundTrip(strip);
}

TEST(FreeNumbersTest, RanksAndSelectionAgree) {
  FreeNumbers numbers(13);
  for (const int taken : {4, 0, 12, 5}) numbers.Take(taken);
  const std::vector<int> left = {1, 2, 3, 6, 7, 8, 9, 10, 11};
  ASSERT_EQ(numbers.num_free(), static_cast<int>(left.size()));
  for (size_t rank = 0; rank < left.size(); ++rank) {
    EXPECT_EQ(numbers.Select(static_cast<int>(rank)), left[rank]);
    EXPECT_EQ(numbers.Rank(left[rank]), static_cast<int>(rank));
  }
}

}  // namespace
}  // namespace pleat
