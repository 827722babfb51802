// What verbs ask a server for: every flag arrives where it belongs. The server then refuses, which
// the verb must pass on and after which it must not write anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/verbs/scripted_verbs.h"
#include "pleat/base/file.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ServerRequestsTest : public ScriptedVerbTest {
 protected:
  // Keeps the request of a call that is then refused.
  template <typename Request>
  static auto Keep(Request* kept) {
    return [kept](grpc::ServerContext*, const Request* request, auto*) {
      *kept = *request;
      return Refusal();
    };
  }
  void ExpectRefused(const Outcome& outcome, const std::string& verb) const {
    EXPECT_EQ(outcome.code, ExitCode::kRefused) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("pleat " + verb + ": not today\n"));
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(output_)) << verb;
  }

  const std::string output_ = files_.File("out");
  const std::string id_ = std::string(63, 'a') + "7";
};

TEST_F(ServerRequestsTest, TrainingSendsClipsOptionsAndTheRigWithItsLocks) {
  TakeUploads();
  v1::CreateTrainingJobRequest request;
  EXPECT_CALL(server_.jobs, CreateTrainingJob).Times(2).WillRepeatedly(Keep(&request));
  const std::string input = files_.sequence_path();
  ExpectRefused(Run({"train", input, input, "-o", output_, "--preset", "paper", "--learner", "gp",
                     "--seed", "5", "--rig", files_.rig_path(), "--lock", "chest,head"}),
                "train");
  ASSERT_EQ(request.sequence_ids_size(), 2);
  EXPECT_EQ(request.sequence_ids(0), request.sequence_ids(1));
  EXPECT_EQ(request.options().learner(), "gp");
  EXPECT_EQ(request.options().seed(), 5u);
  EXPECT_EQ(request.options().detail_axes(), "world");  // of the preset
  EXPECT_EQ(request.model_name(), "");
  const auto rig = nlohmann::json::parse(request.rig());
  ASSERT_EQ(rig["joints"].size(), 3u);
  for (const auto& joint : rig["joints"]) {
    EXPECT_EQ(joint.value("locked", false), joint["name"] != "hips");
  }
  ExpectRefused(Run({"train", input, "-o", output_, "--at", "head=0,1.7,0", "hips=0,.9,.05"}),
                "train");
  EXPECT_EQ(request.rig(), "");
  EXPECT_EQ(request.options().placed_joints(), "head=0,1.7,0 hips=0,0.9,0.05");
}

TEST_F(ServerRequestsTest, ADetachedTrainingPrintsItsJobAndWaitsForNothing) {
  TakeUploads();
  EXPECT_CALL(server_.jobs, CreateTrainingJob)
      .Times(2)
      .WillRepeatedly([](auto*, auto*, auto* response) {
        *response->mutable_job() = ToProto(Job("j1"));
        return grpc::Status::OK;
      });
  EXPECT_CALL(server_.jobs, WatchJob).Times(0);
  EXPECT_EQ(Run({"train", files_.sequence_path(), "--detach", "-q"}).out, "j1\n");
  const Outcome json = Run({"train", files_.sequence_path(), "--detach", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["id"], "j1");
  EXPECT_EQ(json.err, "");
}

TEST_F(ServerRequestsTest, CompressionSendsTheGoalThatWasSaid) {
  TakeUploads();
  v1::CreateCompressionJobRequest request;
  EXPECT_CALL(server_.jobs, CreateCompressionJob).WillRepeatedly(Keep(&request));
  const auto compress = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"compress", files_.sequence_path(), "-o", output_});
    ExpectRefused(Run(flags), "compress");
    EXPECT_EQ(request.sequence_id().size(), 64u);
    return request.options();
  };
  EXPECT_EQ(compress({"--max-error-mm", "0.25"}).max_error_mm(), .25);
  EXPECT_EQ(compress({"--kg", "1.5"}).kg_percent(), 1.5);
  EXPECT_FALSE(request.options().any_face_order());
  EXPECT_EQ(compress({"--lossless-at-bits", "12", "--any-face-order"}).lossless_at_bits(), 12);
  EXPECT_TRUE(request.options().any_face_order());
}

TEST_F(ServerRequestsTest, DecompressionAsksForTheRangeOfTheOnlyIdThatFits) {
  CompressedSequenceInfo info;
  info.id = id_;
  info.num_frames = info.num_vertices = 9;
  EXPECT_CALL(server_.compressed, ListCompressedSequences)
      .WillRepeatedly([info](auto*, auto*, auto* response) {
        *response->add_compressed_sequences() = ToProto(info);
        return grpc::Status::OK;
      });
  EXPECT_CALL(server_.compressed, GetCompressedSequence)
      .WillRepeatedly([info](auto*, auto*, auto* response) {
        *response->mutable_compressed_sequence() = ToProto(info);
        return grpc::Status::OK;
      });
  v1::DecodeFramesRequest request;
  EXPECT_CALL(server_.compressed, DecodeFrames).WillRepeatedly(Keep(&request));
  for (const auto& [text, begin, end] :
       {std::tuple("2:5", 2, 5), std::tuple(":4", 0, 4), std::tuple("3:", 3, 0)}) {
    ExpectRefused(Run({"decompress", "aaa", "-o", output_, "--frames", text}), "decompress");
    EXPECT_EQ(request.id(), id_);
    EXPECT_EQ(request.begin_frame(), begin) << text;
    EXPECT_EQ(request.end_frame(), end) << text;
  }
  EXPECT_EQ(Run({"decompress", "b", "-o", output_}).code, ExitCode::kNotFound);
}

TEST_F(ServerRequestsTest, PosesSendTheMotionTheBonesAndTheStream) {
  ServeModel(id_);
  v1::EvaluateClipRequest request;
  EXPECT_CALL(server_.poses, EvaluateClip).WillRepeatedly(Keep(&request));
  ExpectRefused(
      Run({"pose", "aa", "--motion", files_.motion_path(), "-o", output_, "--encoding", "points",
           "--bits", "10", "--content", "control", "--bone-scale", "head=2", "--skinned-only"}),
      "pose");
  EXPECT_EQ(request.character().model_id(), id_);
  EXPECT_THAT(request.character().bone_scales(), ElementsAre(1, 1, 2));
  EXPECT_TRUE(request.character().skinned_only());
  EXPECT_EQ(request.track().poses_size(), TubeFiles::kNumMotionFrames);
  EXPECT_EQ(request.track().fps(), 25);
  EXPECT_EQ(request.options().encoding(), v1::FRAME_ENCODING_DRACO_POINT_CLOUD);
  EXPECT_EQ(request.options().position_bits(), 10);
  EXPECT_EQ(request.options().content(), v1::STREAM_CONTENT_CONTROL_MESH);
  ExpectRefused(Run({"pose", "aa", "--motion", files_.motion_path(), "-o", output_}), "pose");
  EXPECT_EQ(request.options().encoding(), v1::FRAME_ENCODING_DRACO_MESH);
  EXPECT_EQ(request.character().bone_scales_size(), 0);
  EXPECT_FALSE(request.character().skinned_only());
}

TEST_F(ServerRequestsTest, PosesAsParametersNeedTheModelHere) {
  const std::string bytes = ReadFile(files_.model_path()).value();
  const std::string id = ToHex(ComputeSha256(bytes));
  ServeModel(id);
  ServeDownloads(bytes);
  v1::EvaluateClipRequest request;
  EXPECT_CALL(server_.poses, EvaluateClip).WillOnce(Keep(&request));
  ExpectRefused(Run({"pose", id, "--motion", files_.motion_path(), "-o", output_, "--format", "obj",
                     "--content", "parameters"}),
                "pose");
  EXPECT_EQ(request.options().content(), v1::STREAM_CONTENT_PARAMETERS);
}

TEST_F(ServerRequestsTest, ContentsThatAFormatCannotHoldAreRefusedBeforeTheCall) {
  ServeModel(id_);
  EXPECT_CALL(server_.poses, EvaluateClip).Times(0);
  for (const auto& [content, format, hint] :
       {std::tuple("control", "pseq", "write it with --format drc"),
        std::tuple("control", "obj", "write it with --format drc"),
        std::tuple("parameters", "drc", "choose pc2, abc, pseq, obj or ply")}) {
    const Outcome outcome = Run({"pose", id_, "--motion", files_.motion_path(), "-o", output_,
                                 "--format", format, "--content", content});
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << content << format;
    EXPECT_THAT(outcome.err, HasSubstr(hint));
  }
}

TEST_F(ServerRequestsTest, ActionsReachTheThingWhoseIdBeginsSo) {
  ServeJobs({Job("ab1"), Job("ab2"), Job("b3", JobState::kRunning)});
  v1::CancelJobRequest cancel;
  EXPECT_CALL(server_.jobs, CancelJob).WillOnce(Keep(&cancel));
  ExpectRefused(Run({"jobs", "cancel", "b"}), "jobs");
  EXPECT_EQ(cancel.id(), "b3");
  const Outcome several = Run({"jobs", "cancel", "ab"});
  EXPECT_EQ(several.code, ExitCode::kUsage);
  EXPECT_THAT(several.err, HasSubstr("give more digits"));
  ServeModel(id_);
  v1::DeleteModelRequest deletion;
  EXPECT_CALL(server_.models, DeleteModel).WillOnce(Keep(&deletion));
  ExpectRefused(Run({"models", "delete", "aaaa"}), "models");
  EXPECT_EQ(deletion.id(), id_);
}

}  // namespace
}  // namespace pleat
