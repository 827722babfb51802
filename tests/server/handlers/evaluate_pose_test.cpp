#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

v1::EvaluatePoseRequest RequestOf(int num_poses) {
  v1::EvaluatePoseRequest request;
  request.mutable_character()->set_model_id(kId);
  request.mutable_character()->set_skinned_only(true);
  for (int h = 0; h < num_poses; ++h) {
    v1::Pose* pose = request.add_poses();
    pose->mutable_root_position()->set_x(h);
    pose->add_rotations()->set_w(1);
  }
  return request;
}

TEST(EvaluatePose, ShowsThePosesAndSendsTheFrame) {
  MockContext mock;
  PoseSessionOptions asked;
  EXPECT_CALL(mock.poses, OpenSession(kId, testing::_))
      .WillOnce([&](const std::string&, PoseSessionOptions options) {
        asked = std::move(options);
        auto session = std::make_unique<testing::StrictMock<MockPoseSession>>();
        EXPECT_CALL(*session, Show).WillOnce([](const std::vector<const Pose*>& poses) {
          EXPECT_EQ(poses.size(), 2u);
          EXPECT_EQ(poses[1]->root_position.x(), 1);
          return EncodedFrame{.draco = "bytes", .confidence = .5};
        });
        return session;
      });
  v1::EvaluatePoseResponse response;
  ASSERT_THAT(EvaluatePose(mock.context, RequestOf(2), &response), IsOk());
  EXPECT_EQ(response.frame().draco(), "bytes");
  EXPECT_EQ(response.frame().confidence(), .5);
  EXPECT_TRUE(asked.skinned_only);
}

TEST(EvaluatePose, WhatIsWrongNeverReachesTheService) {
  MockContext mock;
  v1::EvaluatePoseResponse response;
  for (const int num_poses : {0, 9}) {
    EXPECT_THAT(EvaluatePose(mock.context, RequestOf(num_poses), &response),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("1 to 8")));
  }
  v1::EvaluatePoseRequest request = RequestOf(1);
  request.mutable_poses(0)->mutable_rotations(0)->set_w(2);
  EXPECT_THAT(EvaluatePose(mock.context, request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("norm")));
  request = RequestOf(1);
  request.mutable_character()->set_model_id("x");
  EXPECT_THAT(EvaluatePose(mock.context, request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("model_id")));
}

TEST(EvaluatePose, PassesOnWhyThePoseCannotBeShown) {
  MockContext mock;
  EXPECT_CALL(mock.poses, OpenSession(kId, testing::_))
      .WillOnce([](const std::string&, PoseSessionOptions) {
        auto session = std::make_unique<testing::StrictMock<MockPoseSession>>();
        EXPECT_CALL(*session, Show)
            .WillOnce(testing::Return(absl::InvalidArgumentError("too few joints")));
        return session;
      });
  v1::EvaluatePoseResponse response;
  EXPECT_THAT(EvaluatePose(mock.context, RequestOf(1), &response),
              HasStatus(absl::StatusCode::kInvalidArgument, "too few joints"));
}

}  // namespace
}  // namespace pleat
