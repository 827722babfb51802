#include "pleat/v1/pose_service.grpc.pb.h"
#include "server/handlers/mock_server.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::Return;

class EvaluateClipTest : public testing::Test {
 protected:
  static v1::EvaluateClipRequest Request() {
    v1::EvaluateClipRequest request;
    request.mutable_character()->set_model_id(kId);
    request.mutable_track()->set_fps(25);
    for (int t = 0; t < 2; ++t) {
      request.mutable_track()->add_poses()->add_rotations()->set_w(1);
    }
    return request;
  }
  grpc::Status Evaluate(const v1::EvaluateClipRequest& request,
                        std::vector<v1::EvaluateClipResponse>* responses) {
    const auto stub = v1::PoseService::NewStub(mock_.channel);
    const auto reader = stub->EvaluateClip(&mock_.call, request);
    v1::EvaluateClipResponse response;
    while (reader->Read(&response)) responses->push_back(response);
    return reader->Finish();
  }

  MockServer mock_;
  StreamHeader header_;
};

TEST_F(EvaluateClipTest, SendsTheHeaderAndEveryFrame) {
  header_.num_vertices = 96;
  auto clip = std::make_unique<testing::NiceMock<MockClipSession>>();
  ON_CALL(*clip, header).WillByDefault(testing::ReturnRef(header_));
  EXPECT_CALL(*clip, done).WillOnce(Return(false)).WillOnce(Return(false)).WillOnce(Return(true));
  EXPECT_CALL(*clip, next_frame).WillOnce(Return(0)).WillOnce(Return(1));
  EXPECT_CALL(*clip, Next)
      .WillOnce(Return(EncodedFrame{.draco = "first", .confidence = .5}))
      .WillOnce(Return(EncodedFrame{.draco = "second", .confidence = 1}));
  EXPECT_CALL(mock_.service.mock_poses, OpenClip(kId, _, _))
      .WillOnce([&](const std::string&, const PoseTrack& track, const PoseSessionOptions&) {
        EXPECT_EQ(track.num_frames(), 2);
        return std::move(clip);
      });
  std::vector<v1::EvaluateClipResponse> responses;
  EXPECT_TRUE(Evaluate(Request(), &responses).ok());
  ASSERT_EQ(responses.size(), 3u);
  EXPECT_EQ(responses[0].header().num_vertices(), 96);
  EXPECT_EQ(responses[1].frame().draco(), "first");
  EXPECT_EQ(responses[1].frame().confidence(), .5);
  EXPECT_EQ(responses[2].frame().number(), 1u);
}

TEST_F(EvaluateClipTest, WhatIsWrongNeverReachesTheService) {
  v1::EvaluateClipRequest request = Request();
  request.mutable_character()->set_model_id(kPathId);
  std::vector<v1::EvaluateClipResponse> responses;
  EXPECT_THAT(Evaluate(request, &responses),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("model_id")));
  EXPECT_TRUE(responses.empty());
}

// Clips that nobody read took 41 MB each, as many as there are streams.
TEST(EvaluateClipMemoryTest, ClipsWaitForNobodyAndShareABudget) {
  MockService service;
  const auto server = GrpcServer::Start(&service, {.request_bytes = 100'000}).value();
  const auto stub = v1::PoseService::NewStub(server->InProcessChannel());
  v1::EvaluateClipRequest request;
  request.mutable_character()->set_model_id(kId);
  request.mutable_track()->set_fps(25);
  for (int t = 0; t < 60; ++t) {
    v1::Pose* pose = request.mutable_track()->add_poses();
    for (int j = 0; j < 18; ++j) pose->add_rotations()->set_w(1);
  }
  StreamHeader header;
  const auto evaluate = [&] {
    grpc::ClientContext call;
    const auto reader = stub->EvaluateClip(&call, request);
    v1::EvaluateClipResponse response;
    while (reader->Read(&response)) {
    }
    return reader->Finish();
  };
  EXPECT_CALL(service.mock_poses, OpenClip).Times(3).WillRepeatedly([&] {
    auto clip = std::make_unique<testing::NiceMock<MockClipSession>>();
    ON_CALL(*clip, header).WillByDefault(testing::ReturnRef(header));
    ON_CALL(*clip, done).WillByDefault(Return(true));
    return clip;
  });
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(evaluate().ok());  // each gives its bytes back
  for (int t = 0; t < 60; ++t) *request.mutable_track()->add_poses() = request.track().poses(t);
  EXPECT_THAT(evaluate(), HasGrpcStatus(grpc::StatusCode::RESOURCE_EXHAUSTED,
                                        testing::HasSubstr("--request-bytes")));
}

TEST_F(EvaluateClipTest, PassesOnWhyAFrameCannotBeShown) {
  auto clip = std::make_unique<testing::NiceMock<MockClipSession>>();
  ON_CALL(*clip, header).WillByDefault(testing::ReturnRef(header_));
  EXPECT_CALL(*clip, Next).WillOnce(Return(absl::OutOfRangeError("frame 0: too far")));
  EXPECT_CALL(mock_.service.mock_poses, OpenClip)
      .WillOnce(Return(testing::ByMove(std::move(clip))));
  std::vector<v1::EvaluateClipResponse> responses;
  EXPECT_THAT(Evaluate(Request(), &responses),
              HasGrpcStatus(grpc::StatusCode::OUT_OF_RANGE, "frame 0: too far"));
  EXPECT_EQ(responses.size(), 1u);  // the header
}

}  // namespace
}  // namespace pleat
