#include "npy_array.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

TEST(NpyTextTest, TextsComeBack) {
  const std::vector<std::string> texts = {"", "skin", "Stoff \xc3\xa4", "\xe5\xb8\x83",
                                          "\xf0\x9f\x91\x97!"};
  const std::string bytes = EncodeNpyTexts(texts);
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(bytes));
  EXPECT_EQ(array.kind, 'U');
  EXPECT_THAT(NpyTexts(array), ElementsAreArray(texts));
}

TEST(NpyTextTest, BytesAndOtherOrdersAreRead) {
  const std::string latin = NpyHeader("|S3", {2}) + std::string(
                                                        "a\0\0b\xe4"
                                                        "c",
                                                        6);
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray bytes, ParseNpy(latin));
  EXPECT_THAT(NpyTexts(bytes), ElementsAre("a",
                                           "b\xc3\xa4"
                                           "c"));
  const std::string big = NpyHeader(">U1", {1}) + std::string("\0\0\0\xe4", 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray turned, ParseNpy(big));
  EXPECT_THAT(NpyTexts(turned), ElementsAre("\xc3\xa4"));
}

TEST(NpyTextTest, CodesThatAreNoneAreReplaced) {
  const std::string bytes = NpyHeader("<U1", {2}) + std::string("\0\xd8\0\0\xff\xff\xff\xff", 8);
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(bytes));
  EXPECT_THAT(NpyTexts(array), ElementsAre("\xef\xbf\xbd", "\xef\xbf\xbd"));
}

}  // namespace
}  // namespace pleat
