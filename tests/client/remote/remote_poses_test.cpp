// Clips and single poses over a server that says what the test wants.
#include "pleat/remote/remote_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "client/remote/scripted_server.h"
#include "client/remote/tetrahedron_stream.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ClipResponse = v1::EvaluateClipResponse;

class RemotePosesTest : public testing::Test {
 protected:
  ClipResponse Header() const {
    ClipResponse response;
    *response.mutable_header() = stream_.header();
    return response;
  }
  ClipResponse Frame(uint64_t number) {
    ClipResponse response;
    *response.mutable_frame() = stream_.Frame(number);
    return response;
  }
  static ClipQuery Query() {
    PoseTrack::Parts track{.fps = 24};
    for (int t = 0; t < 2; ++t) track.poses.push_back(PoseAt(t));
    return {"m", PoseTrack::FromValid(std::move(track)), {2}, true};
  }
  // Two poses, to which the server answers with `parts`.
  absl::Status EvaluateClip(const std::vector<ClipResponse>& parts,
                            grpc::Status end = grpc::Status::OK) {
    EXPECT_CALL(server_.poses, EvaluateClip)
        .WillOnce([this, parts, end](grpc::ServerContext*, const v1::EvaluateClipRequest* request,
                                     grpc::ServerWriter<ClipResponse>* out) {
          request_ = *request;
          for (const ClipResponse& part : parts) out->Write(part);
          return end;
        });
    frames_.clear();
    return server_.Open()->poses().EvaluateClip(Query(), [this](int t, const EvaluatedFrame& f) {
      EXPECT_EQ(t, static_cast<int>(frames_.size()));
      EXPECT_EQ(f.confidence, .5);
      frames_.push_back(f.positions);
      return absl::OkStatus();
    });
  }

  TetrahedronStream stream_{{.position_bits = 16}};
  v1::EvaluateClipRequest request_;
  std::vector<Eigen::Matrix3Xf> frames_;
  ScriptedServer server_;
};

TEST_F(RemotePosesTest, AClipAsksForWhatWasAskedAndDecodesWhatComes) {
  ASSERT_THAT(EvaluateClip({Header(), Frame(0), Frame(1)}), IsOk());
  ASSERT_EQ(frames_.size(), 2u);
  for (int t = 0; t < 2; ++t) {
    EXPECT_LE((frames_[t] - stream_.positions(t)).cwiseAbs().maxCoeff(), stream_.step_m());
  }
  EXPECT_EQ(request_.character().model_id(), "m");
  EXPECT_THAT(request_.character().bone_scales(), ElementsAre(2));
  EXPECT_TRUE(request_.character().skinned_only());
  EXPECT_EQ(request_.track().fps(), 24);
  ASSERT_EQ(request_.track().poses_size(), 2);
  EXPECT_EQ(request_.track().poses(1).root_position().x(), 1);
  EXPECT_EQ(request_.options().position_bits(), 16);
}

TEST_F(RemotePosesTest, WhatIsNoStreamOfTheClipIsNamed) {
  struct Stream {
    std::string message;
    std::vector<ClipResponse> parts;
    size_t num_frames;  // that are seen before
  };
  ClipResponse damaged = Frame(1), bad_header = Header(), no_topology = Header();
  damaged.mutable_frame()->set_draco(damaged.frame().draco().substr(0, 20));
  for (const Stream& stream : std::vector<Stream>{
           {"it ended too early", {}, 0},
           {"the header is not first", {Frame(0)}, 0},
           {"the header is not first", {ClipResponse()}, 0},
           {"a second header", {Header(), Frame(0), Header()}, 1},
           {"a frame is missing", {Header(), Frame(1)}, 0},
           {"a frame is missing", {Header(), Frame(0), Frame(0)}, 1},
           {"it ended too early", {Header(), Frame(0)}, 1},
           {"more frames than the clip", {Header(), Frame(0), Frame(1), Frame(2)}, 1},
           {"", {Header(), Frame(0), damaged}, 1}}) {
    EXPECT_THAT(EvaluateClip(stream.parts),
                HasStatus(absl::StatusCode::kDataLoss, HasSubstr(stream.message)));
    EXPECT_EQ(frames_.size(), stream.num_frames) << stream.message;
  }
  bad_header.mutable_header()->mutable_box()->set_bits(99);
  EXPECT_THAT(EvaluateClip({bad_header}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("position_bits")));
  no_topology.mutable_header()->clear_topology_draco();
  EXPECT_FALSE(EvaluateClip({no_topology, Frame(0), Frame(1)}).ok());
  EXPECT_TRUE(frames_.empty());
}

TEST_F(RemotePosesTest, AnErrorOfTheServerIsTheErrorOfTheClip) {
  const auto refused = HasStatus(absl::StatusCode::kPermissionDenied, "not today");
  EXPECT_THAT(EvaluateClip({}, Refusal()), refused);
  EXPECT_THAT(EvaluateClip({Header(), Frame(0)}, Refusal()), refused);
  // The last frame is there, but the server says that something was wrong.
  EXPECT_THAT(EvaluateClip({Header(), Frame(0), Frame(1)}, Refusal()), refused);
}

TEST_F(RemotePosesTest, OnePoseSendsItsHistoryAndDecodesTheFrame) {
  EXPECT_CALL(server_.poses, GetStreamHeader).WillOnce([this](auto*, auto* request, auto* out) {
    EXPECT_EQ(request->model_id(), "m");
    *out->mutable_header() = stream_.header();
    return grpc::Status::OK;
  });
  EXPECT_CALL(server_.poses, EvaluatePose).WillOnce([this](auto*, auto* request, auto* out) {
    EXPECT_EQ(request->poses_size(), 2);
    EXPECT_EQ(request->poses(1).root_position().x(), 4);
    EXPECT_TRUE(request->character().skinned_only());
    *out->mutable_frame() = stream_.Frame(2);
    return grpc::Status::OK;
  });
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluatedFrame frame,
                             server_.Open()->poses().EvaluatePose(Query(), {PoseAt(3), PoseAt(4)}));
  EXPECT_LE((frame.positions - stream_.positions(2)).cwiseAbs().maxCoeff(), stream_.step_m());
}

TEST_F(RemotePosesTest, AStreamInThisProcessIsNotOffered) {
  EXPECT_THAT(server_.Open()->poses().OpenStream("m", {}, {}, nullptr),
              HasStatus(absl::StatusCode::kUnimplemented, HasSubstr("OpenLiveSession")));
}

TEST_F(RemotePosesTest, AModelThatDoesNotComeShowsNoParameters) {
  EXPECT_CALL(server_.models, DownloadModel).WillOnce(testing::Return(Refusal()));
  RemoteOptions options;
  options.stream.content = StreamContent::kParameters;
  EXPECT_THAT(server_.Open(options)->poses().EvaluateClip(
                  Query(), [](int, const EvaluatedFrame&) { return absl::OkStatus(); }),
              HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

}  // namespace
}  // namespace pleat
