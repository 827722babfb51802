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

  // A door for frames that counts them and says `answer` to each.
  auto Counted(absl::Status answer = absl::OkStatus()) {
    return [this, answer](int, std::string_view, const FrameMark&, double) {
      ++num_frames_;
      return answer;
    };
  }

  testing::StrictMock<MockPoseService> poses_;
  int num_frames_ = 0;
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
  EXPECT_THAT(StreamClip(poses_, query_, {}, {.on_frame = Counted(absl::AbortedError("enough"))}),
              HasStatus(absl::StatusCode::kAborted, "enough"));
  EXPECT_EQ(num_frames_, 1);
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

TEST_F(StreamClipTest, AsksForTheClipAsTheQueryAndTheEncodingSay) {
  ClipQuery query{.model_id = "m",
                  .track = {},
                  .bone_scales = {1, 2},
                  .skinned_only = true,
                  .strengths = {.joints = {1, .5}}};
  const FrameEncoderOptions encoding{.encoding = FrameEncoding::kDracoMesh, .position_bits = 15};
  EXPECT_CALL(poses_, OpenClip("m", _, _))
      .WillOnce(
          [&](const std::string&, const PoseTrack&,
              const PoseSessionOptions& options) -> absl::StatusOr<std::unique_ptr<ClipSession>> {
            EXPECT_EQ(options.bone_scales, query.bone_scales);
            EXPECT_TRUE(options.skinned_only);
            EXPECT_EQ(options.strengths.joints, query.strengths.joints);
            EXPECT_EQ(options.encoder.encoding, FrameEncoding::kDracoMesh);
            EXPECT_EQ(options.encoder.position_bits, 15);
            return absl::NotFoundError("no such model");
          });
  EXPECT_THAT(StreamClip(poses_, query, encoding, {.on_frame = Counted()}),
              HasStatus(absl::StatusCode::kNotFound, "no such model"));
}

TEST_F(StreamClipTest, PassesOnMarksAndConfidence) {
  ExpectClip({{.draco = "a", .confidence = .25, .mark = {.keyframe = true, .checksum = 7}},
              {.draco = "b", .confidence = .5, .mark = {.keyframe = false, .checksum = 8}}});
  std::vector<FrameMark> marks;
  std::vector<double> confidences;
  EXPECT_THAT(StreamClip(poses_, query_, {},
                         {.on_frame =
                              [&](int, std::string_view, const FrameMark& mark, double confidence) {
                                marks.push_back(mark);
                                confidences.push_back(confidence);
                                return absl::OkStatus();
                              }}),
              IsOk());
  EXPECT_EQ(marks, (std::vector<FrameMark>{{true, 7}, {false, 8}}));
  EXPECT_EQ(confidences, (std::vector<double>{.25, .5}));
}

TEST_F(StreamClipTest, AHeaderThatIsNotWantedEndsItBeforeTheFirstFrame) {
  ExpectClip({{.draco = "a"}});
  EXPECT_THAT(StreamClip(poses_, query_, {},
                         {.on_header = [](const StreamHeader&) { return absl::AbortedError("no"); },
                          .on_frame = Counted()}),
              HasStatus(absl::StatusCode::kAborted, "no"));
  EXPECT_EQ(num_frames_, 0);
}

TEST_F(StreamClipTest, AFrameThatFailsEndsItAfterThoseBefore) {
  auto clip = std::make_unique<testing::NiceMock<MockClipSession>>();
  ON_CALL(*clip, header).WillByDefault(testing::ReturnRef(header_));
  EXPECT_CALL(*clip, Next)
      .WillOnce(Return(EncodedFrame{.draco = "a"}))
      .WillOnce(Return(absl::InternalError("lost")));
  EXPECT_CALL(poses_, OpenClip).WillOnce(Return(testing::ByMove(std::move(clip))));
  EXPECT_THAT(StreamClip(poses_, query_, {}, {.on_frame = Counted()}),
              HasStatus(absl::StatusCode::kInternal, "lost"));
  EXPECT_EQ(num_frames_, 1);
}

TEST_F(StreamClipTest, ParametersGoToTheirOwnDoor) {
  FrameParameters first, second;
  first.confidence = .5;
  second.coefficients = Eigen::VectorXf::Ones(3);
  ExpectClip({{.parameters = first}, {.parameters = second}});
  std::vector<FrameParameters> seen;
  EXPECT_THAT(StreamClip(poses_, query_, {.content = StreamContent::kParameters},
                         {.on_frame =
                              [](int, std::string_view, const FrameMark&, double) {
                                return absl::InternalError("a frame in a stream of parameters");
                              },
                          .on_parameters =
                              [&](int t, const FrameParameters& parameters) {
                                EXPECT_EQ(t, static_cast<int>(seen.size()));
                                seen.push_back(parameters);
                                return absl::OkStatus();
                              }}),
              IsOk());
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].confidence, .5);
  EXPECT_EQ(seen[1].coefficients, second.coefficients);
}

TEST_F(StreamClipTest, AnEmptyClipIsAHeader) {
  ExpectClip({});
  int num_headers = 0;
  EXPECT_THAT(StreamClip(poses_, query_, {},
                         {.on_header =
                              [&](const StreamHeader&) {
                                ++num_headers;
                                return absl::OkStatus();
                              },
                          .on_frame = Counted()}),
              IsOk());
  EXPECT_EQ(num_headers, 1);
}

}  // namespace
}  // namespace pleat
