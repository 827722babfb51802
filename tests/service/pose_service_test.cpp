#include "pleat/service/pose_service.h"

#include <gtest/gtest.h>

#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::Return;

class StreamClipTest : public testing::Test {
 protected:
  // A clip of `frames`; the test says what is done with it.
  void ExpectClip(std::vector<EncodedFrame> frames) {
    auto clip = std::make_unique<testing::NiceMock<MockClipSession>>();
    auto next = std::make_shared<size_t>(0);
    const size_t count = frames.size();
    ON_CALL(*clip, header).WillByDefault(testing::ReturnRef(header_));
    ON_CALL(*clip, done).WillByDefault([next, count] { return *next == count; });
    ON_CALL(*clip, next_frame).WillByDefault([next] { return static_cast<int>(*next); });
    ON_CALL(*clip, Next).WillByDefault([next, frames] { return frames[(*next)++]; });
    EXPECT_CALL(poses_, OpenClip("m", _, _)).WillOnce(Return(testing::ByMove(std::move(clip))));
  }

  testing::StrictMock<MockPoseService> poses_;
  const StreamHeader header_;
  const ClipQuery query_{.model_id = "m", .track = {}, .bone_scales = {}};
};

TEST_F(StreamClipTest, GivesHeaderAndFramesInOrder) {
  ExpectClip({{.draco = "a", .confidence = .25}, {.draco = "b", .confidence = 1}});
  std::string seen;
  EXPECT_THAT(StreamClip(poses_, query_, {},
                         {.on_header =
                              [&](const StreamHeader&) {
                                seen += "header";
                                return absl::OkStatus();
                              },
                          .on_frame =
                              [&](int t, std::string_view draco, const FrameMark&, double) {
                                seen += std::to_string(t) + std::string(draco);
                                return absl::OkStatus();
                              }}),
              IsOk());
  EXPECT_EQ(seen, "header0a1b");
}

TEST_F(StreamClipTest, TheSinkMayStopIt) {
  ExpectClip({{.draco = "a"}, {.draco = "b"}});
  int num_frames = 0;
  EXPECT_THAT(StreamClip(poses_, query_, {},
                         {.on_frame =
                              [&](int, std::string_view, const FrameMark&, double) {
                                ++num_frames;
                                return absl::AbortedError("enough");
                              }}),
              HasStatus(absl::StatusCode::kAborted, "enough"));
  EXPECT_EQ(num_frames, 1);
}

TEST_F(StreamClipTest, ASinkWithoutTheRightDoorIsRefusedBeforeAnythingIsAsked) {
  EXPECT_THAT(StreamClip(poses_, query_, {}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("on_frame")));
  EXPECT_THAT(StreamClip(poses_, query_, {.content = StreamContent::kParameters},
                         {.on_frame = [](int, std::string_view, const FrameMark&,
                                         double) { return absl::OkStatus(); }}),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("on_parameters")));
}

TEST_F(StreamClipTest, AStreamOfParametersMustHaveThem) {
  const auto ignore = [](int, const FrameParameters&) { return absl::OkStatus(); };
  ExpectClip({{.draco = "a"}});
  EXPECT_THAT(StreamClip(poses_, query_, {.content = StreamContent::kParameters},
                         {.on_parameters = ignore}),
              HasStatus(absl::StatusCode::kDataLoss, _));
}

}  // namespace
}  // namespace pleat
