// Streams of parameters and of the control mesh, over a real socket.
#include <gtest/gtest.h>

#include "pleat/formats/model_file.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/wire/stream_messages.h"
#include "server/running_service.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class StreamContentTest : public testing::Test {
 protected:
  std::unique_ptr<RemoteCharacterService> Client(const FrameEncoderOptions& stream) {
    return RemoteCharacterService::Connect(running_.address(), {.stream = stream}).value();
  }
  std::vector<EvaluatedFrame> Truth(const ClipQuery& query) {
    std::vector<EvaluatedFrame> frames;
    EXPECT_THAT(running_.local().poses().EvaluateClip(query,
                                                      [&](int, const EvaluatedFrame& frame) {
                                                        frames.push_back(frame);
                                                        return absl::OkStatus();
                                                      }),
                IsOk());
    return frames;
  }

  RunningService running_{Reach::kSocket};
  const std::string id_ = running_.TrainModel(MakeSwayingTube(5, "tube", 40, 30));
  const std::shared_ptr<const CharacterModel> model_ =
      running_.local().models().Acquire(id_).value();
  const PoseTrack track_ = MakeMotion(model_->skeleton(), 12);
};

TEST_F(StreamContentTest, ParametersAreEvaluatedHereToTheServersMesh) {
  const auto client = Client({.content = StreamContent::kParameters});
  for (const bool skinned_only : {false, true}) {
    const ClipQuery query{.model_id = id_,
                          .track = track_,
                          .bone_scales = {1, 1.2, .9},
                          .skinned_only = skinned_only};
    const std::vector<EvaluatedFrame> truth = Truth(query);
    // What a frame is on the wire, and the server's own evaluation of it.
    std::vector<Eigen::Matrix3Xf> shown;
    PoseEvaluator evaluator(model_);
    ASSERT_THAT(StreamClip(client->poses(), query, {.content = StreamContent::kParameters},
                           {.on_header =
                                [&](const StreamHeader& header) {
                                  EXPECT_EQ(header.content, StreamContent::kParameters);
                                  EXPECT_EQ(header.num_vertices, 1200);
                                  EXPECT_FALSE(FrameDecoder::Create(header).ok());
                                  return absl::OkStatus();
                                },
                            .on_parameters =
                                [&](int t, const FrameParameters& parameters) {
                                  EXPECT_LT(ToProto(parameters).ByteSizeLong(),
                                            120u);  // 3 joints, 2 components
                                  EXPECT_EQ(parameters.coefficients.size(), skinned_only ? 0 : 2);
                                  EXPECT_EQ(parameters.confidence, truth[t].confidence);
                                  EvaluatedFrame frame;
                                  const absl::Status status =
                                      evaluator.Show(parameters, query.bone_scales, &frame);
                                  shown.push_back(frame.positions);
                                  return status;
                                }}),
                IsOk());
    ASSERT_EQ(shown.size(), 12u);
    int next = 0;
    ASSERT_THAT(client->poses().EvaluateClip(
                    query,
                    [&](int t, const EvaluatedFrame& frame) {
                      EXPECT_EQ(t, next++);
                      EXPECT_EQ(frame.positions, shown[t]);  // the same bits
                      EXPECT_LE((frame.positions - truth[t].positions).cwiseAbs().maxCoeff(), 2e-6);
                      EXPECT_EQ(frame.confidence, truth[t].confidence);
                      return absl::OkStatus();
                    }),
                IsOk());
    EXPECT_EQ(next, 12);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const EvaluatedFrame one,
      client->poses().EvaluatePose({.model_id = id_, .track = {}, .bone_scales = {}},
                                   {track_.pose(3), track_.pose(2)}));
  EvaluatedFrame truth;
  ASSERT_THAT(PoseEvaluator(model_).Evaluate({&track_.pose(3), &track_.pose(2)}, {}, &truth),
              IsOk());
  EXPECT_LE((one.positions - truth.positions).cwiseAbs().maxCoeff(), 2e-6);
}

TEST_F(StreamContentTest, ALiveSessionOfParametersEvaluatesWithItsModel) {
  PoseEvaluator evaluator(model_);
  for (const bool with_model : {true, false}) {
    LiveSessionOptions options{.stream = {.content = StreamContent::kParameters}};
    if (with_model) {
      options.model = DecodeModel(running_.service().models().Download(id_, {}).value()).value();
    }
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const auto session,
        running_.remote().poses().OpenLiveSession(
            {.model_id = id_, .track = {}, .bone_scales = {1, 1.1, 1.2}}, options));
    EXPECT_EQ(session->header().num_vertices, 1200);
    for (int t = 0; t < 12; ++t) {
      ASSERT_THAT(session->Send(t, track_.pose(t), {}, false, t == 5), IsOk());
      LiveFrame frame;
      ASSERT_THAT(session->Receive(&frame), IsOk());
      EXPECT_EQ(frame.number, static_cast<uint64_t>(t));
      EXPECT_TRUE(frame.draco.empty());
      ASSERT_TRUE(frame.parameters.has_value());
      EvaluatedFrame own, truth;
      ASSERT_THAT(evaluator.Show(*frame.parameters, {1, 1.1, 1.2}, &own), IsOk());
      ASSERT_THAT(evaluator.Evaluate({&track_.pose(t), &track_.pose(std::max(0, t - 1))},
                                     {1, 1.1, 1.2}, &truth),
                  IsOk());
      EXPECT_LE((own.positions - truth.positions).cwiseAbs().maxCoeff(), 2e-6);
      if (with_model) {
        EXPECT_EQ(frame.positions, own.positions);
      } else {
        EXPECT_EQ(frame.positions.cols(), 0);
      }
    }
  }
}

TEST_F(StreamContentTest, TheControlMeshIsATwentiethOfTheCharacter) {
  const ClipQuery query{.model_id = id_, .track = track_, .bone_scales = {}};
  const std::vector<EvaluatedFrame> truth = Truth(query);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    const FrameEncoderOptions stream{.encoding = encoding, .content = StreamContent::kControlMesh};
    std::optional<FrameDecoder> decoder;
    ASSERT_THAT(StreamClip(running_.remote().poses(), query, stream,
                           {.on_header =
                                [&](const StreamHeader& header) {
                                  decoder.emplace(FrameDecoder::Create(header).value());
                                  EXPECT_EQ(header.num_vertices, 60);
                                  EXPECT_EQ(header.control_vertices.size(), 60u);
                                  EXPECT_GT(decoder->topology().num_triangles(), 70);
                                  return absl::OkStatus();
                                },
                            .on_frame =
                                [&](int t, std::string_view draco, const FrameMark& mark, double) {
                                  Eigen::Matrix3Xf positions;
                                  const absl::Status status =
                                      decoder->Decode(draco, mark, &positions);
                                  if (!status.ok()) return status;
                                  const Eigen::Matrix3Xf expected = truth[t].positions(
                                      Eigen::all, decoder->header().control_vertices);
                                  EXPECT_LE((positions - expected).cwiseAbs().maxCoeff(),
                                            .505 * decoder->header().box.step_m());
                                  return absl::OkStatus();
                                }}),
                IsOk());
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const auto session,
        running_.remote().poses().OpenLiveSession({.model_id = id_, .track = {}, .bone_scales = {}},
                                                  {.stream = stream}));
    ASSERT_THAT(session->Send(1, track_.pose(0)), IsOk());
    LiveFrame frame;
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.positions.cols(), 60);
  }
}

TEST_F(StreamContentTest, ForeignParametersAreRefused) {
  PoseEvaluator evaluator(model_);
  FrameParameters good;
  ASSERT_THAT(evaluator.Predict({&track_.pose(0)}, false, &good), IsOk());
  EvaluatedFrame frame;
  ASSERT_THAT(evaluator.Show(good, {}, &frame), IsOk());
  FrameParameters bad = good;
  bad.coefficients.conservativeResize(1);
  EXPECT_THAT(evaluator.Show(bad, {}, &frame),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("another model")));
  bad = good;
  bad.coefficients[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(evaluator.Show(bad, {}, &frame),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("finite")));
  bad = good;
  bad.pose.rotations.pop_back();
  EXPECT_FALSE(evaluator.Show(bad, {}, &frame).ok());
  EXPECT_FALSE(evaluator.Predict({}, false, &bad).ok());
  // Without somebody who takes them, parameters are no stream.
  EXPECT_THAT(
      StreamClip(running_.remote().poses(), {.model_id = id_, .track = track_, .bone_scales = {}},
                 {.content = StreamContent::kParameters}, {}),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("on_parameters")));
}

}  // namespace
}  // namespace pleat
