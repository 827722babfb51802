#include "pleat/wire/stream_messages.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "wire/full_samples.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(StreamMessagesTest, StreamsComeBack) {
  const StreamHeader header = FullHeader();
  PLEAT_ASSERT_OK_AND_ASSIGN(const StreamHeader h, FromProto(Reparse(ToProto(header))));
  EXPECT_EQ(h.encoding, header.encoding);
  EXPECT_EQ(h.box, header.box);
  EXPECT_EQ(h.topology, header.topology);
  EXPECT_EQ(h.vertex_order, header.vertex_order);
  EXPECT_EQ(h.num_points, 4);

  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameEncoderOptions defaults, FromProto(v1::StreamOptions()));
  EXPECT_EQ(defaults.encoding, FrameEncoding::kDracoPointCloud);
  EXPECT_EQ(defaults.position_bits, 12);
  EXPECT_EQ(defaults.speed, 5);
  v1::StreamOptions bad;
  bad.set_position_bits(40);
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("8 to 20")));
  bad.set_position_bits(12);
  bad.set_speed(-1);
  EXPECT_FALSE(FromProto(bad).ok());
  bad.clear_speed();
  bad.set_max_error_mm(1);
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("both")));
  bad.clear_position_bits();
  EXPECT_EQ(FromProto(bad)->max_error_mm, 1);
  EXPECT_EQ(FromProto(ToProto(*FromProto(bad)))->max_error_mm, 1);
  bad.set_max_error_mm(-1);
  EXPECT_FALSE(FromProto(bad).ok());
  bad.clear_max_error_mm();
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    EXPECT_EQ(*FromProto(ToProto(encoding)), encoding);
  }
  v1::Frame difference;
  difference.set_difference(true);
  difference.set_checksum(7);
  EXPECT_EQ(MarkOf(difference), (FrameMark{.keyframe = false, .checksum = 7}));
  bad.set_encoding(static_cast<v1::FrameEncoding>(99));
  EXPECT_FALSE(FromProto(bad).ok());

  EXPECT_EQ(FromProto(Reparse(ToProto(header)))->control_vertices, header.control_vertices);
  EXPECT_EQ(FromProto(ToProto(header))->content, StreamContent::kControlMesh);
  EXPECT_EQ(FromProto(v1::StreamOptions())->content, StreamContent::kMesh);
  EXPECT_FALSE(FromProto(static_cast<v1::StreamContent>(99)).ok());

  const CharacterQuery query{kId, {1, 1.5}, true, {.joints = {1, .5}, .vertices = {0, 2, .25f}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const CharacterQuery q, FromProto(Reparse(ToProto(query))));
  EXPECT_EQ(q.bone_scales, query.bone_scales);
  EXPECT_TRUE(q.skinned_only);
  EXPECT_EQ(q.strengths.joints, query.strengths.joints);
  EXPECT_EQ(q.strengths.vertices, query.strengths.vertices);
  EXPECT_FALSE(FromProto(v1::Character()).ok());
}

TEST(StreamMessagesTest, FrameParametersComeBackBitForBit) {
  Random random(3);
  FrameParameters parameters;
  parameters.pose = RandomPose(&random, 18);
  for (Eigen::Quaterniond& rotation : parameters.pose.rotations) {
    const Eigen::Quaternionf rounded = rotation.cast<float>();
    rotation = rounded.cast<double>();
  }
  parameters.coefficients = Eigen::VectorXf::Random(40);
  const v1::FrameParameters message = ToProto(parameters);
  EXPECT_LT(message.ByteSizeLong(), 500u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameParameters back, FromProto(Reparse(message)));
  EXPECT_TRUE(SamePose(back.pose, parameters.pose));
  EXPECT_EQ(back.coefficients, parameters.coefficients);
  v1::FrameParameters bad = message;
  bad.add_rotations(1);
  EXPECT_THAT(FromProto(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rotations")));
  EXPECT_FALSE(FromProto(v1::FrameParameters()).ok());
  bad = message;
  for (int i = 0; i < 5000; ++i) bad.add_coefficients(1);
  EXPECT_THAT(FromProto(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("coefficients")));
}

}  // namespace
}  // namespace pleat
