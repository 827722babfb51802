#include "pleat/service/compressed_sequence_service.h"

#include <gtest/gtest.h>

#include "support/fake_training.h"
#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::Return;

TEST(DecodeFrames, PassesOnWhyThereIsNoSession) {
  testing::StrictMock<MockCompressedSequenceService> compressed;
  EXPECT_CALL(compressed, OpenDecode("id", _))
      .WillOnce(Return(testing::ByMove(absl::NotFoundError("none"))));
  EXPECT_THAT(DecodeFrames(compressed, "id", {}, {}),
              HasStatus(absl::StatusCode::kNotFound, "none"));
}

TEST(DecodeFrames, CountsFromTheBeginOfTheRangeUntilTheSinkStops) {
  const MeshSequence tube = MakeSwayingTube(2);
  auto session = std::make_unique<testing::StrictMock<MockDecodeSession>>();
  EXPECT_CALL(*session, Shape).WillOnce(Return(MakeSwayingTube(1)));
  EXPECT_CALL(*session, Next).Times(2).WillRepeatedly(Return(&tube.frame(0)));
  testing::StrictMock<MockCompressedSequenceService> compressed;
  EXPECT_CALL(compressed, OpenDecode("id", _))
      .WillOnce(Return(testing::ByMove(std::move(session))));
  std::vector<int> seen;
  const DecodedFramesSink sink{.on_shape = [](const MeshSequence&) { return absl::OkStatus(); },
                               .on_frame =
                                   [&](int t, const Eigen::Matrix3Xf&) {
                                     seen.push_back(t);
                                     return t == 6 ? absl::AbortedError("enough")
                                                   : absl::OkStatus();
                                   }};
  EXPECT_THAT(DecodeFrames(compressed, "id", {5, 9}, sink),
              HasStatus(absl::StatusCode::kAborted, "enough"));
  EXPECT_THAT(seen, testing::ElementsAre(5, 6));
}

class DecodeIntoTest : public testing::Test {
 protected:
  // A sink that counts and says what it is told to.
  DecodedFramesSink Sink(absl::Status on_shape = {}, absl::Status on_frame = {}) {
    return {.on_shape =
                [this, on_shape](const MeshSequence&) {
                  ++num_shapes_;
                  return on_shape;
                },
            .on_frame =
                [this, on_frame](int, const Eigen::Matrix3Xf&) {
                  ++num_frames_;
                  return on_frame;
                }};
  }

  const MeshSequence tube_ = MakeSwayingTube(1);
  testing::StrictMock<MockDecodeSession> session_;
  int num_shapes_ = 0, num_frames_ = 0;
};

TEST_F(DecodeIntoTest, WithoutAShapeThereAreNoFrames) {
  EXPECT_CALL(session_, Shape).WillOnce(Return(absl::DataLossError("torn")));
  EXPECT_THAT(DecodeInto(session_, {}, Sink()), HasStatus(absl::StatusCode::kDataLoss, "torn"));
  EXPECT_EQ(num_shapes_ + num_frames_, 0);
}

TEST_F(DecodeIntoTest, AShapeThatIsNotWantedEndsIt) {
  EXPECT_CALL(session_, Shape).WillOnce(Return(tube_));
  EXPECT_THAT(DecodeInto(session_, {}, Sink(absl::AbortedError("no"))),
              HasStatus(absl::StatusCode::kAborted, "no"));
  EXPECT_EQ(num_shapes_, 1);
  EXPECT_EQ(num_frames_, 0);
}

TEST_F(DecodeIntoTest, AFrameThatFailsEndsItAfterThoseBefore) {
  EXPECT_CALL(session_, Shape).WillOnce(Return(tube_));
  EXPECT_CALL(session_, Next)
      .WillOnce(Return(&tube_.frame(0)))
      .WillOnce(Return(absl::DataLossError("torn")));
  EXPECT_THAT(DecodeInto(session_, {}, Sink()), HasStatus(absl::StatusCode::kDataLoss, "torn"));
  EXPECT_EQ(num_frames_, 1);
}

TEST(DecodeFrames, AsksForTheRangeItWasGiven) {
  testing::StrictMock<MockCompressedSequenceService> compressed;
  EXPECT_CALL(compressed, OpenDecode("id", _))
      .WillOnce([](const std::string&,
                   FrameRange range) -> absl::StatusOr<std::unique_ptr<DecodeSession>> {
        EXPECT_EQ(range.begin, 3);
        EXPECT_EQ(range.end, 8);
        return absl::InvalidArgumentError("not inside");
      });
  EXPECT_THAT(DecodeFrames(compressed, "id", {3, 8}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, "not inside"));
}

}  // namespace
}  // namespace pleat
