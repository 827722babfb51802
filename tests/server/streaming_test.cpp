// Streams over a real socket: slow readers, broken uploads, limits, shutdown.
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "pleat/formats/sequence_file.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "pleat/wire/skeleton_messages.h"
#include "server/running_service.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

class StreamingTest : public testing::Test {
 protected:
  std::shared_ptr<grpc::Channel> channel() {
    return grpc::CreateChannel(running_.address(), grpc::InsecureChannelCredentials());
  }
  // Waits until `condition` holds, at most five seconds.
  template <typename Condition>
  static bool Eventually(Condition condition) {
    for (int i = 0; i < 500; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }

  RunningService running_{
      Reach::kSocket, {}, {.max_receive_bytes = 4 << 20, .max_open_streams = 8}};
};

TEST_F(StreamingTest, OnePoseGivesOneFrame) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  const PoseTrack track = MakeMotion(model->skeleton(), 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const EvaluatedFrame frame,
      running_.remote().poses().EvaluatePose({.model_id = id, .track = {}, .bone_scales = {}},
                                             {track.pose(2), track.pose(1)}));
  EvaluatedFrame truth;
  ASSERT_THAT(PoseEvaluator(model).Evaluate({&track.pose(2), &track.pose(1)}, {}, &truth), IsOk());
  EXPECT_LE((frame.positions - truth.positions).cwiseAbs().maxCoeff(), 2e-5);
}

TEST_F(StreamingTest, AClientThatNeverReadsCostsLittleAndGoesAway) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  const auto stub = v1::PoseService::NewStub(channel());
  v1::EvaluateClipRequest request;
  request.mutable_character()->set_model_id(id);
  *request.mutable_track() = ToProto(MakeMotion(model->skeleton(), 5000));
  {
    grpc::ClientContext context;
    const auto reader = stub->EvaluateClip(&context, request);
    v1::EvaluateClipResponse response;
    ASSERT_TRUE(reader->Read(&response));
    EXPECT_TRUE(response.has_header());
    std::this_thread::sleep_for(milliseconds(100));
    EXPECT_EQ(running_.local().models().cache_stats().num_pinned, 1);
    context.TryCancel();
    reader->Finish();
  }
  // The stalled stream has let go of the model, but this test still holds it.
  EXPECT_TRUE(Eventually([&] { return model.use_count() == 2; }));
}

TEST_F(StreamingTest, AWatcherThatDoesNotReadGetsTheNewestStateLater) {
  const std::string sequence_id = running_.service().sequences().Upload(MakeSwayingTube(5), {})->id;
  const std::string job_id =
      running_.service().jobs().CreateTraining({.sequence_ids = {sequence_id}})->id;
  const auto stub = v1::JobService::NewStub(channel());
  grpc::ClientContext context;
  v1::WatchJobRequest request;
  request.set_id(job_id);
  const auto reader = stub->WatchJob(&context, request);
  std::this_thread::sleep_for(milliseconds(300));  // the job is over now
  v1::WatchJobResponse response;
  v1::JobState last = v1::JOB_STATE_UNSPECIFIED;
  while (reader->Read(&response)) last = response.job().state();
  EXPECT_EQ(last, v1::JOB_STATE_SUCCEEDED);
  EXPECT_TRUE(reader->Finish().ok());
}

TEST_F(StreamingTest, ABrokenUploadGoesOnAndTwoWritersDoNotMix) {
  const MeshSequence large = MakeSwayingTube(60, "large", 100, 30);
  const std::string bytes = EncodeSequence(large);
  const std::string id = SequenceId(bytes);
  const auto stub = v1::SequenceService::NewStub(channel());
  v1::UploadSequenceRequest header;
  header.mutable_header()->set_id(id);
  header.mutable_header()->set_size_bytes(bytes.size());
  grpc::ClientContext context;
  v1::UploadSequenceResponse response;
  auto writer = stub->UploadSequence(&context, &response);
  ASSERT_TRUE(writer->Write(header));
  v1::UploadSequenceRequest data;
  data.set_data(bytes.substr(0, 1'000'000));
  ASSERT_TRUE(writer->Write(data));
  ASSERT_TRUE(Eventually(
      [&] { return running_.local().sequences().QueryUpload(id)->received_bytes == 1'000'000; }));
  {
    grpc::ClientContext second_context;
    v1::UploadSequenceResponse second_response;
    const auto second = stub->UploadSequence(&second_context, &second_response);
    second->Write(header);
    second->WritesDone();
    EXPECT_EQ(second->Finish().error_code(), grpc::StatusCode::ABORTED);
  }
  context.TryCancel();  // the connection breaks
  writer->Finish();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo info,
                             running_.service().sequences().Upload(large, {}));
  EXPECT_EQ(info.id, id);
}

TEST_F(StreamingTest, TooManyStreamsAreRefused) {
  const std::string id = running_.TrainModel();
  std::vector<std::unique_ptr<LiveSession>> sessions;
  for (int i = 0; i < 8; ++i) {
    sessions.push_back(running_.remote()
                           .poses()
                           .OpenLiveSession({.model_id = id, .track = {}, .bone_scales = {}})
                           .value());
  }
  EXPECT_THAT(
      running_.remote().poses().OpenLiveSession({.model_id = id, .track = {}, .bone_scales = {}}),
      HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-open-streams")));
  sessions.pop_back();
  EXPECT_TRUE(Eventually([&] {
    return running_.remote()
        .poses()
        .OpenLiveSession({.model_id = id, .track = {}, .bone_scales = {}})
        .ok();
  }));
}

TEST_F(StreamingTest, MessagesAboveTheLimitAreRefused) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  for (const auto& [num_frames, limit] :
       {std::pair(60'000, "larger than max"), std::pair(20'001, "max-frames")}) {
    const ClipQuery query{
        .model_id = id, .track = MakeMotion(model->skeleton(), num_frames), .bone_scales = {}};
    EXPECT_THAT(running_.service().poses().EvaluateClip(
                    query, [](int, const EvaluatedFrame&) { return absl::OkStatus(); }),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr(limit)));
  }
}

TEST_F(StreamingTest, ShutdownLetsAClipEndAndEndsTheRest) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  const std::string sequence_id = running_.service().sequences().List()->at(0).id;
  running_.trainer().Hold();
  const std::string job_id =
      running_.service().jobs().CreateTraining({.sequence_ids = {sequence_id}})->id;
  std::atomic<bool> watching = false;
  const auto stub = v1::JobService::NewStub(channel());
  grpc::Status watched;
  std::thread watcher([&] {
    grpc::ClientContext context;
    v1::WatchJobRequest request;
    request.set_id(job_id);
    const auto reader = stub->WatchJob(&context, request);
    v1::WatchJobResponse response;
    while (reader->Read(&response)) watching = true;
    watched = reader->Finish();
  });
  int num_frames = 0;
  std::thread clip([&] {
    const ClipQuery query{
        .model_id = id, .track = MakeMotion(model->skeleton(), 400), .bone_scales = {}};
    EXPECT_THAT(
        running_.service().poses().EvaluateClip(query,
                                                [&](int, const EvaluatedFrame&) {
                                                  std::this_thread::sleep_for(milliseconds(1));
                                                  ++num_frames;
                                                  return absl::OkStatus();
                                                }),
        IsOk());
  });
  EXPECT_TRUE(Eventually([&] { return watching && num_frames > 10; }));
  std::thread stopper([&] {
    running_.local().Shutdown();
    running_.server().Shutdown(10);
  });
  watcher.join();
  EXPECT_EQ(watched.error_code(), grpc::StatusCode::UNAVAILABLE);
  clip.join();
  EXPECT_EQ(num_frames, 400);
  stopper.join();
}

}  // namespace
}  // namespace pleat
