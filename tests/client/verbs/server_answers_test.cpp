// What verbs make of the answers of a server, above all of wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/remote/tetrahedron_stream.h"
#include "client/verbs/scripted_verbs.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Return;

class ServerAnswersTest : public ScriptedVerbTest {
 protected:
  const std::string output_ = files_.File("out");
};

TEST_F(ServerAnswersTest, EveryErrorHasTheExitCodeOfItsKind) {
  using enum grpc::StatusCode;
  for (const auto& [code, exit_code] :
       {std::pair(CANCELLED, ExitCode::kCancelled), std::pair(UNKNOWN, ExitCode::kInternal),
        std::pair(INVALID_ARGUMENT, ExitCode::kBadInput),
        std::pair(DEADLINE_EXCEEDED, ExitCode::kUnavailable),
        std::pair(NOT_FOUND, ExitCode::kNotFound), std::pair(ALREADY_EXISTS, ExitCode::kRefused),
        std::pair(PERMISSION_DENIED, ExitCode::kRefused),
        std::pair(RESOURCE_EXHAUSTED, ExitCode::kLimit),
        std::pair(FAILED_PRECONDITION, ExitCode::kRefused), std::pair(ABORTED, ExitCode::kRefused),
        std::pair(OUT_OF_RANGE, ExitCode::kBadInput), std::pair(UNIMPLEMENTED, ExitCode::kRefused),
        std::pair(INTERNAL, ExitCode::kInternal), std::pair(DATA_LOSS, ExitCode::kBadInput),
        std::pair(UNAUTHENTICATED, ExitCode::kRefused)}) {
    EXPECT_CALL(server_.sequences, ListSequences).WillOnce(Return(grpc::Status(code, "because")));
    const Outcome outcome = Run({"sequences"});
    EXPECT_EQ(outcome.code, exit_code) << code;
    EXPECT_EQ(outcome.err, "pleat sequences: because\n");
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(ServerAnswersTest, ADamagedDownloadLeavesTheFileThatWasThere) {
  const std::string id(64, '5');
  ServeModel(id);
  ServeDownloads("not what the id says");
  ASSERT_THAT(WriteFile(output_, "precious"), IsOk());
  const Outcome outcome = Run({"models", "download", id, "--force", "-o", output_});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(id), HasSubstr("download it again")));
  EXPECT_EQ(ReadFile(output_).value(), "precious");
}

TEST_F(ServerAnswersTest, ADownloadOfAMomentIsWrittenWithoutAWord) {
  const std::string bytes = "the bytes of a model", id = ToHex(ComputeSha256(bytes));
  ServeModel(id);
  ServeDownloads(bytes);
  const Outcome outcome = Run({"models", "download", id.substr(0, 9), "-o", output_});
  EXPECT_EQ(outcome.code, ExitCode::kOk);
  EXPECT_EQ(outcome.out + outcome.err, "");
  EXPECT_EQ(ReadFile(output_).value(), bytes);
}

TEST_F(ServerAnswersTest, AJobThatFailsIsToldWithItsReasonAndNoFileIsWritten) {
  TakeUploads();
  JobInfo failed = Job("j1", JobState::kFailed);
  failed.error = absl::ResourceExhaustedError("the disk is full");
  ServeJobs({failed});
  EXPECT_CALL(server_.jobs, CreateCompressionJob).WillOnce([](auto*, auto*, auto* response) {
    *response->mutable_job() = ToProto(Job("j1"));
    return grpc::Status::OK;
  });
  const std::string reason = "job j1 failed: the disk is full\n";
  const Outcome compressed =
      Run({"compress", files_.sequence_path(), "-o", output_, "--kg", "1", "-q"});
  EXPECT_EQ(compressed.code, ExitCode::kLimit);
  EXPECT_EQ(compressed.err, "pleat compress: " + reason);
  EXPECT_FALSE(std::filesystem::exists(output_));
  const Outcome watched = Run({"jobs", "watch", "j", "-q"});
  EXPECT_EQ(watched.code, ExitCode::kLimit);
  EXPECT_EQ(watched.err, "pleat jobs: " + reason);
}

TEST_F(ServerAnswersTest, ACompressionWithoutAReportIsAFaultOfTheService) {
  const std::string bytes = "the bytes of a .plt";
  CompressedSequenceInfo info;
  info.id = ToHex(ComputeSha256(bytes));
  info.num_frames = info.num_vertices = 2;
  TakeUploads();
  ServeDownloads(bytes);
  JobInfo done = Job("j1", JobState::kSucceeded);
  done.result_id = info.id;
  ServeJobs({done});
  EXPECT_CALL(server_.jobs, CreateCompressionJob).WillOnce([done](auto*, auto*, auto* response) {
    *response->mutable_job() = ToProto(done);
    return grpc::Status::OK;
  });
  EXPECT_CALL(server_.compressed, GetCompressedSequence)
      .WillOnce([info](auto*, auto*, auto* response) {
        *response->mutable_compressed_sequence() = ToProto(info);
        return grpc::Status::OK;
      });
  const Outcome outcome = Run({"compress", files_.sequence_path(), "-o", output_, "--kg", "1"});
  EXPECT_EQ(outcome.code, ExitCode::kInternal);
  EXPECT_THAT(outcome.err, HasSubstr("the service kept no report"));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(ServerAnswersTest, AModelThatIsNoneIsNotWritten) {
  TakeUploads();
  const std::string bytes = "no model";
  ServeDownloads(bytes);
  JobInfo done = Job("j1", JobState::kSucceeded);
  done.result_id = ToHex(ComputeSha256(bytes));
  ServeJobs({done});
  EXPECT_CALL(server_.jobs, CreateTrainingJob).WillOnce([done](auto*, auto*, auto* response) {
    *response->mutable_job() = ToProto(done);
    return grpc::Status::OK;
  });
  const Outcome outcome = Run({"train", files_.sequence_path(), "-o", output_, "-q"});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(ServerAnswersTest, AClipThatBreaksOffLeavesNoStreamThatLooksComplete) {
  const std::string id(64, '5');
  ServeModel(id);
  std::filesystem::create_directory(output_);
  ASSERT_THAT(WriteFile(output_ + "/stream.json", "of an earlier animation"), IsOk());
  TetrahedronStream stream({.encoding = FrameEncoding::kDracoMesh});
  EXPECT_CALL(server_.poses, EvaluateClip).WillOnce([&stream](auto*, auto*, auto* out) {
    v1::EvaluateClipResponse header, frame;
    *header.mutable_header() = stream.header();
    *frame.mutable_frame() = stream.Frame(0);
    out->Write(header);
    out->Write(frame);
    return Refusal();
  });
  const Outcome outcome =
      Run({"pose", id, "--motion", files_.motion_path(), "--force", "-o", output_});
  EXPECT_EQ(outcome.code, ExitCode::kRefused);
  EXPECT_TRUE(std::filesystem::exists(output_ + "/frame_0000.drc"));
  EXPECT_FALSE(std::filesystem::exists(output_ + "/stream.json"));
}

// bench trusts the numbers of the frames no more than anything else.
TEST_F(ServerAnswersTest, BenchRefusesFramesOfPosesThatItHasNotSent) {
  const std::string id(64, '5');
  ServeModel(id);
  std::atomic<int> num_sessions = 0;
  EXPECT_CALL(server_.poses, LiveSession).WillRepeatedly([&](auto*, LiveStream* live) {
    const uint64_t shift = num_sessions++ == 0 ? 0 : 1'000'000;  // the first one measures Draco
    TetrahedronStream frames({.encoding = FrameEncoding::kDracoPointCloud});
    v1::LiveSessionRequest request;
    live->Read(&request);
    v1::LiveSessionResponse response;
    *response.mutable_header() = frames.header();
    live->Write(response);
    while (live->Read(&request)) {
      if (!request.has_pose()) continue;
      *response.mutable_frame() = frames.Frame(request.pose().number());
      response.mutable_frame()->set_number(request.pose().number() + shift);
      live->Write(response);
    }
    return grpc::Status::OK;
  });
  for (const std::vector<std::string>& arrivals :
       {std::vector<std::string>{"--rate", "50"}, {"--closed-loop"}}) {
    num_sessions = 0;
    std::vector<std::string> arguments = {"bench",      id,       "--seconds",       "0.3", "-q",
                                          "--encoding", "points", "--max-in-flight", "1"};
    arguments.insert(arguments.end(), arrivals.begin(), arrivals.end());
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.code, ExitCode::kBadInput) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a pose that was not sent"));
  }
}

TEST_F(ServerAnswersTest, ListsOfTheServerAreTablesAndJson) {
  JobInfo job = Job("j1", JobState::kRunning);
  job.stage = "learn";
  job.fraction = .4567;
  job.eta_seconds = 95;
  job.name = "dancer";
  job.options = CompressOptions();
  ServeJobs({job});
  const Outcome table = Run({"jobs"});
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("running"), HasSubstr("learn"), HasSubstr("46 %"),
                    HasSubstr("1 min 35 s"), HasSubstr("compression"), HasSubstr("dancer")));
  const auto json = nlohmann::json::parse(Run({"jobs", "--json"}).out);
  EXPECT_EQ(json[0]["fraction"], .4567);
  EXPECT_EQ(json[0]["eta_seconds"], 95);
  EXPECT_FALSE(json[0].contains("error"));
  EXPECT_THAT(Run({"jobs", "--quiet"}).out, Not(testing::IsEmpty()));  // it is the result
}

}  // namespace
}  // namespace pleat
