#include "pleat/formats/pc2.h"

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

PointCache MakeCache() {
  PointCache cache;
  cache.start_frame = 5;
  for (int t = 0; t < 3; ++t) {
    cache.frames.push_back(Eigen::Matrix3Xf::Constant(3, 4, 0.1f * static_cast<float>(t)));
    cache.frames.back()(1, 2) = -7;
  }
  return cache;
}

TEST(Pc2Test, LayoutIsThePublishedOne) {
  const std::string bytes = EncodePointCache(MakeCache());
  ASSERT_EQ(bytes.size(), 32u + 3 * 4 * 12);
  EXPECT_EQ(bytes.substr(0, 12), std::string("POINTCACHE2\0", 12));
  EXPECT_EQ(bytes[12], 1);  // version
  EXPECT_EQ(bytes[16], 4);  // vertices
  EXPECT_EQ(bytes[28], 3);  // frames
  float value = 0;
  std::memcpy(&value, bytes.data() + 32 + 2 * 12 + 4, 4);  // frame 0, vertex 2, y
  EXPECT_EQ(value, -7);
}

TEST(Pc2Test, FileRoundTrips) {
  const TemporaryFolder folder;
  const PointCache cache = MakeCache();
  ASSERT_THAT(WritePointCache(folder.File("a.pc2"), cache), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const PointCache read, ReadPointCache(folder.File("a.pc2")));
  EXPECT_EQ(read.start_frame, 5);
  ASSERT_EQ(read.frames.size(), 3u);
  for (int t = 0; t < 3; ++t) EXPECT_EQ(read.frames[t], cache.frames[t]);
}

TEST(Pc2Test, LengthMustFitTheHeader) {
  const std::string bytes = EncodePointCache(MakeCache());
  EXPECT_THAT(DecodePointCache(bytes.substr(0, bytes.size() - 1), "a.pc2"),
              HasStatus(absl::StatusCode::kDataLoss,
                        testing::AllOf(HasSubstr("a.pc2"), HasSubstr("2 whole frames"),
                                       HasSubstr("cut off"))));
  EXPECT_THAT(DecodePointCache(bytes + "x", "a.pc2"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("counts are wrong")));
}

TEST(Pc2Test, HeaderFaultsAndLimits) {
  const std::string bytes = EncodePointCache(MakeCache());
  const auto with = [&](size_t at, int32_t value) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &value, 4);
    return DecodePointCache(changed, "a.pc2");
  };
  EXPECT_THAT(DecodePointCache("", "a.pc2"), HasStatus(kInvalid, HasSubstr("empty")));
  EXPECT_THAT(with(0, 0), HasStatus(kInvalid, HasSubstr("POINTCACHE2")));
  EXPECT_THAT(with(12, 2), HasStatus(kInvalid, HasSubstr("version 2")));
  EXPECT_THAT(with(16, 0), HasStatus(kInvalid, HasSubstr("0 vertices")));
  EXPECT_THAT(with(28, -1), HasStatus(kInvalid, HasSubstr("-1 frames")));
  EXPECT_THAT(with(16, 0x7fffffff),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
  EXPECT_THAT(DecodePointCache(bytes, "a.pc2", {.max_sequence_bytes = 100}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("100 bytes")));
}

TEST(Pc2Test, DamagedFilesFailCleanlyOrReadWholeFrames) {
  const std::string bytes = EncodePointCache(MakeCache());
  ForEachTruncation(bytes, [](const std::string& damaged) {
    EXPECT_FALSE(DecodePointCache(damaged, "a.pc2").ok()) << damaged.size();
  });
  ForEachCorruption(bytes, [](const std::string& damaged) {
    const absl::StatusOr<PointCache> cache = DecodePointCache(damaged, "a.pc2");
    if (!cache.ok()) return;
    for (const Eigen::Matrix3Xf& frame : cache->frames) {
      EXPECT_EQ(frame.cols(), cache->frames[0].cols());
    }
  });
}

}  // namespace
}  // namespace pleat
