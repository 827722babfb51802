// What projects see of each other: nothing, whatever they ask.
#include "pleat/local/local_project.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "pleat/base/limit_refusal.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/local/local_character_service.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class LocalProjectTest : public testing::Test {
 protected:
  LocalProjectTest() { Open({}); }
  void Open(const ProjectLimits& limits) {
    service_.reset();
    service_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                            .num_pose_threads = 1,
                                            .project = limits,
                                            .train = trainer_.function()})
                   .value();
  }
  LocalProject& robots() { return service_->OfProject("robots"); }
  LocalProject& ghosts() { return service_->OfProject("ghosts"); }
  static JobInfo RunToEnd(LocalProject& project, const std::string& job_id) {
    JobInfo last;
    EXPECT_THAT(WatchJob(project.jobs(), job_id,
                         [&](const JobInfo& info) {
                           last = info;
                           return true;
                         }),
                IsOk());
    return last;
  }
  // Everything that a call says about an id that is nobody's must be said about one of somebody
  // else's, but for the id itself.
  static void ExpectUnknown(const absl::Status& status, const std::string& id) {
    EXPECT_EQ(status.code(), absl::StatusCode::kNotFound) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(id));
  }

  TemporaryFolder folder_;
  FakeTrainer trainer_;
  std::unique_ptr<LocalCharacterService> service_;
  const MeshSequence tube_ = MakeSwayingTube(5);
  const std::string bytes_ = EncodeSequence(tube_);
  const std::string id_ = SequenceId(bytes_);
};

TEST_F(LocalProjectTest, SequencesJobsAndModelsOfOthersAreUnknown) {
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  const JobInfo job =
      RunToEnd(robots(), robots().jobs().CreateTraining({.sequence_ids = {id_}})->id);
  ASSERT_EQ(job.state, JobState::kSucceeded) << job.error;
  const JobInfo compression =
      RunToEnd(robots(), robots().jobs().CreateCompression({.sequence_id = id_})->id);
  const std::string model_id = job.result_id, compressed_id = compression.result_id;
  ASSERT_THAT(robots().poses().OpenSession(model_id, {}), IsOk());  // now it is in the cache

  for (LocalProject* other : {&ghosts(), &service_->OfProject(kDefaultProject)}) {
    ExpectUnknown(other->sequences().Get(id_).status(), id_);
    ExpectUnknown(other->sequences().Delete(id_), id_);
    ExpectUnknown(other->sequences().SetPinned(id_, true), id_);
    ExpectUnknown(other->sequences().DeleteUpload(id_), id_);
    EXPECT_THAT(other->sequences().List().value(), IsEmpty());
    ExpectUnknown(other->jobs().Get(job.id).status(), job.id);
    ExpectUnknown(other->jobs().Cancel(job.id), job.id);
    ExpectUnknown(other->jobs().Delete(job.id), job.id);
    ExpectUnknown(other->jobs().Subscribe(job.id, [] {}).status(), job.id);
    ExpectUnknown(other->jobs().CreateTraining({.sequence_ids = {id_}}).status(), id_);
    ExpectUnknown(other->jobs().CreateCompression({.sequence_id = id_}).status(), id_);
    EXPECT_THAT(other->jobs().List().value(), IsEmpty());
    ExpectUnknown(other->models().Get(model_id).status(), model_id);
    ExpectUnknown(other->models().OpenDownload(model_id, 0).status(), model_id);
    ExpectUnknown(other->models().Delete(model_id), model_id);
    ExpectUnknown(other->models().SetPinned(model_id, true), model_id);
    EXPECT_THAT(other->models().List().value(), IsEmpty());
    ExpectUnknown(other->poses().OpenSession(model_id, {}).status(), model_id);
    ExpectUnknown(other->poses().OpenClip(model_id, {}, {}).status(), model_id);
    ExpectUnknown(other->compressed_sequences().Get(compressed_id).status(), compressed_id);
    ExpectUnknown(other->compressed_sequences().OpenDecode(compressed_id, {}).status(),
                  compressed_id);
    ExpectUnknown(other->compressed_sequences().OpenDownload(compressed_id, 0).status(),
                  compressed_id);
    ExpectUnknown(other->compressed_sequences().Delete(compressed_id), compressed_id);
    EXPECT_THAT(other->compressed_sequences().List().value(), IsEmpty());
  }
  EXPECT_THAT(robots().jobs().Get(job.id), IsOk());
  EXPECT_EQ(robots().models().List()->size(), 1u);
}

// The words for an id of others are those for an id of nobody.
TEST_F(LocalProjectTest, ErrorsDoNotTellForeignIdsFromFreeOnes) {
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  const std::string job_id = robots().jobs().CreateTraining({.sequence_ids = {id_}})->id;
  const std::string free_id(64, 'f'), free_job = "job-0011223344556677";
  const auto with = [](const absl::Status& status, const std::string& id, const std::string& by) {
    std::string text(status.message());
    for (size_t at; (at = text.find(id)) != std::string::npos;) text.replace(at, id.size(), by);
    return text;
  };
  EXPECT_EQ(with(ghosts().sequences().Get(id_).status(), id_, "X"),
            with(ghosts().sequences().Get(free_id).status(), free_id, "X"));
  EXPECT_EQ(with(ghosts().jobs().Cancel(job_id), job_id, "X"),
            with(ghosts().jobs().Cancel(free_job), free_job, "X"));
  EXPECT_EQ(with(ghosts().jobs().Get(job_id).status(), job_id, "X"),
            with(ghosts().jobs().Get(free_job).status(), free_job, "X"));
  RunToEnd(robots(), job_id);
}

TEST_F(LocalProjectTest, AnUploadOfForeignContentBehavesLikeANewOne) {
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  EXPECT_TRUE(robots().sequences().QueryUpload(id_)->complete);
  // It has begun in one more project, too, where somebody writes it.
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto third, service_->OfProject("third").sequences().BeginUpload(
                                                   id_, bytes_.size(), 0));
  ASSERT_THAT(third->Append(bytes_.substr(0, 10)), IsOk());

  PLEAT_ASSERT_OK_AND_ASSIGN(const UploadStatus status, ghosts().sequences().QueryUpload(id_));
  EXPECT_FALSE(status.complete);
  EXPECT_EQ(status.received_bytes, 0u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             ghosts().sequences().BeginUpload(id_, bytes_.size(), 0));
  EXPECT_FALSE(upload->complete());
  EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kFailedPrecondition, _));
  ASSERT_THAT(upload->Append(bytes_), IsOk());
  ASSERT_THAT(upload->Finish(), IsOk());
  EXPECT_EQ(ghosts().sequences().List()->size(), 1u);
  // Each has its own entry, and the file stays for the other.
  ASSERT_THAT(robots().sequences().Delete(id_), IsOk());
  EXPECT_EQ(ghosts().sequences().Load(id_)->num_frames(), 5);
}

TEST_F(LocalProjectTest, AnOperatorMayAllowSharing) {
  Open({.share_content = true});
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  ExpectUnknown(ghosts().sequences().Get(id_).status(), id_);  // sharing is no reading
  PLEAT_ASSERT_OK_AND_ASSIGN(const UploadStatus status, ghosts().sequences().QueryUpload(id_));
  EXPECT_TRUE(status.complete);
  EXPECT_EQ(status.received_bytes, bytes_.size());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             ghosts().sequences().BeginUpload(id_, bytes_.size(), bytes_.size()));
  EXPECT_TRUE(upload->complete());
  EXPECT_EQ(upload->Finish()->name, "tube");
  ASSERT_THAT(robots().sequences().Delete(id_), IsOk());
  EXPECT_EQ(ghosts().sequences().Load(id_)->num_frames(), 5);
}

TEST_F(LocalProjectTest, PagesOfOneProjectAreNoPagesOfAnother) {
  for (int frames : {3, 4, 5}) {
    ASSERT_THAT(robots().sequences().Upload(MakeSwayingTube(frames), {}), IsOk());
    ASSERT_THAT(ghosts().sequences().Upload(MakeSwayingTube(frames), {}), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto page, robots().sequences().ListPage({.size = 1}));
  EXPECT_THAT(robots().sequences().ListPage({.size = 1, .token = page.next_token}), IsOk());
  EXPECT_THAT(ghosts().sequences().ListPage({.size = 1, .token = page.next_token}),
              HasStatus(kInvalid, _));
  EXPECT_EQ(robots().sequences().List()->size(), 3u);
}

TEST_F(LocalProjectTest, JobsOfAllProjectsSurviveARestart) {
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  const std::string job_id = robots().jobs().CreateTraining({.sequence_ids = {id_}})->id;
  const JobInfo before = RunToEnd(robots(), job_id);
  Open({});
  EXPECT_EQ(robots().jobs().Get(job_id)->result_id, before.result_id);
  ExpectUnknown(service_->jobs().Get(job_id).status(), job_id);
  ASSERT_THAT(robots().jobs().Delete(job_id), IsOk());
  EXPECT_THAT(robots().jobs().List().value(), IsEmpty());
}

TEST_F(LocalProjectTest, StoredBytesHaveALimitOfTheProject) {
  Open({.max_bytes = bytes_.size() + 100});
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, robots().sequences().BeginUpload(id_, bytes_.size(), 0));
  // What has been promised counts, and so does what has arrived.
  const absl::Status refused =
      robots().sequences().BeginUpload(std::string(64, 'a'), 101, 0).status();
  EXPECT_THAT(refused,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("--project-bytes")));
  EXPECT_EQ(LimitRefusalOf(refused)->subject, "project:robots");
  EXPECT_TRUE(LimitRefusalOf(refused)->retry_after);
  EXPECT_THAT(ghosts().sequences().BeginUpload(std::string(64, 'a'), 101, 0), IsOk());
  ASSERT_THAT(upload->Append(bytes_.substr(0, 50)), IsOk());
  upload.reset();
  EXPECT_THAT(robots().sequences().BeginUpload(std::string(64, 'a'), bytes_.size() + 51, 0),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
  ASSERT_THAT(robots().sequences().Upload(tube_, {}), IsOk());
  EXPECT_THAT(robots().sequences().Upload(MakeSwayingTube(6), {}),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
  const absl::Status never =
      robots().sequences().BeginUpload(std::string(64, 'a'), bytes_.size() + 101, 0).status();
  EXPECT_FALSE(LimitRefusalOf(never)->retry_after);  // too large for an empty project
  ASSERT_THAT(robots().sequences().Delete(id_), IsOk());
  ASSERT_THAT(robots().sequences().DeleteUpload(id_), IsOk());
  EXPECT_THAT(robots().sequences().BeginUpload(std::string(64, 'a'), bytes_.size(), 0), IsOk());
}

TEST_F(LocalProjectTest, FramesHaveALimitOfTheProject) {
  Open({.frames_per_second = 10});
  for (LocalProject* project : {&robots(), &ghosts()}) {
    ASSERT_THAT(project->sequences().Upload(tube_, {}), IsOk());
  }
  const std::string model_id =
      RunToEnd(robots(), robots().jobs().CreateTraining({.sequence_ids = {id_}})->id).result_id;
  int num_opened = 0;
  absl::Status status;
  while (num_opened < 1000 && (status = robots().poses().OpenSession(model_id, {}).status()).ok()) {
    ++num_opened;
  }
  EXPECT_GE(num_opened, 20);
  EXPECT_LT(num_opened, 1000);
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kResourceExhausted,
                                HasSubstr("--project-frames-per-second")));
  const std::string compressed_id =
      RunToEnd(ghosts(), ghosts().jobs().CreateCompression({.sequence_id = id_})->id).result_id;
  for (int i = 0; i < 4; ++i) {
    EXPECT_THAT(ghosts().compressed_sequences().OpenDecode(compressed_id, {}), IsOk());
  }
  EXPECT_THAT(ghosts().compressed_sequences().OpenDecode(compressed_id, {}),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
}

}  // namespace
}  // namespace pleat
