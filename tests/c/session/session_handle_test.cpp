// Sessions of the C interface against a server whose answers are written down.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "c/c_character.h"
#include "client/remote/scripted_server.h"
#include "client/remote/tetrahedron_stream.h"
#include "pleat_session.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

using CSession = std::unique_ptr<pleat_session, Destroyer<pleat_session, pleat_session_destroy>>;

class SessionHandleTest : public ::testing::Test {
 protected:
  using Script = std::function<grpc::Status(LiveStream*)>;

  // The server answers one session: the header, then what `script` does.
  void Serve(v1::StreamHeader header, Script script) {
    EXPECT_CALL(server_.poses, LiveSession)
        .WillOnce([this, header, script](grpc::ServerContext*, LiveStream* stream) {
          v1::LiveSessionRequest request;
          stream->Read(&request);
          start_ = request.start();
          v1::LiveSessionResponse response;
          *response.mutable_header() = header;
          stream->Write(response);
          return script(stream);
        });
  }
  // Answers every pose with the frame of its number, until the client has no more.
  Script AnswerAll() {
    return [this](LiveStream* stream) {
      v1::LiveSessionRequest request;
      while (stream->Read(&request)) {
        poses_.push_back(request.pose());
        v1::LiveSessionResponse response;
        *response.mutable_frame() = frames_.Frame(request.pose().number());
        response.mutable_report()->set_evaluate_us(70);
        stream->Write(response);
      }
      return grpc::Status::OK;
    };
  }
  pleat_session_options Options() const {
    pleat_session_options options{};
    options.struct_size = sizeof(options);
    options.address = address_.c_str();
    options.model_id = "m";
    options.connect_seconds = 5;
    return options;
  }
  CSession Open(const pleat_session_options& options) {
    pleat_session* session = nullptr;
    EXPECT_EQ(pleat_session_open(&options, &session, &error_), PLEAT_OK) << error_.message;
    return CSession(session);
  }
  pleat_code SendAt(pleat_session* session, uint64_t number, double x, uint32_t flags = 0) {
    const CPose pose(PoseAt(x));
    return pleat_session_send(session, number, &pose.shown, flags, &error_);
  }

  ScriptedServer server_;
  const std::string address_ = server_.address();
  TetrahedronStream frames_;
  v1::LiveSessionRequest::Start start_;
  std::vector<v1::LiveSessionRequest::LivePose> poses_;
  pleat_error error_{};
};

TEST_F(SessionHandleTest, PosesGoOutAndFramesComeBackIntoTheCallersRows) {
  Serve(frames_.header(), AnswerAll());
  pleat_session_options options = Options();
  const std::vector<double> scales = {2};
  options.bone_scales = scales.data();
  options.num_bone_scales = 1;
  options.max_in_flight = 7;
  options.latest_wins = 1;
  const CSession session = Open(options);
  ASSERT_NE(session, nullptr);
  EXPECT_EQ(pleat_session_num_vertices(session.get()), 4u);
  ASSERT_EQ(SendAt(session.get(), 1, .5, PLEAT_SEND_RESTART | PLEAT_SEND_KEYFRAME), PLEAT_OK);
  std::vector<float> buffer(4 * 5, -3);
  pleat_frame frame{};
  frame.struct_size = sizeof(frame);
  frame.positions = {buffer.data(), 5 * sizeof(float), buffer.size() * sizeof(float)};
  ASSERT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_OK) << error_.message;
  EXPECT_EQ(frame.number, 1u);
  EXPECT_EQ(frame.confidence, .5);
  EXPECT_EQ(frame.evaluate_us, 70u);
  EXPECT_EQ(frame.resumed, 0u);
  for (int v = 0; v < 4; ++v) {
    const Eigen::Map<Eigen::Vector3f> position(buffer.data() + 5 * v);
    EXPECT_LT((position - frames_.positions(1).col(v)).cwiseAbs().maxCoeff(), frames_.step_m());
    EXPECT_EQ(buffer[5 * v + 3], -3);
  }
  pleat_session_send_done(session.get());
  EXPECT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_OUT_OF_RANGE);
  EXPECT_TRUE(pleat_session_ended(session.get()));
  EXPECT_EQ(start_.character().model_id(), "m");
  EXPECT_THAT(start_.character().bone_scales(), ::testing::ElementsAre(2));
  EXPECT_EQ(start_.max_in_flight(), 7);
  EXPECT_TRUE(start_.latest_wins());
  ASSERT_EQ(poses_.size(), 1u);
  EXPECT_TRUE(poses_[0].restart());
  EXPECT_TRUE(poses_[0].keyframe());
  EXPECT_EQ(poses_[0].pose().root_position().x(), .5);
}

TEST_F(SessionHandleTest, APoseMayBringItsHistory) {
  Serve(frames_.header(), AnswerAll());
  const CSession session = Open(Options());
  ASSERT_NE(session, nullptr);
  const CPose now(PoseAt(.5)), before(PoseAt(.25));
  const std::vector<pleat_pose> poses = {now.shown, before.shown};
  ASSERT_EQ(pleat_session_send_poses(session.get(), 1, poses.data(), 2, 0, &error_), PLEAT_OK)
      << error_.message;
  pleat_frame frame{};
  frame.struct_size = sizeof(frame);
  ASSERT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_OK) << error_.message;
  ASSERT_EQ(poses_.size(), 1u);
  EXPECT_EQ(poses_[0].pose().root_position().x(), .5);
  ASSERT_EQ(poses_[0].history_size(), 1);
  EXPECT_EQ(poses_[0].history(0).root_position().x(), .25);
  EXPECT_EQ(pleat_session_send_poses(session.get(), 2, poses.data(), 0, 0, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_send_poses(session.get(), 2, poses.data(), 9, 0, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("at most 7"));
  EXPECT_EQ(pleat_session_send_poses(session.get(), 2, nullptr, 1, 0, &error_),
            PLEAT_INVALID_ARGUMENT);
}

TEST_F(SessionHandleTest, ARejectionConcernsOnePose) {
  Serve(frames_.header(), [this](LiveStream* stream) {
    v1::LiveSessionRequest request;
    stream->Read(&request);
    v1::LiveSessionResponse response;
    response.mutable_rejection()->set_number(request.pose().number());
    response.mutable_rejection()->set_code(PLEAT_INVALID_ARGUMENT);
    response.mutable_rejection()->set_message("a joint is missing");
    stream->Write(response);
    return AnswerAll()(stream);
  });
  const CSession session = Open(Options());
  ASSERT_NE(session, nullptr);
  ASSERT_EQ(SendAt(session.get(), 8, 0), PLEAT_OK);
  pleat_frame frame{};
  frame.struct_size = sizeof(frame);
  EXPECT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("a joint is missing"));
  EXPECT_EQ(frame.number, 8u);
  EXPECT_FALSE(pleat_session_ended(session.get()));
  ASSERT_EQ(SendAt(session.get(), 9, 0), PLEAT_OK);
  EXPECT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_OK) << error_.message;
  EXPECT_EQ(frame.number, 9u);
}

// With parameters the model is downloaded and evaluated here, to the bits of our own evaluator.
class ParameterSessionTest : public CCharacterTest {};

TEST_F(ParameterSessionTest, ParametersBecomeTheMeshHere) {
  ScriptedServer server;
  const std::string id = ModelId(bytes_);  // which the download is checked against
  EXPECT_CALL(server.models, DownloadModel)
      .WillOnce([&](grpc::ServerContext*, const v1::DownloadModelRequest* request,
                    grpc::ServerWriter<v1::DownloadModelResponse>* out) {
        EXPECT_EQ(request->id(), id);
        v1::DownloadModelResponse response;
        response.set_size_bytes(bytes_.size());
        response.set_data(bytes_);
        out->Write(response);
        return grpc::Status::OK;
      });
  FrameParameters parameters;
  EvaluatedFrame expected;
  ASSERT_TRUE(truth_.Predict(History(9, 3), false, &parameters).ok());
  ASSERT_TRUE(truth_.Show(parameters, {}, &expected).ok());
  EXPECT_CALL(server.poses, LiveSession).WillOnce([&](grpc::ServerContext*, LiveStream* stream) {
    v1::LiveSessionRequest request;
    stream->Read(&request);
    EXPECT_EQ(request.start().options().content(), v1::STREAM_CONTENT_PARAMETERS);
    v1::LiveSessionResponse response;
    response.mutable_header()->set_num_vertices(num_vertices());
    response.mutable_header()->set_content(v1::STREAM_CONTENT_PARAMETERS);
    response.mutable_header()->mutable_box()->set_range(1);
    response.mutable_header()->mutable_box()->set_bits(14);
    stream->Write(response);
    stream->Read(&request);
    response.Clear();
    response.mutable_frame()->set_number(request.pose().number());
    response.mutable_frame()->set_confidence(parameters.confidence);
    *response.mutable_frame()->mutable_parameters() = ToProto(parameters);
    stream->Write(response);
    stream->Read(&request);
    return grpc::Status::OK;
  });
  const std::string address = server.address();
  pleat_session_options options{};
  options.struct_size = sizeof(options);
  options.address = address.c_str();
  options.model_id = id.c_str();
  options.content = PLEAT_CONTENT_PARAMETERS;
  pleat_session* opened = nullptr;
  ASSERT_EQ(pleat_session_open(&options, &opened, &error_), PLEAT_OK) << error_.message;
  const CSession session(opened);
  EXPECT_EQ(pleat_session_num_vertices(opened), static_cast<uint32_t>(num_vertices()));
  ASSERT_EQ(pleat_session_send(opened, 5, &c_poses_[9].shown, 0, &error_), PLEAT_OK);
  Eigen::Matrix3Xf positions;
  pleat_frame frame{};
  frame.struct_size = sizeof(frame);
  frame.positions = RowsOfFrame(&positions);
  ASSERT_EQ(pleat_session_receive(opened, &frame, &error_), PLEAT_OK) << error_.message;
  EXPECT_EQ(positions, expected.positions);
  pleat_session_send_done(opened);
}

TEST_F(SessionHandleTest, AServerThatIsNoneOfOursIsRefusedWithWords) {
  pleat_session* session = nullptr;
  const pleat_session_options options = Options();
  EXPECT_EQ(pleat_session_open(&options, &session, &error_), PLEAT_UNIMPLEMENTED);
  EXPECT_THAT(error_.message, HasSubstr("no Pleat server, or one of another version"));
  EXPECT_EQ(session, nullptr);
}

TEST_F(SessionHandleTest, NobodyThereAndBadOptionsAreErrors) {
  pleat_session* session = nullptr;
  const auto refused = [&](const pleat_session_options& bad, pleat_code code, const char* word) {
    EXPECT_EQ(pleat_session_open(&bad, &session, &error_), code) << error_.message;
    EXPECT_THAT(error_.message, HasSubstr(word));
    EXPECT_EQ(session, nullptr);
  };
  pleat_session_options options = Options();
  options.address = "127.0.0.1:1";
  options.connect_seconds = .2;
  refused(options, PLEAT_UNAVAILABLE, "127.0.0.1:1");
  options = Options();
  options.struct_size = 16;
  refused(options, PLEAT_INVALID_ARGUMENT, "struct_size");
  options = Options();
  options.address = nullptr;
  refused(options, PLEAT_INVALID_ARGUMENT, "address is NULL");
  options = Options();
  options.model_id = nullptr;
  refused(options, PLEAT_INVALID_ARGUMENT, "model_id is NULL");
  options = Options();
  options.content = 9;
  refused(options, PLEAT_INVALID_ARGUMENT, "content 9");
  options = Options();
  options.token = "no token";
  refused(options, PLEAT_INVALID_ARGUMENT, "token");
  EXPECT_EQ(pleat_session_open(nullptr, &session, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_open(&options, nullptr, &error_), PLEAT_INVALID_ARGUMENT);
}

TEST_F(SessionHandleTest, MistakesInASessionAreErrors) {
  Serve(frames_.header(), AnswerAll());
  const CSession session = Open(Options());
  ASSERT_NE(session, nullptr);
  EXPECT_EQ(SendAt(session.get(), 1, 0, /*flags=*/8), PLEAT_INVALID_ARGUMENT);
  CPose pose(PoseAt(0));
  pose.shown.num_joints = std::numeric_limits<size_t>::max();
  EXPECT_EQ(pleat_session_send(session.get(), 1, &pose.shown, 0, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_send(session.get(), 1, nullptr, 0, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_send(nullptr, 1, &pose.shown, 0, &error_), PLEAT_INVALID_ARGUMENT);
  pleat_frame frame{};
  EXPECT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_receive(nullptr, &frame, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_session_receive(session.get(), nullptr, &error_), PLEAT_INVALID_ARGUMENT);
  std::vector<float> few(11);
  frame.struct_size = sizeof(frame);
  frame.positions = {few.data(), 0, few.size() * sizeof(float)};
  EXPECT_EQ(pleat_session_receive(session.get(), &frame, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("44 bytes for 4 vertices"));
  EXPECT_EQ(pleat_session_num_vertices(nullptr), 0u);
  EXPECT_TRUE(pleat_session_ended(nullptr));
  pleat_session_send_done(nullptr);
  pleat_session_destroy(nullptr);
}

}  // namespace
}  // namespace pleat
