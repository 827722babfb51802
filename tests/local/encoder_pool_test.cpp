#include "pleat/local/encoder_pool.h"

#include <gtest/gtest.h>

#include <thread>

#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class EncoderPoolTest : public testing::Test {
 protected:
  std::unique_ptr<EncoderPool::Lease> Take(EncoderPool& pool, const std::string& id,
                                           const FrameEncoderOptions& options = {}) {
    return pool.Take(id, *model_, options).value();
  }

  const std::shared_ptr<const CharacterModel> model_ =
      MakeFakeModel(MakeSwayingTube(5), TrainOptions());
  const Eigen::Matrix3Xf rest_ = model_->rig().rest_positions.cast<float>();
};

TEST_F(EncoderPoolTest, LendsAnEncoderAgainButNeverTwice) {
  EncoderPool pool(64 << 20);
  {
    const auto first = Take(pool, "a"), second = Take(pool, "a");
    EXPECT_NE(&**first, &**second);
    EXPECT_EQ(pool.num_made(), 2u);
    EXPECT_EQ(pool.used_bytes(), 0u);
  }
  EXPECT_GT(pool.used_bytes(), 0u);
  Take(pool, "a");
  EXPECT_EQ(pool.num_made(), 2u);
  Take(pool, "b");
  Take(pool, "a", {.position_bits = 13});
  EXPECT_EQ(pool.num_made(), 4u);
}

TEST_F(EncoderPoolTest, AnEncoderComesBackWithoutMemoryOfItsLastStream) {
  EncoderPool pool(64 << 20);
  const FrameEncoderOptions options{.encoding = FrameEncoding::kDracoDelta};
  std::string first_bytes;
  {
    const auto lease = Take(pool, "a", options);
    first_bytes = (*lease)->Encode(rest_).value();
    ASSERT_THAT((*lease)->Encode(rest_), IsOk());
    EXPECT_FALSE((*lease)->mark().keyframe);
  }
  const auto lease = Take(pool, "a", options);
  EXPECT_EQ((*lease)->Encode(rest_).value(), first_bytes);
  EXPECT_TRUE((*lease)->mark().keyframe);
  EXPECT_EQ(pool.num_made(), 1u);
}

TEST_F(EncoderPoolTest, KeepsWithinItsCapacity) {
  EncoderPool pool(300 * 96 * 2);  // two of the 96 vertices
  { const auto a = Take(pool, "a"), b = Take(pool, "b"), c = Take(pool, "c"); }
  EXPECT_LE(pool.used_bytes(), 300u * 96 * 2);
  EXPECT_EQ(pool.num_made(), 3u);
  const auto a = Take(pool, "a"), b = Take(pool, "b"), c = Take(pool, "c");
  EXPECT_EQ(pool.num_made(), 4u);
  EncoderPool none(0);
  Take(none, "a");
  Take(none, "a");
  EXPECT_EQ(none.num_made(), 2u);
}

TEST_F(EncoderPoolTest, RefusesBadOptionsAndServesManyThreads) {
  EncoderPool pool(1 << 20);
  EXPECT_THAT(pool.Take("a", *model_, {.speed = 11}),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("speed")));
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 50; ++k) EXPECT_THAT((*Take(pool, "a"))->Encode(rest_), IsOk());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(pool.num_made(), 6u);
}

}  // namespace
}  // namespace pleat
