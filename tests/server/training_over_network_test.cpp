// The real training through the real server: the same model bytes as in this process, and frames
// that decode to the evaluator's positions.
#include <gtest/gtest.h>

#include "pleat/base/sha256.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/performer/performer.h"
#include "pleat/remote/remote_character_service.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

TEST(TrainingOverNetworkTest, GivesTheBytesAndFramesOfALocalRun) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Performer performer,
      GeneratePerformer({.num_frames = 40, .num_vertices = 1200, .frame_rate = {30, 1}}));
  // The server trains what it read from the file, so that is the input here too.
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             DecodeSequence(EncodeSequence(performer.sequence)));
  TrainOptions options;
  options.learner = LearnerChoice::kGp;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::shared_ptr<const CharacterModel> model,
                             TrainCharacter({sequence}, options, {.num_threads = 1}));

  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto service,
                             LocalCharacterService::Open({.data_dir = folder.path()}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto server, GrpcServer::Start(service.get(), {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(
                                                    "127.0.0.1:" + std::to_string(server->port())));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo uploaded,
                             client->sequences().Upload(performer.sequence, {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const JobInfo created,
      client->jobs().CreateTraining({.sequence_ids = {uploaded.id}, .options = options}));
  JobInfo job;
  ASSERT_THAT(WatchJob(client->jobs(), created.id,
                       [&](const JobInfo& info) {
                         job = info;
                         return true;
                       }),
              IsOk());
  ASSERT_EQ(job.state, JobState::kSucceeded) << job.error;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, client->models().Download(job.result_id, {}));
  EXPECT_TRUE(bytes == EncodeModel(*model)) << "the model bytes differ";

  ClipQuery query{.model_id = job.result_id,
                  .track = performer.truth.track.Subset({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}),
                  .bone_scales = {}};
  std::vector<EvaluatedFrame> truth;
  ASSERT_THAT(PoseEvaluator(model).EvaluateClip(query.track, {},
                                                [&](int, const EvaluatedFrame& frame) {
                                                  truth.push_back(frame);
                                                  return absl::OkStatus();
                                                }),
              IsOk());
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    std::optional<FrameDecoder> decoder;
    double worst_steps = 0;
    ASSERT_THAT(
        StreamClip(client->poses(), query, {.encoding = encoding},
                   {.on_header =
                        [&](const StreamHeader& header) {
                          decoder.emplace(FrameDecoder::Create(header).value());
                          return absl::OkStatus();
                        },
                    .on_frame =
                        [&](int t, std::string_view draco, const FrameMark& mark, double) {
                          Eigen::Matrix3Xf positions;
                          const absl::Status status = decoder->Decode(draco, mark, &positions);
                          if (!status.ok()) return status;
                          worst_steps = std::max<double>(
                              worst_steps, (positions - truth[t].positions).cwiseAbs().maxCoeff() /
                                               decoder->header().box.step_m());
                          return absl::OkStatus();
                        }}),
        IsOk());
    EXPECT_LE(worst_steps, .505);
    EXPECT_GE(worst_steps, .4);  // the grid is really what the header says
  }
}

// A rig of the user's own: with weights, without them, and of the weights of joints, as another
// package writes them.
TEST(TrainingOverNetworkTest, AnOwnRigGivesTheBytesOfALocalRun) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Performer performer,
      GeneratePerformer({.num_frames = 8, .num_vertices = 600, .frame_rate = {30, 1}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             DecodeSequence(EncodeSequence(performer.sequence)));
  TrainOptions options;
  options.learner = LearnerChoice::kGp;
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto service,
                             LocalCharacterService::Open({.data_dir = folder.path()}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto server, GrpcServer::Start(service.get(), {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(
                                                    "127.0.0.1:" + std::to_string(server->port())));
  const std::string sequence_id = client->sequences().Upload(performer.sequence, {})->id;
  const UserRig full{performer.truth.rig.skeleton, performer.truth.rig.weights, 0, {5, 9}};
  UserRig skeleton_only = full;
  skeleton_only.weights.reset();
  std::string of_joints = EncodeRig(full);
  of_joints.replace(of_joints.find("\"bones\""), 7, "\"joints\"");
  for (const std::string& text : {EncodeRig(full), EncodeRig(skeleton_only), of_joints}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigJson(text));
    PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, sequence));
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::shared_ptr<const CharacterModel> model,
                               TrainCharacterWithRig({sequence}, rig, options));
    PLEAT_ASSERT_OK_AND_ASSIGN(
        JobInfo job, client->jobs().CreateTraining(
                         {.sequence_ids = {sequence_id}, .options = options, .rig = text}));
    EXPECT_EQ(job.rig_id, ToHex(ComputeSha256(text)));
    ASSERT_THAT(WatchJob(client->jobs(), job.id,
                         [&](const JobInfo& info) {
                           job = info;
                           return true;
                         }),
                IsOk());
    ASSERT_EQ(job.state, JobState::kSucceeded) << job.error;
    EXPECT_TRUE(*client->models().Download(job.result_id, {}) == EncodeModel(*model));
  }
}

}  // namespace
}  // namespace pleat
