#include "residual_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/base/random.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ResidualCoderTest : public testing::Test {
 protected:
  ResidualCoderTest() {
    Random random(2);
    for (int t = 0; t < 6; ++t) {
      truth_.push_back(Bend(torus_.positions, t));
      predicted_.push_back(truth_.back());
      for (float& x : predicted_.back().reshaped()) {
        x += 2e-3f * static_cast<float>(random.Normal());
      }
    }
  }

  std::vector<const Eigen::Matrix3Xf*> Truth() const {
    std::vector<const Eigen::Matrix3Xf*> pointers;
    for (const Eigen::Matrix3Xf& frame : truth_) pointers.push_back(&frame);
    return pointers;
  }

  // Encodes and decodes; both sides must end with the same frames.
  std::string RoundTrip(const ResidualGrid& grid, std::vector<Eigen::Matrix3Xf>* decoded) const {
    std::vector<Eigen::Matrix3Xf> frames = predicted_;
    BinaryCoder encoder = BinaryCoder::ForEncoding();
    EXPECT_THAT(CodeResiduals(hierarchy_, grid, Truth(), &encoder, &frames), IsOk());
    const std::string bytes = encoder.Finish();
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    *decoded = predicted_;
    EXPECT_THAT(CodeResiduals(hierarchy_, grid, {}, &decoder, decoded), IsOk());
    EXPECT_EQ(*decoded, frames);
    return bytes;
  }

  const TestMesh torus_ = MakeTorus(16, 10, 3);
  const SurfaceHierarchy hierarchy_{torus_.topology, &torus_.positions};
  std::vector<Eigen::Matrix3Xf> truth_, predicted_;
};

TEST_F(ResidualCoderTest, CorrectionsKeepEveryVertexWithinTheBound) {
  size_t last_size = size_t{1} << 30;
  for (const double bound_m : {1e-4, 1e-3, 3e-3, 1e-1}) {
    const ResidualGrid grid{.kind = ResidualKind::kCorrection,
                            .step_m = bound_m * 2 / std::sqrt(3.0),
                            .bound_m = bound_m};
    std::vector<Eigen::Matrix3Xf> decoded;
    const size_t size = RoundTrip(grid, &decoded).size();
    for (size_t t = 0; t < truth_.size(); ++t) {
      const double worst = (decoded[t] - truth_[t]).cast<double>().colwise().norm().maxCoeff();
      EXPECT_LE(worst, bound_m * (1 + 1e-6) + 3e-7) << bound_m;  // and the rounding of float32
    }
    EXPECT_LT(size, last_size) << bound_m;
    last_size = size;
    if (bound_m == 1e-1) {
      EXPECT_EQ(decoded, predicted_);  // good enough as predicted
    }
  }
}

TEST_F(ResidualCoderTest, AGridGivesItsNearestPointsWhateverWasPredicted) {
  const ResidualGrid grid{.kind = ResidualKind::kGrid, .step_m = 1e-3, .origin_m = {-1, .5, 2}};
  std::vector<Eigen::Matrix3Xf> decoded, others;
  RoundTrip(grid, &decoded);
  for (size_t t = 0; t < truth_.size(); ++t) {
    EXPECT_LE((decoded[t] - truth_[t]).cwiseAbs().maxCoeff(), .5e-3 + 1e-6);
    const Eigen::Matrix3Xd steps =
        (decoded[t].cast<double>().colwise() - grid.origin_m) / grid.step_m;
    EXPECT_LT((steps.array() - steps.array().round()).abs().maxCoeff(), 1e-3);
  }
  predicted_.assign(predicted_.size(), torus_.positions);  // a far worse prediction
  RoundTrip(grid, &others);
  EXPECT_EQ(others, decoded);
}

TEST_F(ResidualCoderTest, NoResidualsLeaveFramesAndCodeAlone) {
  std::vector<Eigen::Matrix3Xf> decoded;
  const std::string bytes = RoundTrip({.kind = ResidualKind::kNone}, &decoded);
  EXPECT_EQ(decoded, predicted_);
  EXPECT_EQ(bytes, BinaryCoder::ForEncoding().Finish());
}

TEST_F(ResidualCoderTest, ResidualsOfTooManyStepsAreRefusedWithTheVertex) {
  predicted_[0].col(17) << 1e6f, 0, 0;
  std::vector<Eigen::Matrix3Xf> frames = predicted_;
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  EXPECT_THAT(CodeResiduals(hierarchy_,
                            {.kind = ResidualKind::kCorrection, .step_m = 1e-3, .bound_m = 1e-3},
                            Truth(), &encoder, &frames),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        "the error of vertex 17 has too many steps of 1 mm; ask for a larger "
                        "error"));
}

TEST_F(ResidualCoderTest, CodeThatIsCutOffIsDataLoss) {
  const ResidualGrid grid{.kind = ResidualKind::kGrid, .step_m = 1e-4};
  std::vector<Eigen::Matrix3Xf> decoded;
  const std::string bytes = RoundTrip(grid, &decoded);
  for (size_t size = 0; size + 8 < bytes.size(); size += 7) {
    const std::string cut = bytes.substr(0, size);
    BinaryCoder decoder = BinaryCoder::ForDecoding(cut);
    std::vector<Eigen::Matrix3Xf> frames = predicted_;
    EXPECT_THAT(CodeResiduals(hierarchy_, grid, {}, &decoder, &frames),
                HasStatus(absl::StatusCode::kDataLoss, HasSubstr("the residuals are cut off")))
        << size;
  }
}

}  // namespace
}  // namespace pleat
