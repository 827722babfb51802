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

}  // namespace
}  // namespace pleat
