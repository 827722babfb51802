#include "field_coder.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/geometry/surface_hierarchy.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

TEST(FieldCoderTest, DecoderGetsTheEncodersBitsAndErrorsFollowTheStep) {
  const TestMesh mesh = MakeTorus(24, 12, 5);
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  FieldMatrix fields(mesh.positions.cols(), 30);
  Random random(9);
  for (int k = 0; k < 10; ++k) {
    const float size = 1.0f / static_cast<float>(1 + k * k);
    for (int v = 0; v < mesh.positions.cols(); ++v) {
      for (int c = 0; c < 3; ++c) {
        fields(v, 3 * k + c) =
            size * mesh.positions((c + k) % 3, v) + 0.003f * static_cast<float>(random.Normal());
      }
    }
  }
  size_t last_size = 1 << 30;
  for (const float step : {0.001f, 0.01f, 0.1f}) {
    FieldMatrix coded = fields;
    BinaryCoder encoder = BinaryCoder::ForEncoding();
    ASSERT_THAT(CodeFields(hierarchy, step, &encoder, &coded), IsOk());
    const std::string bytes = encoder.Finish();
    const double rms =
        std::sqrt((coded - fields).squaredNorm() / static_cast<double>(fields.size()));
    EXPECT_LT(rms, step);
    EXPECT_LT(bytes.size(), last_size);
    last_size = bytes.size();
    FieldMatrix decoded = FieldMatrix::Zero(fields.rows(), fields.cols());
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    ASSERT_THAT(CodeFields(hierarchy, step, &decoder, &decoded), IsOk());
    EXPECT_EQ(decoded, coded);
    BinaryCoder cut = BinaryCoder::ForDecoding(std::string_view(bytes).substr(0, bytes.size() / 2));
    EXPECT_THAT(CodeFields(hierarchy, step, &cut, &decoded),
                HasStatus(absl::StatusCode::kDataLoss, testing::HasSubstr("cut off")));
  }
}

TEST(FieldCoderTest, RefusesAStepThatIsFarTooSmall) {
  const TestMesh mesh = MakeTorus(8, 6, 5);
  const SurfaceHierarchy hierarchy(mesh.topology, &mesh.positions);
  FieldMatrix fields = mesh.positions.transpose();
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  EXPECT_THAT(CodeFields(hierarchy, 1e-12f, &encoder, &fields),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("too far")));
}

}  // namespace
}  // namespace pleat
