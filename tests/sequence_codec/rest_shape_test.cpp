#include "rest_shape.h"

#include <gtest/gtest.h>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

std::string Encode(const TestMesh& mesh, float step_m, Eigen::Matrix3Xf* coded) {
  *coded = mesh.positions;
  BinaryCoder coder = BinaryCoder::ForEncoding();
  EXPECT_THAT(CodeRestShape(mesh.topology, step_m, &coder, coded), IsOk());
  return coder.Finish();
}

TEST(RestShapeTest, DecoderGetsTheEncodersShapeAndErrorsFollowTheStep) {
  const TestMesh torus = MakeTorus(24, 12, 5);
  size_t last_size = size_t{1} << 30;
  for (const float step_m : {1e-4f, 1e-3f, 1e-2f, 1e-1f}) {
    Eigen::Matrix3Xf coded, decoded;
    const std::string bytes = Encode(torus, step_m, &coded);
    EXPECT_LT(std::sqrt((coded - torus.positions).squaredNorm() / (3 * 288)), step_m);
    EXPECT_LT(bytes.size(), last_size) << step_m;
    last_size = bytes.size();
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    ASSERT_THAT(CodeRestShape(torus.topology, step_m, &decoder, &decoded), IsOk());
    EXPECT_EQ(decoded, coded);
  }
}

TEST(RestShapeTest, AnySoupOfPolygonsHasARestShape) {
  const TestMesh torus = MakeTorus(8, 6, 5);
  for (const TestMesh& mesh :
       {WithExtra(torus, 3, {}), WithExtra(torus, 1, {{48, 48, 9}, {0, 1, 48}}),
        TestMesh{*Topology::Create(1, {}, {}), Eigen::Matrix3Xf::Constant(3, 1, 2)}}) {
    Eigen::Matrix3Xf coded, decoded;
    const std::string bytes = Encode(mesh, 1e-3f, &coded);
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    ASSERT_THAT(CodeRestShape(mesh.topology, 1e-3f, &decoder, &decoded), IsOk());
    EXPECT_EQ(decoded, coded);
    EXPECT_LT((coded - mesh.positions).cwiseAbs().maxCoeff(), 1e-2f);
  }
}

TEST(RestShapeTest, CodeThatIsCutOffIsDataLoss) {
  const TestMesh torus = MakeTorus(8, 6, 5);
  Eigen::Matrix3Xf coded;
  const std::string bytes = Encode(torus, 1e-3f, &coded);
  for (size_t size = 0; size + 8 < bytes.size(); ++size) {
    const std::string cut = bytes.substr(0, size);
    BinaryCoder decoder = BinaryCoder::ForDecoding(cut);
    Eigen::Matrix3Xf decoded;
    const absl::Status status = CodeRestShape(torus.topology, 1e-3f, &decoder, &decoded);
    if (status.ok()) {
      EXPECT_NE(decoded, coded) << size;  // zeros are read behind the end, up to four bytes
    } else {
      EXPECT_THAT(status, HasStatus(absl::StatusCode::kDataLoss, testing::HasSubstr("cut off")));
    }
  }
}

TEST(RestShapeTest, AStepThatIsFarTooSmallIsRefused) {
  Eigen::Matrix3Xf rest = MakeTorus(8, 6, 5).positions;
  BinaryCoder coder = BinaryCoder::ForEncoding();
  EXPECT_THAT(CodeRestShape(MakeTorus(8, 6, 5).topology, 1e-12f, &coder, &rest),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
}

}  // namespace
}  // namespace pleat
