// What every CharacterService promises, wherever it runs.
#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "pleat/base/sha256.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/sequence_file.h"
#include "server/running_service.h"
#include "server/watch_to_end.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ContractTest : public testing::TestWithParam<Reach> {
 protected:
  JobInfo WatchToEnd(const std::string& id) { return pleat::WatchToEnd(service_.jobs(), id); }

  RunningService running_{GetParam()};
  CharacterService& service_ = running_.service();
  const std::string unknown_ = std::string(64, '0');
};

TEST_P(ContractTest, SequencesAreStoredOnceUnderTheirContent) {
  const MeshSequence tube = MakeSwayingTube(5);
  double fraction = 0;
  const Progress progress([&](const ProgressUpdate& update) { fraction = update.fraction; }, {});
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo info, service_.sequences().Upload(tube, progress));
  EXPECT_EQ(fraction, 1);
  EXPECT_EQ(info.id, SequenceId(EncodeSequence(tube)));
  EXPECT_EQ(info.name, "tube");
  EXPECT_EQ(info.num_frames, 5);
  EXPECT_EQ(info.num_vertices, 96);
  EXPECT_EQ(info.num_faces, 88);
  EXPECT_EQ(info.frame_rate, (FrameRate{25, 1}));
  EXPECT_EQ(info.size_bytes, EncodeSequence(tube).size());
  EXPECT_EQ(service_.sequences().Upload(tube, {})->id, info.id);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto list, service_.sequences().List());
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].id, info.id);
  EXPECT_EQ(service_.sequences().Get(info.id)->num_frames, 5);
  EXPECT_THAT(service_.sequences().Delete(info.id), IsOk());
  EXPECT_THAT(service_.sequences().Get(info.id),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.sequences().Delete(info.id),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_P(ContractTest, ASequenceOfManyChunksArrivesWhole) {
  const MeshSequence large = MakeSwayingTube(60, "large", 100, 30);  // 2 MB
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo info, service_.sequences().Upload(large, {}));
  EXPECT_GT(info.size_bytes, 2'000'000u);
  EXPECT_EQ(running_.local().sequences().Get(info.id)->num_vertices, 3000);
}

TEST_P(ContractTest, AnUploadCanBeCancelled) {
  const Progress cancelled({}, [] { return true; });
  EXPECT_THAT(service_.sequences().Upload(MakeSwayingTube(60, "large", 100, 30), cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
  EXPECT_TRUE(service_.sequences().List()->empty());
}

TEST_P(ContractTest, AJobThatHasEndedCanBeForgotten) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  running_.trainer().Hold();
  const std::string job = service_.jobs().CreateTraining({.sequence_ids = {id}})->id;
  EXPECT_THAT(service_.jobs().Delete(job),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("cancel it first")));
  running_.trainer().Release();
  const std::string model = WatchToEnd(job).result_id;
  EXPECT_THAT(service_.jobs().Delete(job), IsOk());
  for (const absl::Status& status : {service_.jobs().Delete(job), service_.jobs().Get(job).status(),
                                     service_.jobs().Cancel(job)}) {
    EXPECT_THAT(status, HasStatus(absl::StatusCode::kNotFound, HasSubstr(job)));
  }
  EXPECT_TRUE(service_.jobs().List()->empty());
  EXPECT_THAT(service_.models().Get(model), IsOk());
}

TEST_P(ContractTest, AJobRunsToItsModel) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  TrainOptions options;
  options.seed = 7;
  options.history = 3;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const JobInfo created,
      service_.jobs().CreateTraining(
          {.sequence_ids = {id}, .options = options, .model_name = "swaying"}));
  EXPECT_EQ(created.state, JobState::kQueued);
  EXPECT_EQ(created.options, JobOptions(options));
  const JobInfo job = WatchToEnd(created.id);
  ASSERT_EQ(job.state, JobState::kSucceeded) << job.error;
  EXPECT_EQ(job.fraction, 1);
  EXPECT_EQ(job.name, "swaying");
  EXPECT_EQ(job.warnings, std::vector<std::string>{"made by a test"});
  EXPECT_EQ(job.sequence_ids, std::vector<std::string>{id});
  EXPECT_EQ(service_.jobs().Get(created.id)->result_id, job.result_id);
  EXPECT_EQ(service_.jobs().List()->size(), 1u);

  PLEAT_ASSERT_OK_AND_ASSIGN(const ModelInfo model, service_.models().Get(job.result_id));
  EXPECT_EQ(model.name, "swaying");
  EXPECT_EQ(model.options.seed, 7u);
  EXPECT_EQ(model.skeleton.joint(1).name, "chest");
  EXPECT_EQ(model.num_vertices, 96);
  EXPECT_EQ(service_.models().List()->at(0).id, model.id);

  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, service_.models().Download(model.id, {}));
  EXPECT_EQ(bytes.size(), model.size_bytes);
  EXPECT_EQ(ModelId(bytes), model.id);
  EXPECT_THAT(DecodeModel(bytes), IsOk());

  EXPECT_THAT(service_.models().Delete(model.id), IsOk());
  EXPECT_THAT(service_.models().Get(model.id), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.models().Download(model.id, {}),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_P(ContractTest, AWatchShowsStagesAndEndsWhenTheCallerHasSeenEnough) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  running_.trainer().HoldAt(4);
  const std::string job = service_.jobs().CreateTraining({.sequence_ids = {id}})->id;
  std::set<std::string> stages;
  int num_calls = 0;
  EXPECT_THAT(WatchJob(service_.jobs(), job,
                       [&](const JobInfo& info) {
                         stages.insert(info.stage);
                         ++num_calls;
                         if (info.stage == "learn") running_.trainer().HoldAt(12);
                         return info.fraction < .5;
                       }),
              IsOk());
  EXPECT_TRUE(stages.contains("learn"));
  EXPECT_GE(num_calls, 2);
  EXPECT_FALSE(IsFinal(service_.jobs().Get(job)->state));
}

TEST_P(ContractTest, CancellationActsWithinASecond) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  running_.trainer().Hold();
  const std::string running = service_.jobs().CreateTraining({.sequence_ids = {id}})->id;
  const std::string waiting = service_.jobs().CreateTraining({.sequence_ids = {id}})->id;
  EXPECT_THAT(service_.jobs().Cancel(waiting), IsOk());
  EXPECT_EQ(service_.jobs().Get(waiting)->state, JobState::kCancelled);
  ASSERT_THAT(WatchJob(service_.jobs(), running,
                       [](const JobInfo& info) { return info.state == JobState::kQueued; }),
              IsOk());
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(service_.jobs().Cancel(running), IsOk());
  EXPECT_EQ(WatchToEnd(running).state, JobState::kCancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_THAT(service_.jobs().Cancel(running),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("cancelled")));
}

TEST_P(ContractTest, AJobFailsWithTheReasonOfItsTraining) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  TrainOptions fails;
  fails.iterations = 13;
  const JobInfo job =
      WatchToEnd(service_.jobs().CreateTraining({.sequence_ids = {id}, .options = fails})->id);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_THAT(job.error, HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("rig")));
}

TEST_P(ContractTest, ABadRigIsRefusedBeforeAJobExists) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  const auto expect_refused = [&](const std::string& rig, absl::StatusCode code, const char* word) {
    EXPECT_THAT(service_.jobs().CreateTraining({.sequence_ids = {id}, .rig = rig}),
                HasStatus(code, HasSubstr(word)));
  };
  expect_refused("{", kInvalid, "not JSON");
  expect_refused(std::string("\0\xff\x80", 3), kInvalid, "not JSON");
  expect_refused("[]", kInvalid, "not a JSON object");
  expect_refused(std::string(1000, '['), kInvalid, "nested");
  const std::string head =
      R"({"schema": "pleat.rig_file/1", "joints": [{"name": "a", "position_m": [0, 0, 0]},
          {"name": "b", "parent": "a", "position_m": [0, 1, 0]}])";
  expect_refused(head + R"(, "rest_frame": 5})", kInvalid, "rest_frame 5");
  expect_refused(head + R"(, "weights": {"vertices": [[0, 1]]}})", kInvalid, "96");
  expect_refused(head + R"(, "weights": {"vertices": [[7, 1]]}})", kInvalid, "vertex 0");
  expect_refused(head + std::string(12 << 20, ' ') + "}", absl::StatusCode::kResourceExhausted,
                 "limit");
  EXPECT_TRUE(service_.jobs().List()->empty());
}

TEST_P(ContractTest, BadRequestsAreRefusedAlike) {
  EXPECT_THAT(service_.sequences().Get(unknown_),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.jobs().Get("job-none"), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.jobs().Cancel("job-none"),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(WatchJob(service_.jobs(), "job-none", [](const JobInfo&) { return true; }),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.jobs().CreateTraining({.sequence_ids = {unknown_}}),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.jobs().CreateTraining({}),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  TrainOptions bad;
  bad.history = 99;
  EXPECT_THAT(service_.jobs().CreateTraining({.sequence_ids = {id}, .options = bad}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history")));
  ClipQuery query{.model_id = unknown_,
                  .track = MakeMotion(MakeFakeModel(MakeSwayingTube(2), {})->skeleton(), 2),
                  .bone_scales = {}};
  const auto ignore = [](int, const EvaluatedFrame&) { return absl::OkStatus(); };
  EXPECT_THAT(service_.poses().EvaluateClip(query, ignore),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  query.model_id = running_.TrainModel();
  PoseTrack::Parts parts = query.track.parts();
  for (Pose& pose : parts.poses) pose.rotations.pop_back();
  query.track = PoseTrack::FromValid(std::move(parts));
  EXPECT_THAT(service_.poses().EvaluateClip(query, ignore),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("frame 0")));
}

TEST_P(ContractTest, AClipGivesEveryFrameInOrder) {
  const std::string model_id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(model_id).value();
  for (const bool skinned_only : {false, true}) {
    ClipQuery query{
        .model_id = model_id,
        .track = PoseTrack::FromValid({.fps = 40,
                                       .poses = MakeMotion(model->skeleton(), 30, 40).poses(),
                                       .clip_starts = {0, 11}}),
        .bone_scales = {1, 1.2, .9},
        .skinned_only = skinned_only};
    std::vector<EvaluatedFrame> truth;
    ASSERT_THAT(running_.local().poses().EvaluateClip(query,
                                                      [&](int, const EvaluatedFrame& frame) {
                                                        truth.push_back(frame);
                                                        return absl::OkStatus();
                                                      }),
                IsOk());
    int next = 0;
    ASSERT_THAT(service_.poses().EvaluateClip(
                    query,
                    [&](int t, const EvaluatedFrame& frame) {
                      EXPECT_EQ(t, next++);
                      // 16 bits on a box of about 2 m: half a step is 16 um.
                      EXPECT_LE((frame.positions - truth[t].positions).cwiseAbs().maxCoeff(), 2e-5);
                      EXPECT_EQ(frame.confidence, truth[t].confidence);
                      return absl::OkStatus();
                    }),
                IsOk());
    EXPECT_EQ(next, 30);
  }
}

TEST_P(ContractTest, TheConsumerMayStopAClip) {
  const std::string model_id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(model_id).value();
  const ClipQuery query{
      .model_id = model_id, .track = MakeMotion(model->skeleton(), 100), .bone_scales = {}};
  int num_frames = 0;
  EXPECT_THAT(service_.poses().EvaluateClip(query,
                                            [&](int t, const EvaluatedFrame&) {
                                              ++num_frames;
                                              return t == 3 ? absl::AbortedError("seen enough")
                                                            : absl::OkStatus();
                                            }),
              HasStatus(absl::StatusCode::kAborted, HasSubstr("seen enough")));
  EXPECT_EQ(num_frames, 4);
}

INSTANTIATE_TEST_SUITE_P(Reach, ContractTest,
                         testing::Values(Reach::kLocal, Reach::kInProcess, Reach::kSocket),
                         [](const auto& info) { return ReachName(info.param); });

}  // namespace
}  // namespace pleat
