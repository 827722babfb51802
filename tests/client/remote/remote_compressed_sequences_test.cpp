// Frames that a server decodes, and the streams that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "client/remote/scripted_server.h"
#include "client/test_sequence.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/service/compressed_sequence_service.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using FramesResponse = v1::DecodeFramesResponse;

FramesResponse Shape(const std::string& bytes) {
  FramesResponse response;
  response.set_shape(bytes);
  return response;
}

FramesResponse Positions(int frame, int first_vertex, const std::string& xyz) {
  FramesResponse response;
  response.mutable_positions()->set_frame(frame);
  response.mutable_positions()->set_first_vertex(first_vertex);
  response.mutable_positions()->set_xyz(xyz);
  return response;
}

// `count` vertices, each at (x, x, x).
std::string Vertices(int count, float x = 1) {
  const std::vector<float> values(3 * count, x);
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

struct Stream {
  std::string name, message;
  std::vector<FramesResponse> parts;
};

class DecodeStreamTest : public testing::Test {
 protected:
  static std::string Tetrahedron() { return EncodeSequence(MovingTetrahedron(1)); }

  // Decodes the frames 2 and 3 of a stream of `parts`.
  absl::Status Decode(const std::vector<FramesResponse>& parts, grpc::Status end = grpc::Status::OK,
                      FrameRange range = {2, 4}) {
    frames_.clear();
    EXPECT_CALL(server_.compressed, DecodeFrames)
        .WillOnce([parts, end, range](grpc::ServerContext*, const v1::DecodeFramesRequest* request,
                                      grpc::ServerWriter<FramesResponse>* out) {
          EXPECT_EQ(request->id(), "id");
          EXPECT_EQ(request->begin_frame(), range.begin);
          EXPECT_EQ(request->end_frame(), range.end);
          for (const FramesResponse& part : parts) out->Write(part);
          return end;
        });
    const auto client = server_.Open();
    return DecodeFrames(client->compressed_sequences(), "id", range,
                        {.on_shape = [](const MeshSequence&) { return absl::OkStatus(); },
                         .on_frame =
                             [this](int t, const Eigen::Matrix3Xf& positions) {
                               frames_.emplace_back(t, positions);
                               return absl::OkStatus();
                             }});
  }

  std::vector<std::pair<int, Eigen::Matrix3Xf>> frames_;
  ScriptedServer server_;
};

TEST_F(DecodeStreamTest, PartsOfAnySizeBecomeFrames) {
  const std::string shape = Tetrahedron();
  ASSERT_THAT(
      Decode({Shape(shape.substr(0, 10)), Shape(shape.substr(10)), Positions(2, 0, Vertices(1, 5)),
              Positions(2, 1, Vertices(3, 6)), Positions(3, 0, Vertices(4, 7))}),
      IsOk());
  ASSERT_EQ(frames_.size(), 2u);
  EXPECT_EQ(frames_[0].first, 2);
  EXPECT_EQ(frames_[1].first, 3);
  EXPECT_EQ(frames_[0].second.row(1), Eigen::RowVector4f(5, 6, 6, 6));
  EXPECT_EQ(frames_[1].second, Eigen::Matrix3Xf::Constant(3, 4, 7));
}

TEST_F(DecodeStreamTest, WhatIsNoStreamOfFramesIsNamed) {
  const FramesResponse shape = Shape(Tetrahedron()), frame_2 = Positions(2, 0, Vertices(4)),
                       frame_3 = Positions(3, 0, Vertices(4));
  const std::string out_of_place = "a part does not follow", early = "it ended too early";
  for (const Stream& stream : std::vector<Stream>{
           {"nothing", early, {}},
           {"only a shape", early, {shape}},
           {"an empty part first", "empty part", {FramesResponse()}},
           {"an empty part later", "empty part", {shape, frame_2, FramesResponse()}},
           {"a shape in the middle", "a second shape", {shape, frame_2, shape}},
           {"another frame first", out_of_place, {shape, frame_3}},
           {"a frame twice", out_of_place, {shape, frame_2, frame_2}},
           {"too few frames", early, {shape, frame_2}},
           {"half a frame", early, {shape, frame_2, Positions(3, 0, Vertices(2))}},
           {"one frame too many",
            out_of_place,
            {shape, frame_2, frame_3, Positions(4, 0, Vertices(4))}},
           {"a gap between vertices", out_of_place, {shape, Positions(2, 1, Vertices(3))}},
           {"negative vertices", out_of_place, {shape, Positions(2, -1, Vertices(4))}},
           {"more vertices than there are", out_of_place, {shape, Positions(2, 0, Vertices(5))}},
           {"no vertices", out_of_place, {shape, Positions(2, 0, "")}},
           {"half a vertex", out_of_place, {shape, Positions(2, 0, Vertices(4).substr(2))}},
           {"no number",
            "not finite",
            {shape, Positions(2, 0, Vertices(4, std::numeric_limits<float>::quiet_NaN()))}}}) {
    EXPECT_THAT(Decode(stream.parts),
                HasStatus(absl::StatusCode::kDataLoss, HasSubstr(stream.message)))
        << stream.name;
  }
}

TEST_F(DecodeStreamTest, AShapeThatIsNoSequenceOpensNoSession) {
  for (const std::string& shape :
       {std::string(), std::string("no sequence at all"), Tetrahedron().substr(0, 40)}) {
    const absl::Status status = Decode({Shape(shape), Positions(2, 0, Vertices(4))});
    EXPECT_FALSE(status.ok());
    EXPECT_TRUE(frames_.empty());
  }
}

TEST_F(DecodeStreamTest, AnErrorOfTheServerComesBehindTheFramesBeforeIt) {
  EXPECT_THAT(Decode({}, Refusal()), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
  EXPECT_THAT(Decode({Shape(Tetrahedron()), Positions(2, 0, Vertices(4))}, Unavailable()),
              HasStatus(absl::StatusCode::kUnavailable, "the server restarts"));
  EXPECT_EQ(frames_.size(), 1u);
}

TEST_F(DecodeStreamTest, WithoutAnEndTheServerSaysHowManyFramesThereAre) {
  ASSERT_THAT(Decode({Shape(Tetrahedron()), Positions(0, 0, Vertices(4))}, grpc::Status::OK, {}),
              IsOk());
  EXPECT_EQ(frames_.size(), 1u);
}

TEST_F(DecodeStreamTest, ASessionThatIsGivenUpEndsTheCall) {
  EXPECT_CALL(server_.compressed, DecodeFrames).WillOnce([](auto*, auto*, auto* out) {
    out->Write(Shape(Tetrahedron()));
    for (int t = 0; out->Write(Positions(t, 0, Vertices(4))); ++t) {
    }
    return grpc::Status::OK;
  });
  const auto client = server_.Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session,
                             client->compressed_sequences().OpenDecode("id", {}));
  EXPECT_THAT(session->Next(), IsOk());
}

}  // namespace
}  // namespace pleat
