#include "pleat/formats/vertex_channel.h"

#include <gmock/gmock.h>

#include "npy_array.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(VertexChannelTest, ArraysAndListsAreRead) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::vector<float> npy,
      DecodeVertexChannel(EncodeNpyFloats(std::vector<float>{0, .5f, 2}, {3})));
  EXPECT_THAT(npy, ElementsAre(0, .5f, 2));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::vector<float> column,
      DecodeVertexChannel(EncodeNpyIntegers(std::vector<int32_t>{1, 2}, {2, 1})));
  EXPECT_THAT(column, ElementsAre(1, 2));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<float> list, DecodeVertexChannel("[1, 0.25]"));
  EXPECT_THAT(list, ElementsAre(1, .25f));
}

TEST(VertexChannelTest, WhatIsNoChannelIsRefused) {
  for (const auto& [bytes, reason] :
       {std::pair<std::string, const char*>("", "no JSON list"),
        {"{}", "no JSON list"},
        {"[]", "no numbers"},
        {"[1, \"a\"]", "for vertex 1"},
        {"[1, null]", "for vertex 1"},
        {EncodeNpyFloats(std::vector<float>{1, 2, 3, 4}, {2, 2}), "float32 (2, 2)"},
        {EncodeNpyFloats(std::vector<float>{1, NAN}, {2}), "for vertex 1"},
        {EncodeNpyTexts({"a"}), "one number for each vertex"}}) {
    EXPECT_THAT(DecodeVertexChannel(bytes), HasStatus(kInvalid, HasSubstr(reason)));
  }
  EXPECT_THAT(DecodeVertexChannel("[1, 2, 3]", {.max_vertices = 2}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("3 numbers")));
}

TEST(VertexChannelTest, DamagedChannelsAreRefusedOrRead) {
  const std::string bytes = EncodeNpyFloats(std::vector<float>{1, 2, 3}, {3});
  ForEachTruncation(bytes, [](const std::string& damaged) { (void)DecodeVertexChannel(damaged); });
  ForEachCorruption(bytes, [](const std::string& damaged) { (void)DecodeVertexChannel(damaged); });
}

}  // namespace
}  // namespace pleat
