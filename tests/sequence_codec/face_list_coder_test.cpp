#include "face_list_coder.h"

#include <gtest/gtest.h>

#include "free_numbers.h"
#include "sequence_codec/topology_code.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

TEST(FaceListCoderTest, FacesInAnyOrderRoundTrip) {
  FaceListCode::ExpectRoundTrip(MakeTorus(24, 12, 5).topology);
  FaceListCode::ExpectRoundTrip(QuadsAsModeled(7, 9));
}

TEST(FaceListCoderTest, MeshesAsModeledAreMuchSmallerThanByTheirSurface) {
  const Topology mesh = QuadsAsModeled(40, 50);
  const size_t by_surface = SurfaceCode::Encode(mesh).size();
  EXPECT_LT(8.0 * static_cast<double>(FaceListCode::Encode(mesh).size()) / mesh.num_faces(),
            .5);  // bits
  EXPECT_LT(4 * FaceListCode::Encode(mesh).size(), by_surface);
  FaceListCode::ExpectRoundTrip(mesh);
}

// The same triangle twenty thousand times: every edge stays open.
TEST(FaceListCoderTest, FacesThatTakeTooLongAreRefused) {
  constexpr int kFaces = 20'000;
  std::vector<int32_t> corners;
  for (int f = 0; f < kFaces; ++f) corners.insert(corners.end(), {0, 1, 2});
  const Topology topology =
      *Topology::Create(3, corners, std::vector<int32_t>(static_cast<size_t>(kFaces), 3));
  const std::string bytes = FaceListCode::Encode(topology);
  EXPECT_LT(bytes.size(), 2000u);
  EXPECT_THAT(FaceListCode::Decode(bytes, topology),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("open edges")));
}

TEST(FreeNumbersTest, TakenNumbersAreFoundAndReturned) {
  FreeNumbers numbers(21);
  for (const int taken : {4, 0, 12, 20, 5, 7}) numbers.Take(taken);
  numbers.Return(5);
  const std::vector<int> taken = {0, 4, 7, 12, 20};
  ASSERT_EQ(numbers.num_taken(), static_cast<int>(taken.size()));
  for (size_t rank = 0; rank < taken.size(); ++rank) {
    EXPECT_EQ(numbers.SelectTaken(static_cast<int>(rank)), taken[rank]);
    EXPECT_EQ(taken[rank] - numbers.Rank(taken[rank]), static_cast<int>(rank));
  }
}

}  // namespace
}  // namespace pleat
