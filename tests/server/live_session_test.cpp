// Live sessions over a real socket: credits, the latest pose, rejections, slow readers,
// reconnection and shutdown.
#include "pleat/remote/live_session.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/wire/skeleton_messages.h"
#include "server/running_service.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using Stream = grpc::ClientReaderWriter<v1::LiveSessionRequest, v1::LiveSessionResponse>;

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class LiveSessionTest : public testing::Test {
 protected:
  LiveSessionTest() : id_(running_.TrainModel()), model_(Acquire()) {}

  std::shared_ptr<const CharacterModel> Acquire() {
    return running_.local().models().Acquire(id_).value();
  }
  absl::StatusOr<std::unique_ptr<LiveSession>> Open(const LiveSessionOptions& options = {}) {
    return running_.remote().poses().OpenLiveSession(
        {.model_id = id_, .track = {}, .bone_scales = {}}, options);
  }
  // What pose t of `track` looks like, its history being the poses before it.
  Eigen::Matrix3Xf Truth(const PoseTrack& track, int t, double* confidence = nullptr) const {
    EvaluatedFrame frame;
    const absl::Status status = PoseEvaluator(model_).Evaluate(
        {&track.pose(t), &track.pose(std::max(0, t - 1))}, {}, &frame);
    EXPECT_THAT(status, IsOk());
    if (confidence != nullptr) *confidence = frame.confidence;
    return frame.positions;
  }
  static double Steps(const LiveSession& session, const LiveFrame& frame,
                      const Eigen::Matrix3Xf& truth) {
    return (frame.positions - truth).cwiseAbs().maxCoeff() /
           session.decoder().header().box.step_m();
  }
  // Waits until `count`, which somebody increments and notifies, is at least `least`.
  static void WaitFor(const std::atomic<int>& count, int least) {
    for (int now = count; now < least; now = count) count.wait(now);
  }
  // A session by hand, for what the client library does not do.
  std::unique_ptr<Stream> OpenRaw(grpc::ClientContext* context, int max_in_flight,
                                  bool latest_wins) {
    auto stream = stub_->LiveSession(context);
    v1::LiveSessionRequest request;
    request.mutable_start()->mutable_character()->set_model_id(id_);
    request.mutable_start()->set_max_in_flight(max_in_flight);
    request.mutable_start()->set_latest_wins(latest_wins);
    stream->Write(request);
    return stream;
  }
  // A session whose frames nobody reads, and a model whose frames fill every window.
  std::string TrainBigModel() { return running_.TrainModel(MakeSwayingTube(3, "big", 600, 200)); }
  std::unique_ptr<LiveSession> OpenStalled(const std::string& model_id) {
    auto session =
        running_.remote()
            .poses()
            .OpenLiveSession({.model_id = model_id, .track = {}, .bone_scales = {}},
                             {.stream = {.position_bits = 20, .speed = 10}, .max_in_flight = 64})
            .value();
    for (int i = 0; i < 64; ++i) {
      EXPECT_THAT(session->Send(i, Pose::Rest(model_->skeleton())), IsOk());
    }
    return session;
  }
  v1::LiveSessionRequest PoseMessage(uint64_t number, uint64_t frames_received = 0) const {
    v1::LiveSessionRequest request;
    request.mutable_pose()->set_number(number);
    *request.mutable_pose()->mutable_pose() = ToProto(Pose::Rest(model_->skeleton()));
    request.mutable_pose()->set_frames_received(frames_received);
    return request;
  }

  RunningService running_{Reach::kSocket, {}, {.max_receive_bytes = 4 << 20}};
  const std::string id_;
  const std::shared_ptr<const CharacterModel> model_;
  const std::unique_ptr<v1::PoseService::Stub> stub_ = v1::PoseService::NewStub(
      grpc::CreateChannel(running_.address(), grpc::InsecureChannelCredentials()));
};

TEST_F(LiveSessionTest, ShowsEveryPoseAndSaysWhatItCost) {
  const PoseTrack track = MakeMotion(model_->skeleton(), 50);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.stream = {.encoding = encoding}}));
    EXPECT_EQ(session->decoder().header().num_vertices, 96);
    uint64_t last_cpu_us = 0;
    for (int t = 0; t < track.num_frames(); ++t) {
      ASSERT_THAT(session->Send(1000 + t, track.pose(t)), IsOk());
      LiveFrame frame;
      ASSERT_THAT(session->Receive(&frame), IsOk());
      EXPECT_EQ(frame.number, 1000u + t);
      double confidence = 0;
      EXPECT_LE(Steps(*session, frame, Truth(track, t, &confidence)), .505);
      EXPECT_EQ(frame.confidence, confidence);
      EXPECT_EQ(frame.num_superseded, 0);
      EXPECT_FALSE(frame.resumed);
      EXPECT_GT(frame.times.evaluate_us + frame.times.encode_us, 0u);
      EXPECT_LT(frame.times.evaluate_us + frame.times.encode_us + frame.times.queue_us, 5'000'000u);
      EXPECT_GT(frame.times.server_cpu_us, last_cpu_us);
      last_cpu_us = frame.times.server_cpu_us;
    }
    session->SendDone();
    LiveFrame frame;
    EXPECT_THAT(session->Receive(&frame), HasStatus(absl::StatusCode::kOutOfRange, testing::_));
    EXPECT_TRUE(session->ended());
    EXPECT_THAT(session->Send(1, track.pose(0)),
                HasStatus(absl::StatusCode::kUnavailable, testing::_));
  }
}

TEST_F(LiveSessionTest, ABadPoseIsAnsweredWithAReasonAndTheSessionGoesOn) {
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.stream = {.encoding = encoding}}));
    const PoseTrack track = MakeMotion(model_->skeleton(), 2);
    Pose missing = track.pose(1), far = track.pose(1), skewed = track.pose(1);
    missing.rotations.pop_back();
    far.root_position.x() = 1e6;
    skewed.rotations[1].w() = 7;
    LiveFrame frame;
    ASSERT_THAT(session->Send(0, track.pose(0)), IsOk());
    ASSERT_THAT(session->Receive(&frame), IsOk());
    ASSERT_THAT(session->Send(7, missing), IsOk());
    EXPECT_THAT(session->Receive(&frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 rotations")));
    EXPECT_EQ(frame.number, 7u);
    EXPECT_FALSE(session->ended());
    ASSERT_THAT(session->Send(8, skewed), IsOk());
    EXPECT_THAT(session->Receive(&frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("unit quaternions")));
    ASSERT_THAT(session->Send(9, far), IsOk());
    EXPECT_THAT(session->Receive(&frame),
                HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("box")));
    // Good poses in between are history, bad ones are not. `far` was a good pose, too far away.
    ASSERT_THAT(session->Send(10, track.pose(1), {track.pose(0)}), IsOk());
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.number, 10u);
    EXPECT_LE(Steps(*session, frame, Truth(track, 1)), .505);
  }
}

TEST_F(LiveSessionTest, RequestsThatMakeNoSenseEndTheSession) {
  EXPECT_THAT(running_.remote().poses().OpenLiveSession(
                  {.model_id = std::string(64, '0'), .track = {}, .bone_scales = {}}),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(Open({.max_in_flight = 65}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("max_in_flight")));
  v1::LiveSessionRequest second_start, unsent, history = PoseMessage(1);
  second_start.mutable_start();
  unsent.mutable_acknowledgement()->set_frames_received(5);
  for (int i = 0; i < 8; ++i) *history.mutable_pose()->add_history() = history.pose().pose();
  for (const auto& [request, reason] :
       {std::pair(second_start, "after the start"), std::pair(unsent, "only 0 were sent")}) {
    grpc::ClientContext context;
    const auto stream = OpenRaw(&context, 4, false);
    stream->Write(request);
    v1::LiveSessionResponse response;
    while (stream->Read(&response)) {
    }
    const grpc::Status status = stream->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr(reason));
  }
  grpc::ClientContext context;
  EXPECT_EQ(OpenRaw(&context, 65, false)->Finish().error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  grpc::ClientContext second_context;
  const auto stream = OpenRaw(&second_context, 4, false);
  stream->Write(history);
  v1::LiveSessionResponse response;
  ASSERT_TRUE(stream->Read(&response) && stream->Read(&response));
  EXPECT_THAT(response.rejection().message(), HasSubstr("more than 7"));
}

TEST_F(LiveSessionTest, TheLatestPoseWinsWhereTheReaderIsSlow) {
  const PoseTrack track = MakeMotion(model_->skeleton(), 300);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session,
                             Open({.stream = {.encoding = FrameEncoding::kDracoDelta},
                                   .max_in_flight = 2,
                                   .latest_wins = true}));
  // A pose at a time is answered at once.
  LiveFrame frame;
  for (int t = 0; t < 10; ++t) {
    ASSERT_THAT(session->Send(t, track.pose(t)), IsOk());
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.number, static_cast<uint64_t>(t));
  }
  // Now nobody reads, and after the last pose no acknowledgement can come.
  for (int t = 10; t < track.num_frames(); ++t) {
    ASSERT_THAT(session->Send(t, track.pose(t)), IsOk());
  }
  session->SendDone();
  int num_frames = 0, num_superseded = 0, last = 0;
  absl::Status status;
  while ((status = session->Receive(&frame)).ok()) {
    last = static_cast<int>(frame.number);
    EXPECT_LE(Steps(*session, frame, Truth(track, last)), .505) << "history of pose " << last;
    ++num_frames;
    num_superseded += frame.num_superseded;
  }
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kOutOfRange, testing::_));
  EXPECT_EQ(last + 1, track.num_frames());
  EXPECT_EQ(num_frames + num_superseded, track.num_frames() - 10);
  EXPECT_LE(num_frames, 3) << "two under way, and the last one";
}

TEST_F(LiveSessionTest, FramesWaitForAcknowledgements) {
  grpc::ClientContext context;
  const auto stream = OpenRaw(&context, 1, true);
  v1::LiveSessionResponse response;
  ASSERT_TRUE(stream->Read(&response));
  stream->Write(PoseMessage(1));
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().number(), 1u);
  for (int i = 2; i <= 10; ++i) stream->Write(PoseMessage(i));  // none may be answered yet
  v1::LiveSessionRequest acknowledgement;
  acknowledgement.mutable_acknowledgement()->set_frames_received(1);
  stream->Write(acknowledgement);
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().number(), 10u);
  EXPECT_EQ(response.report().num_superseded(), 8u);
  // Without further acknowledgement the last pose is still shown when no message can follow.
  stream->Write(PoseMessage(11));
  stream->WritesDone();
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().number(), 11u);
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(LiveSessionTest, ASenderWaitsForItsCreditsAndEveryPoseIsAnswered) {
  const PoseTrack track = MakeMotion(model_->skeleton(), 200);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.max_in_flight = 3}));
  std::atomic<int> num_sent = 0, num_received = 0;
  std::thread sender([&] {
    for (int t = 0; t < track.num_frames(); ++t) {
      EXPECT_THAT(session->Send(t, track.pose(t)), IsOk());
      // The frame that is being received now has given its credit back already.
      EXPECT_LE(++num_sent, num_received + 1 + 3);
      num_sent.notify_one();
    }
    session->SendDone();
  });
  WaitFor(num_sent, 3);  // the sender goes as far as it may before anybody reads
  LiveFrame frame;
  for (int t = 0; t < track.num_frames(); ++t) {
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.number, static_cast<uint64_t>(t));
    ++num_received;
  }
  EXPECT_THAT(session->Receive(&frame), HasStatus(absl::StatusCode::kOutOfRange, testing::_));
  sender.join();
}

TEST_F(LiveSessionTest, AReaderThatStopsDelaysNobodyAndGoesAway) {
  const std::string big = TrainBigModel();
  std::vector<std::unique_ptr<LiveSession>> stalled;
  for (int i = 0; i < 3; ++i) stalled.push_back(OpenStalled(big));  // more than there are threads
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  LiveFrame frame;
  const auto start = std::chrono::steady_clock::now();
  for (int t = 0; t < 50; ++t) {
    ASSERT_THAT(session->Send(t, Pose::Rest(model_->skeleton())), IsOk());
    ASSERT_THAT(session->Receive(&frame), IsOk());
  }
  EXPECT_LT(SecondsSince(start), 5);
  EXPECT_EQ(running_.local().models().cache_stats().num_pinned, 2);
  stalled.clear();
  running_.server().Shutdown(600);  // returns when all calls have ended
  EXPECT_EQ(running_.local().models().cache_stats().num_pinned, 1);
}

// One client floods the server with calls, 24 at a time; another one edits.
TEST_F(LiveSessionTest, AFloodOfCallsStarvesNoSession) {
  v1::EvaluatePoseRequest request;
  request.mutable_character()->set_model_id(
      running_.TrainModel(MakeSwayingTube(3, "medium", 150, 80)));
  *request.add_poses() = ToProto(Pose::Rest(model_->skeleton()));
  std::atomic<bool> stop = false;
  std::atomic<int> num_answered = 0;
  std::vector<std::thread> flood;
  for (int i = 0; i < 24; ++i) {
    flood.emplace_back([&] {
      while (!stop) {
        grpc::ClientContext context;
        v1::EvaluatePoseResponse response;
        num_answered += stub_->EvaluatePose(&context, request, &response).ok();
        num_answered.notify_one();
      }
    });
  }
  WaitFor(num_answered, 25);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  LiveFrame frame;
  const int before = num_answered;
  for (int t = 0; t < 20; ++t) {
    EXPECT_THAT(session->Send(t, Pose::Rest(model_->skeleton())), IsOk());
    EXPECT_THAT(session->Receive(&frame), IsOk());
  }
  const int meanwhile = num_answered - before;
  stop = true;
  for (std::thread& thread : flood) thread.join();
  // Two threads: a pose waits for the calls in work and one more, not for all 24.
  EXPECT_LE(meanwhile, 20 * 12) << "calls were preferred";
}

TEST_F(LiveSessionTest, GoesOnAfterTheServerWasStartedAgain) {
  const PoseTrack track = MakeMotion(model_->skeleton(), 60);
  for (const bool latest_wins : {false, true}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session,
                               Open({.stream = {.encoding = FrameEncoding::kDracoDelta},
                                     .max_in_flight = 8,
                                     .latest_wins = latest_wins}));
    LiveFrame frame;
    int num_resumed = 0;
    for (int t = 0; t < track.num_frames(); ++t) {
      ASSERT_THAT(session->Send(t, track.pose(t)), IsOk());
      if (t % 20 == 10) {
        // Three poses under way when the server goes; with and without a word to its clients.
        for (int more = 0; more < 3; ++more) {
          ++t;
          ASSERT_THAT(session->Send(t, track.pose(t)), IsOk());
        }
        running_.RestartServer(t < 20 ? 5 : 0);
      }
      do {
        ASSERT_THAT(session->Receive(&frame), IsOk()) << "pose " << t;
        EXPECT_LE(Steps(*session, frame, Truth(track, static_cast<int>(frame.number))), .505)
            << frame.number;
        num_resumed += frame.resumed;
        EXPECT_TRUE(!frame.resumed || frame.mark.keyframe);
      } while (frame.number < static_cast<uint64_t>(t));
    }
    EXPECT_GE(num_resumed, 1);
    session->SendDone();
    EXPECT_THAT(session->Receive(&frame), HasStatus(absl::StatusCode::kOutOfRange, testing::_));
  }
}

TEST_F(LiveSessionTest, GivesUpWhenTheServerStaysAway) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.max_reconnects = 1}));
  ASSERT_THAT(session->Send(1, Pose::Rest(model_->skeleton())), IsOk());
  running_.server().Shutdown(0);
  LiveFrame frame;
  absl::Status status;
  while ((status = session->Receive(&frame)).ok()) {
  }
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kUnavailable, testing::_));
  EXPECT_TRUE(session->ended());
  EXPECT_THAT(session->Receive(&frame), HasStatus(absl::StatusCode::kUnavailable, testing::_));
}

TEST_F(LiveSessionTest, IdleAndStalledSessionsDoNotHoldUpTheShutdown) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto idle, Open({.max_reconnects = 0}));
  grpc::ClientContext silent_context;
  const auto silent = stub_->LiveSession(&silent_context);  // not even a start
  const std::unique_ptr<LiveSession> stalled = OpenStalled(TrainBigModel());
  const auto start = std::chrono::steady_clock::now();
  running_.server().Shutdown(30);
  EXPECT_LT(SecondsSince(start), 5);
  LiveFrame frame;
  EXPECT_THAT(idle->Receive(&frame), HasStatus(absl::StatusCode::kUnavailable, HasSubstr("shut")));
}

}  // namespace
}  // namespace pleat
