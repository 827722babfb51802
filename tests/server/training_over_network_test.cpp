// The real training through the real server: the same model bytes as in this process, and frames
// that decode to the evaluator's positions.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "pleat/base/sha256.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/performer/performer.h"
#include "pleat/remote/remote_character_service.h"
#include "server/watch_to_end.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

class TrainingOverNetworkTest : public testing::Test {
 protected:
  void SetUp() override {
    PLEAT_ASSERT_OK_AND_ASSIGN(service_, LocalCharacterService::Open({.data_dir = folder_.path()}));
    PLEAT_ASSERT_OK_AND_ASSIGN(server_, GrpcServer::Start(service_.get(), {}));
    PLEAT_ASSERT_OK_AND_ASSIGN(
        client_, RemoteCharacterService::Connect("127.0.0.1:" + std::to_string(server_->port())));
    options_.learner = LearnerChoice::kGp;
  }

  // Generates a performer and uploads it.
  void Perform(int num_frames, int num_vertices) {
    PLEAT_ASSERT_OK_AND_ASSIGN(performer_, GeneratePerformer({.num_frames = num_frames,
                                                              .num_vertices = num_vertices,
                                                              .frame_rate = {30, 1}}));
    // The server trains what it read from the file, so that is the input here too.
    PLEAT_ASSERT_OK_AND_ASSIGN(sequence_, DecodeSequence(EncodeSequence(performer_->sequence)));
    PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo uploaded,
                               client_->sequences().Upload(performer_->sequence, {}));
    sequence_id_ = uploaded.id;
  }

  // Trains on the server, with `rig` unless it is empty.
  void Train(const std::string& rig, JobInfo* job, std::string* model_bytes) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const JobInfo created,
        client_->jobs().CreateTraining(
            {.sequence_ids = {sequence_id_}, .options = options_, .rig = rig}));
    *job = WatchToEnd(client_->jobs(), created.id);
    ASSERT_EQ(job->state, JobState::kSucceeded) << job->error;
    PLEAT_ASSERT_OK_AND_ASSIGN(*model_bytes, client_->models().Download(job->result_id, {}));
  }

  TemporaryFolder folder_;
  std::unique_ptr<LocalCharacterService> service_;
  std::unique_ptr<GrpcServer> server_;
  std::unique_ptr<RemoteCharacterService> client_;
  TrainOptions options_;
  std::optional<Performer> performer_;  // from Perform
  std::optional<MeshSequence> sequence_;
  std::string sequence_id_;
};

TEST_F(TrainingOverNetworkTest, GivesTheBytesAndFramesOfALocalRun) {
  ASSERT_NO_FATAL_FAILURE(Perform(40, 1200));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::shared_ptr<const CharacterModel> model,
                             TrainCharacter({*sequence_}, options_, {.num_threads = 1}));
  JobInfo job;
  std::string bytes;
  ASSERT_NO_FATAL_FAILURE(Train("", &job, &bytes));
  EXPECT_TRUE(bytes == EncodeModel(*model)) << "the model bytes differ";

  ClipQuery query{.model_id = job.result_id,
                  .track = performer_->truth.track.Subset({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}),
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
        StreamClip(client_->poses(), query, {.encoding = encoding},
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
TEST_F(TrainingOverNetworkTest, AnOwnRigGivesTheBytesOfALocalRun) {
  ASSERT_NO_FATAL_FAILURE(Perform(8, 600));
  const UserRig full{performer_->truth.rig.skeleton, performer_->truth.rig.weights, 0, {5, 9}};
  UserRig skeleton_only = full;
  skeleton_only.weights.reset();
  std::string of_joints = EncodeRig(full);
  of_joints.replace(of_joints.find("\"bones\""), 7, "\"joints\"");
  for (const std::string& text : {EncodeRig(full), EncodeRig(skeleton_only), of_joints}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigJson(text));
    PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, *sequence_));
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::shared_ptr<const CharacterModel> model,
                               TrainCharacterWithRig({*sequence_}, rig, options_));
    JobInfo job;
    std::string bytes;
    ASSERT_NO_FATAL_FAILURE(Train(text, &job, &bytes));
    EXPECT_EQ(job.rig_id, ToHex(ComputeSha256(text)));
    EXPECT_TRUE(bytes == EncodeModel(*model)) << "the model bytes differ";
  }
}

}  // namespace
}  // namespace pleat
