#include <deque>
#include <mutex>

#include "pleat/base/limit_refusal.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/wire/limit_messages.h"
#include "server/handlers/mock_server.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

constexpr uint64_t kRefused = 429;  // the pose that a quota refuses

// Answers every pose at once, on the caller's thread pool, with its number as the frame. A pose
// that could not be read is rejected.
class EchoStream final : public PoseStream {
 public:
  EchoStream(Executor* executor, LiveListener* listener, bool* destroyed)
      : executor_(executor), listener_(listener), destroyed_(destroyed) {}
  ~EchoStream() override { *destroyed_ = true; }

  const StreamHeader& header() const override { return header_; }
  bool HasRoom() const override { return true; }
  void Push(const LivePose& pose) override {
    std::lock_guard lock(mutex_);
    poses_.push_back(pose);
  }
  absl::Status Acknowledge(uint64_t num_replies) override {
    return num_replies < 100 ? absl::OkStatus() : absl::InvalidArgumentError("not so many");
  }
  bool empty() const override {
    std::lock_guard lock(mutex_);
    return poses_.empty();
  }
  bool ready() const override { return !empty(); }
  void Answer() override {
    executor_->Post([this] {
      LiveReply reply;
      {
        std::lock_guard lock(mutex_);
        reply.number = poses_.front().number;
        if (reply.number == kRefused) {
          reply.frame = RefuseForLimit({.subject = "project:robots",
                                        .limit = "--project-frames-per-second",
                                        .retry_after = absl::Milliseconds(40)},
                                       "too many frames");
        } else if (poses_.front().status.ok()) {
          reply.frame = EncodedFrame{.draco = std::to_string(reply.number), .evaluate_us = 7};
        } else {
          reply.frame = poses_.front().status;
        }
        poses_.pop_front();
      }
      reply.num_superseded = 2;
      reply.queue_us = 5;
      reply.num_together = 3;
      listener_->OnReply(std::move(reply));
    });
  }

 private:
  Executor* const executor_;
  LiveListener* const listener_;
  bool* const destroyed_;
  StreamHeader header_;
  mutable std::mutex mutex_;
  std::deque<LivePose> poses_;  // guarded by mutex_
};

class LiveSessionHandlerTest : public testing::Test {
 protected:
  static v1::LiveSessionRequest Start() {
    v1::LiveSessionRequest request;
    request.mutable_start()->mutable_character()->set_model_id(kId);
    request.mutable_start()->set_latest_wins(true);
    request.mutable_start()->set_max_in_flight(9);
    return request;
  }
  static v1::LiveSessionRequest PoseMessage(uint64_t number) {
    v1::LiveSessionRequest request;
    request.mutable_pose()->set_number(number);
    request.mutable_pose()->mutable_pose()->add_rotations()->set_w(1);
    return request;
  }
  void ExpectStream() {
    EXPECT_CALL(mock_.service.mock_poses, OpenStream(kId, _, _, _))
        .WillOnce([this](const std::string&, const PoseSessionOptions&, LiveRules rules,
                         LiveListener* listener) {
          EXPECT_TRUE(rules.latest_wins);
          EXPECT_EQ(rules.max_in_flight, 9);
          return std::make_unique<EchoStream>(&executor_, listener, &destroyed_);
        });
  }
  // Sends all, then reads until the end.
  grpc::Status Exchange(const std::vector<v1::LiveSessionRequest>& requests) {
    const auto stub = v1::PoseService::NewStub(mock_.channel);
    const auto stream = stub->LiveSession(&mock_.call);
    bool open = true;
    for (const auto& request : requests) open = open && stream->Write(request);
    stream->WritesDone();
    v1::LiveSessionResponse response;
    while (stream->Read(&response)) responses_.push_back(response);
    return stream->Finish();
  }

  bool destroyed_ = false;
  Executor executor_{1};  // of the stream
  MockServer mock_;
  std::vector<v1::LiveSessionResponse> responses_;
};

TEST_F(LiveSessionHandlerTest, EveryPoseGetsItsReply) {
  ExpectStream();
  EXPECT_TRUE(Exchange({Start(), PoseMessage(10), PoseMessage(11)}).ok());
  ASSERT_EQ(responses_.size(), 3u);
  EXPECT_TRUE(responses_[0].has_header());
  EXPECT_EQ(responses_[1].frame().number(), 10u);
  EXPECT_EQ(responses_[1].frame().draco(), "10");
  EXPECT_EQ(responses_[1].report().num_superseded(), 2u);
  EXPECT_EQ(responses_[1].report().queue_us(), 5u);
  EXPECT_EQ(responses_[1].report().evaluate_us(), 7u);
  EXPECT_EQ(responses_[1].report().evaluated_together(), 3u);
  EXPECT_EQ(responses_[2].frame().number(), 11u);
  EXPECT_TRUE(destroyed_);
}

TEST_F(LiveSessionHandlerTest, APoseThatCannotBeShownIsAnAnswer) {
  ExpectStream();
  v1::LiveSessionRequest bad = PoseMessage(10);
  bad.mutable_pose()->mutable_pose()->mutable_rotations(0)->set_w(2);
  EXPECT_TRUE(Exchange({Start(), bad, PoseMessage(11)}).ok());
  ASSERT_EQ(responses_.size(), 3u);
  EXPECT_EQ(responses_[1].rejection().number(), 10u);
  EXPECT_EQ(responses_[1].rejection().code(), 3);
  EXPECT_EQ(responses_[1].report().evaluate_us(), 0u);
  EXPECT_EQ(responses_[2].frame().number(), 11u);
}

TEST_F(LiveSessionHandlerTest, APoseThatAQuotaRefusesSaysWhenToComeAgain) {
  ExpectStream();
  EXPECT_TRUE(Exchange({Start(), PoseMessage(kRefused), PoseMessage(11)}).ok());
  ASSERT_EQ(responses_.size(), 3u);
  const v1::PoseRejection& rejection = responses_[1].rejection();
  EXPECT_EQ(rejection.code(), 8);
  const auto refusal = LimitRefusalOf(
      WithLimitDetails(absl::ResourceExhaustedError(rejection.message()), rejection.details()));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->limit, "--project-frames-per-second");
  EXPECT_EQ(refusal->retry_after, absl::Milliseconds(40));
  EXPECT_EQ(responses_[2].frame().number(), 11u);
}

TEST_F(LiveSessionHandlerTest, TheStartComesFirst) {
  EXPECT_THAT(Exchange({PoseMessage(1)}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("start")));
}

TEST_F(LiveSessionHandlerTest, CreditsOutOfRangeNeverReachTheService) {
  v1::LiveSessionRequest start = Start();
  start.mutable_start()->set_max_in_flight(65);
  EXPECT_THAT(Exchange({start}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("max_in_flight")));
}

TEST_F(LiveSessionHandlerTest, AWrongAcknowledgementEndsTheSession) {
  ExpectStream();
  v1::LiveSessionRequest wrong;
  wrong.mutable_acknowledgement()->set_frames_received(100);
  EXPECT_THAT(Exchange({Start(), wrong}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, "not so many"));
  EXPECT_TRUE(destroyed_);
}

TEST_F(LiveSessionHandlerTest, PassesOnThatThereIsNoModel) {
  EXPECT_CALL(mock_.service.mock_poses, OpenStream)
      .WillOnce(testing::Return(testing::ByMove(absl::NotFoundError("no model"))));
  EXPECT_THAT(Exchange({Start()}), HasGrpcStatus(grpc::StatusCode::NOT_FOUND, "no model"));
}

}  // namespace
}  // namespace pleat
