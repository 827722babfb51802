#include "pleat/local/local_character_service.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <latch>
#include <set>
#include <thread>

#include "pleat/formats/model_file.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class LocalCharacterServiceTest : public testing::Test {
 protected:
  void Open(ServiceLimits limits = {}, uint64_t cache_bytes = 1 << 30) {
    service_.reset();
    auto service = LocalCharacterService::Open({.data_dir = folder_.path(),
                                                .memory = {.cache_bytes = cache_bytes},
                                                .limits = limits,
                                                .train = trainer_.function()});
    ASSERT_THAT(service, IsOk());
    service_ = *std::move(service);
  }
  JobInfo RunToEnd(const std::string& job_id) {
    JobInfo last;
    EXPECT_THAT(WatchJob(service_->jobs(), job_id,
                         [&](const JobInfo& info) {
                           last = info;
                           return true;
                         }),
                IsOk());
    return last;
  }
  std::string TrainModel(const MeshSequence& sequence, const std::string& name = "") {
    const std::string id = service_->sequences().Upload(sequence, {})->id;
    return RunToEnd(service_->jobs().CreateTraining({.sequence_ids = {id}, .model_name = name})->id)
        .result_id;
  }

  TemporaryFolder folder_;
  FakeTrainer trainer_;
  std::unique_ptr<LocalCharacterService> service_;
};

TEST_F(LocalCharacterServiceTest, EverythingSurvivesARestart) {
  Open();
  const MeshSequence tube = MakeSwayingTube(5);
  const std::string sequence_id = service_->sequences().Upload(tube, {})->id;
  const JobInfo job = RunToEnd(
      service_->jobs().CreateTraining({.sequence_ids = {sequence_id}, .model_name = "mine"})->id);
  ASSERT_EQ(job.state, JobState::kSucceeded);
  const std::string bytes = service_->models().Download(job.result_id, {}).value();
  Open();
  EXPECT_EQ(service_->sequences().Get(sequence_id)->name, "tube");
  EXPECT_EQ(service_->sequences().Get(sequence_id)->num_frames, 5);
  EXPECT_EQ(service_->jobs().Get(job.id)->state, JobState::kSucceeded);
  EXPECT_EQ(service_->jobs().Get(job.id)->result_id, job.result_id);
  EXPECT_EQ(service_->models().Get(job.result_id)->name, "mine");
  EXPECT_EQ(service_->models().Download(job.result_id, {}).value(), bytes);
  EXPECT_THAT(service_->models().Acquire(job.result_id), IsOk());
}

TEST_F(LocalCharacterServiceTest, AJobThatWasRunningGoesOnAfterARestart) {
  Open();
  trainer_.Hold();
  const std::string sequence_id = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
  const std::string running = service_->jobs().CreateTraining({.sequence_ids = {sequence_id}})->id;
  const std::string waiting =
      service_->jobs().CreateTraining({.sequence_ids = {sequence_id}, .options = {.seed = 2}})->id;
  trainer_.WaitUntilHeld();
  Open();
  trainer_.Release();
  EXPECT_EQ(RunToEnd(running).state, JobState::kSucceeded);
  EXPECT_EQ(RunToEnd(waiting).state, JobState::kSucceeded);
  EXPECT_EQ(trainer_.num_started, 3);
}

TEST_F(LocalCharacterServiceTest, ACompressionGoesOnAfterARestartAndItsFileStays) {
  Open();
  const MeshSequence large = MakeSwayingTube(120, "large", 60, 40);
  const CompressOptions options{.max_error_mm = .2};
  const std::string sequence_id = service_->sequences().Upload(large, {})->id;
  const std::string job = service_->jobs().CreateCompression({sequence_id, options})->id;
  {
    // Listeners are called where the job reports: this one stops it in its encoding until the
    // service shuts down.
    std::latch encoding(1);
    const auto witness = service_->jobs().Subscribe(job, [] {}).value();
    const auto subscription = service_->jobs().Subscribe(job, [&] {
      if (witness->current().info.stage != "encode") return;
      if (!encoding.try_wait()) encoding.count_down();
      while (witness->status().ok()) std::this_thread::yield();
    });
    ASSERT_THAT(subscription, IsOk());
    encoding.wait();
    service_->Shutdown();
    EXPECT_EQ(service_->jobs().Get(job)->state, JobState::kQueued);
  }
  Open();
  const JobInfo done = RunToEnd(job);
  ASSERT_EQ(done.state, JobState::kSucceeded) << done.error;
  EXPECT_EQ(std::get<CompressOptions>(done.options).max_error_mm, .2);
  EXPECT_EQ(done.name, "large");
  const std::string bytes = service_->compressed_sequences().Download(done.result_id, {}).value();
  EXPECT_TRUE(bytes == CompressSequence(large, options, nullptr).value());
  Open();
  EXPECT_EQ(service_->jobs().Get(job)->result_id, done.result_id);
  EXPECT_TRUE(service_->compressed_sequences().Download(done.result_id, {}).value() == bytes);
  EXPECT_EQ(service_->compressed_sequences().Get(done.result_id)->record->sequence_id, sequence_id);
  EXPECT_TRUE(service_->missing_files().empty());
}

TEST_F(LocalCharacterServiceTest, ModelsThatNobodyUsesMakeRoomForOthers) {
  Open();
  const std::string sequence_id = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
  const std::string model_id =
      RunToEnd(service_->jobs().CreateTraining({.sequence_ids = {sequence_id}})->id).result_id;
  auto session = service_->poses().OpenSession(model_id, {});
  ASSERT_THAT(session, IsOk());
  EXPECT_GT(service_->model_bytes(), 0u);
  EXPECT_GT(service_->memory().encoders.used_bytes(), 0u);
  MemoryBudget& all = service_->memory().all;
  const uint64_t used = all.used_bytes();
  EXPECT_EQ(used, service_->model_bytes() + service_->memory().encoders.used_bytes());
  EXPECT_FALSE(all.Reserve(all.capacity_bytes() - used + 1, "all").ok());  // both are in use
  *session = nullptr;
  EXPECT_THAT(all.Reserve(all.capacity_bytes(), "all"), IsOk());
  EXPECT_EQ(service_->model_bytes(), 0u);
}

TEST_F(LocalCharacterServiceTest, AJobWaitsForItsMemoryAndOneThatCanNeverHaveItIsRefused) {
  service_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                          .memory = {.memory_bytes = 64 << 20},
                                          .train = trainer_.function()})
                 .value();
  const std::string sequence_id = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
  std::optional<Reservation> held = service_->memory().all.Reserve(60 << 20, "a test").value();
  const std::string job_id = service_->jobs().CreateTraining({.sequence_ids = {sequence_id}})->id;
  JobInfo last;
  EXPECT_THAT(WatchJob(service_->jobs(), job_id,
                       [&](const JobInfo& info) {
                         if (info.stage == "wait for memory") held.reset();
                         last = info;
                         return true;
                       }),
              IsOk());
  EXPECT_EQ(last.state, JobState::kSucceeded);
  EXPECT_EQ(service_->memory().jobs.used_bytes(), 0u);

  service_.reset();
  service_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                          .memory = {.memory_bytes = 16 << 20},
                                          .train = trainer_.function()})
                 .value();
  EXPECT_THAT(service_->jobs().CreateTraining({.sequence_ids = {sequence_id}}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("--memory-bytes")));
}

TEST_F(LocalCharacterServiceTest, DecodersShareABudget) {
  Open();
  const std::string file = CompressSequence(MakeSwayingTube(20), {}, nullptr).value();
  const std::string id = service_->compressed_sequences().Upload(file, {})->id;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto session, service_->compressed_sequences().OpenDecode(id, {}));
  const uint64_t one = service_->compressed_sequences().decoder_bytes();
  EXPECT_GT(one, file.size() + 96 * 12 * 16);
  session.reset();
  EXPECT_EQ(service_->compressed_sequences().decoder_bytes(), 0u);

  service_.reset();
  service_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                          .memory = {.decode_bytes = 5 * one / 2},
                                          .train = trainer_.function()})
                 .value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto first, service_->compressed_sequences().OpenDecode(id, {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(auto second, service_->compressed_sequences().OpenDecode(id, {5, 9}));
  EXPECT_THAT(service_->compressed_sequences().OpenDecode(id, {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("--decode-bytes")));
  second.reset();
  EXPECT_THAT(service_->compressed_sequences().OpenDecode(id, {}), IsOk());
}

TEST_F(LocalCharacterServiceTest, AnOwnRigSurvivesARestartAndGoesWithItsJob) {
  Open();
  trainer_.Hold();
  const MeshSequence tube = MakeSwayingTube(5);
  const std::string id = service_->sequences().Upload(tube, {})->id;
  const Rig known = MakeFakeModel(tube, {})->rig();
  const std::string rig = EncodeRig({known.skeleton, known.weights, 0, {1}});
  const std::string first = service_->jobs().CreateTraining({.sequence_ids = {id}})->id;
  const JobInfo waiting = *service_->jobs().CreateTraining(
      {.sequence_ids = {id}, .options = {.learner = LearnerChoice::kGp}, .rig = rig});
  EXPECT_EQ(waiting.state, JobState::kQueued);
  const std::string path =
      folder_.path() + "/blobs/" + waiting.rig_id.substr(0, 2) + "/" + waiting.rig_id;
  Open();
  trainer_.Release();
  EXPECT_TRUE(std::filesystem::exists(path) || IsFinal(service_->jobs().Get(waiting.id)->state));
  const JobInfo job = RunToEnd(waiting.id);
  ASSERT_EQ(job.state, JobState::kSucceeded) << job.error;
  EXPECT_EQ(job.rig_id, waiting.rig_id);
  const Skeleton trained = service_->models().Get(job.result_id)->skeleton;
  EXPECT_EQ(trained.joint(1).name, "chest");
  EXPECT_EQ(trained.rest_position(1), known.skeleton.rest_position(1));  // locked
  EXPECT_TRUE(std::filesystem::exists(path));
  Open();
  EXPECT_FALSE(std::filesystem::exists(path));  // no job needs it any more
  EXPECT_EQ(service_->jobs().Get(waiting.id)->rig_id, waiting.rig_id);
}

TEST_F(LocalCharacterServiceTest, TheModelHasTheNameOfTheJobAndTheSameBytesEachTime) {
  Open();
  const MeshSequence tube = MakeSwayingTube(5);
  const std::string first = TrainModel(tube);
  EXPECT_EQ(service_->models().Get(first)->name, "tube");
  EXPECT_EQ(TrainModel(tube), first);
  EXPECT_EQ(service_->models().List()->size(), 1u);
  const std::string named = TrainModel(tube, "other");
  EXPECT_NE(named, first);
  EXPECT_EQ(DecodeModel(service_->models().Download(named, {}).value()).value()->name(), "other");
  const ModelInfo info = service_->models().Get(named).value();
  EXPECT_EQ(info.skeleton.num_joints(), 3);
  EXPECT_EQ(info.num_control_vertices, tube.num_vertices());
  EXPECT_EQ(info.record.warnings, std::vector<std::string>{"made by a test"});
  EXPECT_GT(info.memory_bytes, 0u);
}

TEST_F(LocalCharacterServiceTest, UploadsGoOnWhereTheyStopped) {
  Open();
  const std::string bytes = EncodeSequence(MakeSwayingTube(5));
  const std::string id = SequenceId(bytes);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                               service_->sequences().BeginUpload(id, bytes.size(), 0));
    ASSERT_THAT(upload->Append(bytes.substr(0, 100)), IsOk());
  }
  Open();
  EXPECT_EQ(service_->sequences().QueryUpload(id)->received_bytes, 100u);
  EXPECT_FALSE(service_->sequences().QueryUpload(id)->complete);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                               service_->sequences().BeginUpload(id, bytes.size(), 100));
    ASSERT_THAT(upload->Append(bytes.substr(100)), IsOk());
    EXPECT_EQ(upload->Finish()->id, id);
  }
  EXPECT_TRUE(service_->sequences().QueryUpload(id)->complete);
  EXPECT_EQ(service_->sequences().Upload(MakeSwayingTube(5), {})->id, id);
  EXPECT_EQ(service_->sequences().List()->size(), 1u);
}

TEST_F(LocalCharacterServiceTest, BytesThatAreNoSequenceAreRefusedAndForgotten) {
  Open();
  // Draco among them: a server decodes none from outside, the client does (client/draco_child).
  for (const std::string& bytes :
       {std::string("this is no sequence file"), std::string("DRACO\x02\x02\x01\x01\0\0", 11)}) {
    const std::string id = SequenceId(bytes);
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                               service_->sequences().BeginUpload(id, bytes.size(), 0));
    ASSERT_THAT(upload->Append(bytes), IsOk());
    EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
    EXPECT_EQ(service_->sequences().QueryUpload(id)->received_bytes, 0u);
  }
  EXPECT_TRUE(service_->sequences().List()->empty());
}

TEST_F(LocalCharacterServiceTest, LimitsAreNamed) {
  Open({.max_upload_bytes = 1 << 20, .max_vertices = 100, .max_frames = 4, .max_clips = 2});
  EXPECT_THAT(service_->sequences().Upload(MakeSwayingTube(5), {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-frames")));
  EXPECT_THAT(service_->sequences().Upload(MakeSwayingTube(2, "large", 20, 20), {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-vertices")));
  EXPECT_THAT(service_->sequences().BeginUpload(std::string(64, 'a'), (1 << 20) + 1, 0),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-upload-bytes")));
  EXPECT_THAT(service_->sequences().BeginUpload(std::string(64, 'a'), 0, 0),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  const std::string bytes = EncodeSequence(MakeSwayingTube(5));  // through the other door
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             service_->sequences().BeginUpload(SequenceId(bytes), bytes.size(), 0));
  ASSERT_THAT(upload->Append(bytes), IsOk());
  EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
  const std::string id = service_->sequences().Upload(MakeSwayingTube(2), {})->id;
  EXPECT_THAT(service_->jobs().CreateTraining({.sequence_ids = {id, id, id}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("1 to 2")));
  const std::string model_id = TrainModel(MakeSwayingTube(2));
  const PoseTrack track = MakeMotion(service_->models().Get(model_id)->skeleton, 5);
  EXPECT_THAT(service_->poses().OpenClip(model_id, track, {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-frames")));
}

TEST_F(LocalCharacterServiceTest, ADeletedModelStaysUsableForThoseWhoHoldIt) {
  Open();
  const std::string id = TrainModel(MakeSwayingTube(5));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, service_->poses().OpenSession(id, {}));
  ASSERT_THAT(service_->models().Delete(id), IsOk());
  const Pose rest = Pose::Rest(MakeFakeModel(MakeSwayingTube(5), {})->skeleton());
  EXPECT_THAT(session->Show({&rest}), IsOk());
  EXPECT_THAT(service_->models().Acquire(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_->models().Delete(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_F(LocalCharacterServiceTest, TheCacheGivesMemoryBack) {
  Open({}, 200'000);
  std::vector<std::string> ids;
  for (int frames = 2; frames < 8; ++frames) ids.push_back(TrainModel(MakeSwayingTube(frames)));
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 6u);
  for (int round = 0; round < 3; ++round) {
    for (const std::string& id : ids) ASSERT_THAT(service_->models().Acquire(id), IsOk());
    EXPECT_LE(service_->models().cache_stats().used_bytes, 200'000u);
  }
  EXPECT_EQ(service_->models().cache_stats().num_pinned, 0);
}

TEST_F(LocalCharacterServiceTest, DamagedFilesAreNoticed) {
  Open();
  const std::string id = TrainModel(MakeSwayingTube(5));
  const std::string path = folder_.path() + "/blobs/" + id.substr(0, 2) + "/" + id;
  ASSERT_TRUE(std::filesystem::exists(path));
  std::ofstream(path, std::ios::in | std::ios::binary).seekp(100).write("damage", 6);
  EXPECT_THAT(service_->models().Acquire(id), HasStatus(absl::StatusCode::kDataLoss, testing::_));
  EXPECT_FALSE(std::filesystem::exists(path));  // it is in quarantine
  EXPECT_FALSE(service_->models().Acquire(id).ok());
  Open();
  EXPECT_EQ(service_->missing_files(), std::vector<std::string>{id});
  EXPECT_THAT(service_->models().Delete(id), IsOk());
}

TEST_F(LocalCharacterServiceTest, AJobWhoseSequenceIsGoneFailsWithAReason) {
  Open();
  trainer_.Hold();
  const std::string a = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
  const std::string b = service_->sequences().Upload(MakeSwayingTube(6), {})->id;
  ASSERT_THAT(service_->jobs().CreateTraining({.sequence_ids = {a}}), IsOk());
  const std::string job = service_->jobs().CreateTraining({.sequence_ids = {b}})->id;
  ASSERT_THAT(service_->sequences().Delete(b), IsOk());
  trainer_.Release();
  const JobInfo info = RunToEnd(job);
  EXPECT_EQ(info.state, JobState::kFailed);
  EXPECT_THAT(info.error, HasStatus(absl::StatusCode::kNotFound, HasSubstr("sequence")));
}

TEST_F(LocalCharacterServiceTest, ShutdownEndsWatchers) {
  Open();
  trainer_.Hold();
  const std::string id = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
  ASSERT_THAT(service_->jobs().CreateTraining({.sequence_ids = {id}}), IsOk());
  const std::string waiting = service_->jobs().CreateTraining({.sequence_ids = {id}})->id;
  std::latch watching(1);
  std::thread stopper([&] {
    watching.wait();
    service_->Shutdown();
  });
  EXPECT_THAT(WatchJob(service_->jobs(), waiting,
                       [&](const JobInfo&) {
                         if (!watching.try_wait()) watching.count_down();
                         return true;
                       }),
              HasStatus(absl::StatusCode::kUnavailable, testing::_));
  stopper.join();
}

}  // namespace
}  // namespace pleat
