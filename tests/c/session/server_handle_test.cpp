// Calls of the C interface on a server whose answers are written down.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "c/c_character.h"
#include "client/remote/scripted_server.h"
#include "pleat/formats/sequence_file.h"
#include "pleat_server.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using CServer = std::unique_ptr<pleat_server, Destroyer<pleat_server, pleat_server_destroy>>;
using CClip = std::unique_ptr<pleat_take, Destroyer<pleat_take, pleat_take_destroy>>;

class ServerHandleTest : public ::testing::Test {
 protected:
  pleat_server_options Options() const {
    pleat_server_options options{};
    options.struct_size = sizeof(options);
    options.address = address_.c_str();
    options.connect_seconds = 5;
    return options;
  }
  // Connects to a server that has one model.
  CServer Connect() {
    ON_CALL(server_.models, ListModels)
        .WillByDefault(
            [](grpc::ServerContext*, const v1::ListModelsRequest*, v1::ListModelsResponse* out) {
              v1::Model* model = out->add_models();
              model->set_id(std::string(64, 'a'));
              model->set_name("dancer");
              model->set_num_vertices(12);
              model->mutable_frame_rate()->set_numerator(25);
              model->mutable_frame_rate()->set_denominator(1);
              model->mutable_record()->set_learner("regional");
              v1::Joint* joint = model->mutable_skeleton()->add_joints();
              joint->set_name("hips");
              joint->set_parent(-1);
              joint->mutable_rest_position();
              return grpc::Status::OK;
            });
    const pleat_server_options options = Options();
    pleat_server* server = nullptr;
    EXPECT_EQ(pleat_server_connect(&options, &server, &error_), PLEAT_OK) << error_.message;
    return CServer(server);
  }
  // The job of a call, as it is after some time.
  static void FillJob(v1::JobState state, double fraction, v1::Job* job) {
    job->set_id("job-1");
    job->set_state(state);
    job->add_sequence_ids(std::string(64, 'b'));
    job->mutable_training();
    job->set_stage("fit");
    job->set_fraction(fraction);
    if (state == v1::JOB_STATE_SUCCEEDED) job->set_result_id(std::string(64, 'c'));
    if (state == v1::JOB_STATE_FAILED) {
      job->mutable_error()->set_code(PLEAT_FAILED_PRECONDITION);
      job->mutable_error()->set_message("frame 7 jumps");
    }
  }
  void ServeJob(std::vector<std::pair<v1::JobState, double>> states) {
    ON_CALL(server_.jobs, WatchJob)
        .WillByDefault([states](grpc::ServerContext*, const v1::WatchJobRequest*,
                                grpc::ServerWriter<v1::WatchJobResponse>* out) {
          for (const auto& [state, fraction] : states) {
            v1::WatchJobResponse response;
            FillJob(state, fraction, response.mutable_job());
            out->Write(response);
          }
          return grpc::Status::OK;
        });
  }

  ScriptedServer server_;
  const std::string address_ = server_.address();
  pleat_error error_{};
};

TEST_F(ServerHandleTest, AServerThatIsNoneOfOursIsRefusedWithWords) {
  const pleat_server_options options = Options();
  pleat_server* server = nullptr;
  EXPECT_EQ(pleat_server_connect(&options, &server, &error_), PLEAT_UNIMPLEMENTED);
  EXPECT_THAT(error_.message, HasSubstr("no Pleat server, or one of another version"));
  EXPECT_EQ(server, nullptr);
}

TEST_F(ServerHandleTest, NobodyThereAndBadArgumentsAreErrors) {
  pleat_server_options options = Options();
  pleat_server* server = nullptr;
  options.address = "127.0.0.1:1";
  options.connect_seconds = .2;
  EXPECT_EQ(pleat_server_connect(&options, &server, &error_), PLEAT_UNAVAILABLE);
  options.address = nullptr;
  EXPECT_EQ(pleat_server_connect(&options, &server, &error_), PLEAT_INVALID_ARGUMENT);
  options.struct_size = 8;
  EXPECT_EQ(pleat_server_connect(&options, &server, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_connect(nullptr, &server, &error_), PLEAT_INVALID_ARGUMENT);
  char id[PLEAT_ID_SIZE];
  const pleat_training training{};
  EXPECT_EQ(pleat_server_train(nullptr, &training, id, &error_), PLEAT_INVALID_ARGUMENT);
  const CServer there = Connect();
  EXPECT_EQ(pleat_server_train(there.get(), &training, id, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_train(there.get(), nullptr, id, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_upload(there.get(), nullptr, nullptr, nullptr, id, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_watch(there.get(), nullptr, nullptr, nullptr, nullptr, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_list_models(there.get(), nullptr, nullptr, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_server_download(there.get(), "m", nullptr, nullptr, nullptr, &error_),
            PLEAT_INVALID_ARGUMENT);
  pleat_server_destroy(nullptr);
}

TEST_F(ServerHandleTest, ModelsAreListed) {
  const CServer there = Connect();
  std::vector<std::string> seen;
  const auto visit = [](void* user, const pleat_model_entry* model) {
    static_cast<std::vector<std::string>*>(user)->assign(
        {model->id, model->name, model->learner, std::to_string(model->num_vertices)});
    return 0;
  };
  ASSERT_EQ(pleat_server_list_models(there.get(), visit, &seen, &error_), PLEAT_OK)
      << error_.message;
  EXPECT_THAT(seen, ElementsAre(std::string(64, 'a'), "dancer", "regional", "12"));
}

TEST_F(ServerHandleTest, ATrainingIsAskedForAndWatchedToItsEnd) {
  const CServer there = Connect();
  v1::CreateTrainingJobRequest asked;
  EXPECT_CALL(server_.jobs, CreateTrainingJob)
      .WillOnce([&](grpc::ServerContext*, const v1::CreateTrainingJobRequest* request,
                    v1::CreateTrainingJobResponse* out) {
        asked = *request;
        FillJob(v1::JOB_STATE_QUEUED, 0, out->mutable_job());
        return grpc::Status::OK;
      });
  const std::string sequence(64, 'b');
  const char* ids[] = {sequence.c_str()};
  pleat_training training{};
  training.struct_size = sizeof(training);
  training.sequence_ids = ids;
  training.num_sequences = 1;
  training.name = "mine";
  training.options = "learner=gp\nseed=7";
  char id[PLEAT_ID_SIZE];
  ASSERT_EQ(pleat_server_train(there.get(), &training, id, &error_), PLEAT_OK) << error_.message;
  EXPECT_EQ(std::string(id), "job-1");
  EXPECT_THAT(asked.sequence_ids(), ElementsAre(sequence));
  EXPECT_EQ(asked.model_name(), "mine");
  EXPECT_EQ(asked.options().learner(), "gp");
  EXPECT_EQ(asked.options().seed(), 7u);

  training.options = "learner=magic";
  EXPECT_EQ(pleat_server_train(there.get(), &training, id, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("magic"));

  ServeJob({{v1::JOB_STATE_RUNNING, .5}, {v1::JOB_STATE_SUCCEEDED, 1}});
  double most = 0;
  const auto observe = [](void* user, const pleat_job* job) {
    *static_cast<double*>(user) = job->fraction;
    return 0;
  };
  pleat_job last{};
  last.struct_size = sizeof(last);
  ASSERT_EQ(pleat_server_watch(there.get(), id, observe, &most, &last, &error_), PLEAT_OK)
      << error_.message;
  EXPECT_EQ(most, 1);
  EXPECT_EQ(last.state, uint32_t{PLEAT_JOB_SUCCEEDED});
  EXPECT_EQ(std::string(last.result_id), std::string(64, 'c'));
  EXPECT_EQ(std::string(last.stage), "fit");
}

TEST_F(ServerHandleTest, AJobThatFailsIsAnErrorInItsOwnWords) {
  const CServer there = Connect();
  ServeJob({{v1::JOB_STATE_FAILED, .3}});
  EXPECT_EQ(pleat_server_watch(there.get(), "job-1", nullptr, nullptr, nullptr, &error_),
            PLEAT_FAILED_PRECONDITION);
  EXPECT_THAT(error_.message, HasSubstr("frame 7 jumps"));
}

TEST_F(ServerHandleTest, AnObserverMayStopWatching) {
  const CServer there = Connect();
  ServeJob({{v1::JOB_STATE_RUNNING, .3}});
  const auto stop = [](void*, const pleat_job*) { return 1; };
  EXPECT_EQ(pleat_server_watch(there.get(), "job-1", stop, nullptr, nullptr, &error_),
            PLEAT_CANCELLED);
}

TEST_F(ServerHandleTest, ATakeGoesUpWhole) {
  const CServer there = Connect();
  std::string arrived;
  ON_CALL(server_.sequences, QueryUpload)  // nothing has arrived
      .WillByDefault([](grpc::ServerContext*, const v1::QueryUploadRequest*,
                        v1::QueryUploadResponse*) { return grpc::Status::OK; });
  EXPECT_CALL(server_.sequences, UploadSequence)
      .WillOnce([&](grpc::ServerContext*, grpc::ServerReader<v1::UploadSequenceRequest>* in,
                    v1::UploadSequenceResponse* out) {
        v1::UploadSequenceRequest request;
        while (in->Read(&request)) {
          if (request.has_header()) out->mutable_sequence()->set_id(request.header().id());
          arrived += request.data();
        }
        out->mutable_sequence()->mutable_frame_rate()->set_numerator(1);
        out->mutable_sequence()->mutable_frame_rate()->set_denominator(1);
        return grpc::Status::OK;
      });
  const std::vector<uint32_t> sizes = {3}, corners = {0, 1, 2};
  pleat_take_mesh mesh{};
  mesh.struct_size = sizeof(mesh);
  mesh.num_vertices = 3;
  mesh.num_frames = 1;
  mesh.face_sizes = sizes.data();
  mesh.num_faces = 1;
  mesh.corners = corners.data();
  mesh.num_corners = 3;
  mesh.rate_numerator = mesh.rate_denominator = 1;
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  pleat_take* take = nullptr;
  ASSERT_EQ(pleat_take_create(&mesh, positions.data(), 9, &take, &error_), PLEAT_OK);
  const CClip owner(take);
  char id[PLEAT_ID_SIZE];
  double most = 0;
  const auto report = [](void* user, const char*, double fraction) {
    *static_cast<double*>(user) = fraction;
    return 0;
  };
  ASSERT_EQ(pleat_server_upload(there.get(), take, report, &most, id, &error_), PLEAT_OK)
      << error_.message;
  EXPECT_EQ(SequenceId(arrived), id);
  EXPECT_GT(most, 0);
}

}  // namespace
}  // namespace pleat
