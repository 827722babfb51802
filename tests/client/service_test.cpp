#include "cli/service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <future>
#include <sstream>
#include <thread>

#include "cli/exit_code.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A service with one job that goes through the states it is told.
class ScriptedService : public CharacterService {
 public:
  explicit ScriptedService(std::vector<JobInfo> script) : script_(std::move(script)) {}

  absl::StatusOr<SequenceInfo> UploadSequence(const MeshSequence&, const Progress&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<SequenceInfo> GetSequence(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<std::vector<SequenceInfo>> ListSequences() override {
    return absl::UnimplementedError("");
  }
  absl::Status DeleteSequence(const std::string&) override { return absl::UnimplementedError(""); }
  absl::StatusOr<JobInfo> CreateTrainingJob(const TrainingRequest&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<JobInfo> CreateCompressionJob(const std::string&,
                                               const CompressOptions&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<JobInfo> GetJob(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<std::vector<JobInfo>> ListJobs() override { return absl::UnimplementedError(""); }
  absl::Status CancelJob(const std::string&) override { return absl::OkStatus(); }
  absl::Status WatchJob(const std::string&,
                        const std::function<bool(const JobInfo&)>& observe) override {
    for (const JobInfo& job : script_) observe(job);
    return absl::OkStatus();
  }
  absl::StatusOr<ModelInfo> GetModel(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<std::vector<ModelInfo>> ListModels() override {
    std::vector<ModelInfo> models(2);
    models[0].id = "abc1";
    models[1].id = "abd2";
    return models;
  }
  absl::Status DeleteModel(const std::string&) override { return absl::UnimplementedError(""); }
  absl::StatusOr<std::string> DownloadModel(const std::string&, const Progress&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<CompressedSequenceInfo> UploadCompressedSequence(const std::string&,
                                                                  const Progress&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<CompressedSequenceInfo> GetCompressedSequence(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<std::vector<CompressedSequenceInfo>> ListCompressedSequences() override {
    return absl::UnimplementedError("");
  }
  absl::Status DeleteCompressedSequence(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::StatusOr<std::string> DownloadCompressedSequence(const std::string&,
                                                         const Progress&) override {
    return absl::UnimplementedError("");
  }
  absl::Status DecodeFrames(const std::string&, FrameRange, const DecodedFramesSink&) override {
    return absl::UnimplementedError("");
  }
  absl::Status EvaluateClip(
      const ClipQuery&, const std::function<absl::Status(int, const EvaluatedFrame&)>&) override {
    return absl::UnimplementedError("");
  }

 private:
  std::vector<JobInfo> script_;
};

JobInfo Job(JobState state, const std::string& stage = "", double fraction = 0) {
  JobInfo job;
  job.id = "j1";
  job.state = state;
  job.stage = stage;
  job.fraction = fraction;
  return job;
}

absl::StatusOr<JobInfo> Watch(std::vector<JobInfo> script,
                              std::map<std::string, double>* seconds = nullptr) {
  std::ostringstream out, err;
  Session session;
  session.out = &out;
  session.err = &err;
  ScriptedService service(std::move(script));
  return WatchJobToEnd(service, "j1", session, true, seconds);
}

TEST(Service, CompletesIdsFromTheirFirstDigits) {
  ScriptedService service({});
  EXPECT_EQ(FindModel(service, "abc").value_or(""), "abc1");
  EXPECT_EQ(FindModel(service, "abd2").value_or(""), "abd2");
  EXPECT_TRUE(IsUsageError(FindModel(service, "ab").status()));
  EXPECT_THAT(FindModel(service, "x"),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no model x")));
  EXPECT_EQ(FindModel(service, "").status().code(), absl::StatusCode::kNotFound);
}

TEST(Service, WatchingEndsWithTheModel) {
  JobInfo done = Job(JobState::kSucceeded, "", 1);
  done.result_id = "m1";
  std::map<std::string, double> seconds;
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo job,
                             Watch({Job(JobState::kQueued), Job(JobState::kRunning, "rig", .1),
                                    Job(JobState::kRunning, "fit", .5), done},
                                   &seconds));
  EXPECT_EQ(job.result_id, "m1");
  EXPECT_EQ(seconds.count("rig"), 1u);
  EXPECT_EQ(seconds.count("fit"), 1u);
}

TEST(Service, AFailedJobGivesItsOwnErrorAndExitCode) {
  JobInfo failed = Job(JobState::kFailed);
  failed.error = absl::FailedPreconditionError("no human-like rig");
  const absl::Status status = Watch({Job(JobState::kRunning, "rig", .1), failed}).status();
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kFailedPrecondition,
                                HasSubstr("job j1 failed: no human-like rig")));
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kRefused);
  EXPECT_EQ(ExitCodeOf(Watch({Job(JobState::kCancelled)}).status()), ExitCode::kCancelled);
}

TEST(Service, AWatchThatBreaksOffIsNotASuccess) {
  const absl::Status status = Watch({Job(JobState::kRunning, "rig", .1)}).status();
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("pleat jobs show j1"));
}

}  // namespace
}  // namespace pleat
