#include "npz_arrays.h"

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string MakeArchive() {
  ZipWriter zip({.deflates = true});
  zip.Add("verts.npy", EncodeNpyFloats(std::vector<float>(6), {1, 2, 3}));
  zip.Add("weights.npy", EncodeNpyFloats(std::vector<float>(4), {2, 2}));
  zip.Add("readme.txt", "hello");
  return zip.Finish();
}

TEST(NpzArraysTest, OtherNamesAreSaid) {
  const std::string bytes = MakeArchive();
  PLEAT_ASSERT_OK_AND_ASSIGN(NpzArrays arrays, NpzArrays::Open(bytes, {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto array, arrays.Take(NpzRoles()[0], 1000));
  ASSERT_TRUE(array);
  EXPECT_THAT(arrays.renamed(), ElementsAre("positions from 'verts'"));
  EXPECT_THAT(arrays.NotTaken(), ElementsAre("'weights'", "'readme.txt'"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto none, arrays.Take(NpzRoles()[1], 1000));
  EXPECT_FALSE(none);
}

TEST(NpzArraysTest, TheUsersNameMustBeThere) {
  const std::string bytes = MakeArchive();
  PLEAT_ASSERT_OK_AND_ASSIGN(NpzArrays arrays, NpzArrays::Open(bytes, {.positions = "points"}));
  EXPECT_THAT(arrays.Take(NpzRoles()[0], 1000),
              HasStatus(kInvalid, HasSubstr("'verts' float32 (1, 2, 3), 'weights' float32 (2, 2), "
                                            "'readme.txt' (no array of numbers)")));
}

TEST(NpzArraysTest, TheOnlyAnimationIsFoundByItsShape) {
  const std::string bytes = MakeArchive();
  PLEAT_ASSERT_OK_AND_ASSIGN(NpzArrays arrays, NpzArrays::Open(bytes, {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto array, arrays.TakeOnlyAnimation(1000));
  ASSERT_TRUE(array);
  EXPECT_THAT(array->shape, ElementsAre(1, 2, 3));
}

}  // namespace
}  // namespace pleat
