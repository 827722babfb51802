#include "pleat/formats/model_file.h"

#include <cstring>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "model_builder.h"
#include "pleat/base/file.h"
#include "support/hostile_bytes.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

class ModelFileTest : public testing::TestWithParam<Learner> {
 protected:
  const std::shared_ptr<const CharacterModel> model_ = SmallModelBuilder(GetParam()).Build();
  const std::string bytes_ = EncodeModel(*model_);
};

INSTANTIATE_TEST_SUITE_P(Learners, ModelFileTest, testing::ValuesIn(kAllLearners),
                         [](const auto& info) { return LearnerName(info.param); });

TEST_P(ModelFileTest, EverythingRoundTrips) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto read, DecodeModel(bytes_));
  EXPECT_EQ(EncodeModel(*read), bytes_);
  EXPECT_EQ(read->name(), "small");
  EXPECT_EQ(read->frame_rate(), (FrameRate{25, 1}));
  EXPECT_TRUE(read->topology() == model_->topology());
  EXPECT_EQ(read->parts().appearance.face_materials, model_->parts().appearance.face_materials);
  EXPECT_EQ(read->skeleton().joint(2).name, "head");
  EXPECT_EQ(read->rig().rest_positions, model_->rig().rest_positions);
  EXPECT_EQ(read->rig().weights.vertex(3).weights, model_->rig().weights.vertex(3).weights);
  EXPECT_EQ(read->options(), model_->options());
  EXPECT_EQ(read->parts().feature_reference, model_->parts().feature_reference);
  EXPECT_EQ(read->parts().control_vertices, model_->parts().control_vertices);
  EXPECT_EQ(read->full_basis().Dense(), model_->full_basis().Dense());
  EXPECT_EQ(read->full_basis().Mean(), model_->full_basis().Mean());
  EXPECT_EQ(read->record().warnings, model_->record().warnings);
  EXPECT_EQ(read->record().fit.mean_percent, 1.25);
  EXPECT_EQ(read->record().yaw_degrees, 90);
  ASSERT_EQ(read->record().worst_frames.size(), 2u);
  EXPECT_EQ(read->record().worst_frames[0].frame, 2);
  EXPECT_EQ(read->record().worst_frames[1].mean_percent, 1.5);
  EXPECT_EQ(read->record().joint_fit_percent, (std::vector<double>{0, 1.25, 0.75}));
  EXPECT_EQ(read->record().pose_jitter_degrees, 0.5);
  EXPECT_EQ(read->record().unsmoothed_jitter_degrees, 0.625);
  EXPECT_EQ(read->record().unsmoothed_rms_percent, 1.125);
  EXPECT_EQ(read->record().validation.num_held_out_frames, 4);
  EXPECT_EQ(read->record().validation.mean_percent, model_->record().validation.mean_percent);
}

TEST_P(ModelFileTest, ReadModelPredictsTheSameBits) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto read, DecodeModel(bytes_));
  Eigen::VectorXd features = Eigen::VectorXd::LinSpaced(12, -1, 1);
  DetailModel::Workspace a, b;
  Eigen::VectorXf detail_a(model_->detail_model().num_details()), detail_b = detail_a;
  const double confidence_a = model_->detail_model().Predict(features, &a, detail_a);
  const double confidence_b = read->detail_model().Predict(features, &b, detail_b);
  EXPECT_EQ(detail_a, detail_b);
  EXPECT_EQ(confidence_a, confidence_b);
}

TEST_P(ModelFileTest, SectionTableIsTheDocumentedOne) {
  EXPECT_EQ(bytes_.substr(0, 8), "PLEATMDL");
  uint64_t expected_offset = 16 + 10 * 24;
  for (uint32_t i = 0; i < 10; ++i) {
    uint32_t type;
    uint64_t offset, size;
    std::memcpy(&type, bytes_.data() + 16 + 24 * i, 4);
    std::memcpy(&offset, bytes_.data() + 24 + 24 * i, 8);
    std::memcpy(&size, bytes_.data() + 32 + 24 * i, 8);
    EXPECT_EQ(type, i + 1);
    EXPECT_EQ(offset, expected_offset);
    expected_offset += size;
  }
  EXPECT_EQ(expected_offset + 32, bytes_.size());
  EXPECT_NE(bytes_.find("resolution_percent="), std::string::npos);
}

TEST_P(ModelFileTest, EveryTruncationFailsAlsoWithAValidChecksum) {
  ForEachTruncation(bytes_, [](const std::string& damaged) {
    EXPECT_FALSE(DecodeModel(damaged).ok());
    EXPECT_FALSE(DecodeModel(Reseal(damaged)).ok()) << damaged.size();
  });
}

TEST_P(ModelFileTest, EveryCorruptionFailsOrIsAValidModel) {
  int num_valid = 0;
  ForEachCorruption(bytes_, [&](const std::string& damaged) {
    const std::string resealed = Reseal(damaged);
    const auto model = DecodeModel(resealed);
    if (!model.ok()) return;
    ++num_valid;
    // Options have several spellings ("1" and "01"); all else has one form.
    EXPECT_EQ(EncodeModel(**DecodeModel(EncodeModel(**model))), EncodeModel(**model));
  });
  EXPECT_GT(num_valid, 1000);
  std::string damaged = bytes_;
  damaged[500] ^= 1;
  EXPECT_THAT(DecodeModel(damaged), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("checksum")));
}

TEST_P(ModelFileTest, ForeignFilesAndVersionsAreTold) {
  EXPECT_THAT(DecodeModel(""), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("empty")));
  EXPECT_THAT(DecodeModel("PLEATSEQ and so on"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not a Pleat model file")));
  std::string other = bytes_;
  other[8] = 9;
  EXPECT_THAT(DecodeModel(Reseal(other)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("version 9")));
}

TEST_P(ModelFileTest, LimitsHold) {
  MeshLimits limits;
  limits.max_vertices = 7;
  EXPECT_THAT(DecodeModel(bytes_, limits),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("section 'topology'")));
  limits = {};
  limits.max_unfolded_bytes = 16;
  EXPECT_THAT(DecodeModel(bytes_, limits),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit of 16 bytes")));
}

TEST_P(ModelFileTest, FilesRoundTripAndErrorsNameThem) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.pleat"), bytes_), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto read, ReadModelFile(folder.File("a.pleat")));
  EXPECT_EQ(EncodeModel(*read), bytes_);
  EXPECT_EQ(ModelId(bytes_).size(), 64u);
  EXPECT_THAT(ReadModelFile(folder.File("b.pleat")),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("b.pleat")));
}

// weights: outputs x inputs.
CoefficientFoldBlock FoldBlock(int first_input, int first_output, const Eigen::MatrixXd& weights) {
  return CoefficientFoldBlock::Round(first_input,
                                     {{first_output, static_cast<int>(weights.rows())}}, weights,
                                     Eigen::VectorXd::Zero(weights.cols()))
      .value();
}

// A model with all that versions 4 and 5 added: parts, regions with outputs of their own, the fold
// between them and features of the skin.
std::shared_ptr<const CharacterModel> MakePartedModel() {
  CharacterModel::Parts parts = SmallModelBuilder(Learner::kRegional).Parts();
  SkinFeaturesParameters skin{{{0, 3, 5}, {{0, 1}, {1, 2}}, {.5f, .25f}}, {}, {}};
  skin.regions = {{{0, 1},
                   FoldBlock(0, 0, Eigen::MatrixXd::Constant(2, 6, .125)).weights,
                   Eigen::Vector2f(.5f, -.25f)},
                  {}};
  parts.skin_features = SkinFeatures::FromParameters(parts.rig, skin).value();
  DetailModelParameters detail = parts.detail_model->parameters();
  RegionalGpParameters& regional = *detail.regional;
  const auto widen = [](Eigen::VectorXd* vector, double value) {
    vector->conservativeResize(vector->size() + 2);
    vector->tail(2).setConstant(value);
  };
  widen(&regional.input_mean, .5);
  widen(&regional.input_scales, 2);
  regional.inputs.conservativeResize(Eigen::NoChange, 14);
  regional.inputs.rightCols(2).setConstant(.25);
  regional.regions[0].scales[0] = {{0, 1, 12, 13}, .5, 1.5, .25, 4};
  regional.regions[1].first_output = 2;
  widen(&regional.output_mean, .75);
  const DetailBasisParameters whole = detail.basis.parts[0].basis;
  detail.basis = {.num_coefficients = 3, .parts = {}};
  const std::vector<std::vector<int>> vertices = {{0, 2, 4, 7}, {1, 3, 5, 6}};
  const std::vector<std::vector<int>> coefficients = {{0, 2}, {1, 2}};
  for (int i = 0; i < 2; ++i) {
    DetailBasisParameters basis = whole;
    basis.mean = whole.mean.segment(12 * i, 12).eval();
    basis.values = whole.values.middleRows(12 * i, 12).eval();
    detail.basis.parts.push_back({vertices[i], coefficients[i], basis});
  }
  detail.fold = {FoldBlock(0, 0, Eigen::MatrixXd::Constant(3, 2, .5)),
                 FoldBlock(2, 1, Eigen::MatrixXd::Constant(2, 2, -.5))};
  parts.detail_model =
      std::make_shared<const DetailModel>(DetailModel::FromParameters(detail).value());
  return CharacterModel::Create(std::move(parts)).value();
}

TEST(PartedModelFileTest, RoundTripsAndPredictsTheSameBits) {
  const auto model = MakePartedModel();
  const std::string bytes = EncodeModel(*model);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto read, DecodeModel(bytes));
  EXPECT_EQ(EncodeModel(*read), bytes);
  EXPECT_EQ(read->full_basis().Dense(), model->full_basis().Dense());
  ASSERT_TRUE(read->skin_features().has_value());
  EXPECT_EQ(read->skin_features()->num_regions(), 2);
  const Eigen::VectorXd features = Eigen::VectorXd::LinSpaced(14, -1, 1);
  DetailModel::Workspace a, b;
  Eigen::VectorXf expected(3), found(3);
  const double confidence = model->detail_model().PredictCoefficients(features, &a, expected);
  EXPECT_EQ(read->detail_model().PredictCoefficients(features, &b, found), confidence);
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.norm(), 0);
}

TEST(PartedModelFileTest, TheGoldenFileIsTheModel) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string golden,
      ReadFile(InSourceFolder("tests/golden/model_v5_regional_parts.pleat")));
  EXPECT_EQ(golden, EncodeModel(*MakePartedModel()));
}

// Version 4 has floats where later ones have planes.
TEST(PartedModelFileTest, TheGoldenFileOfVersion4PredictsTheSame) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto read, ReadModelFile(InSourceFolder("tests/golden/model_v4_regional_parts.pleat")));
  const auto model = MakePartedModel();
  const Eigen::VectorXd features = Eigen::VectorXd::LinSpaced(14, -1, 1);
  DetailModel::Workspace a, b;
  Eigen::VectorXf expected(3), found(3);
  model->detail_model().PredictCoefficients(features, &a, expected);
  read->detail_model().PredictCoefficients(features, &b, found);
  EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
  ASSERT_TRUE(read->skin_features().has_value());
  BoneTransforms transforms;
  ComputeBoneTransforms(model->skeleton(), Pose::Rest(model->skeleton()), {}, &transforms);
  SkinFeatures::Workspace workspace;
  Eigen::VectorXd of_model(2), of_file(2);
  model->skin_features()->Compute(transforms, &workspace, of_model);
  read->skin_features()->Compute(transforms, &workspace, of_file);
  EXPECT_LT((of_file - of_model).norm(), 1e-6 * of_model.norm());
}

TEST(PartedModelFileTest, EveryTruncationIsRefused) {
  const std::string bytes = EncodeModel(*MakePartedModel());
  ForEachTruncation(bytes, [](const std::string& cut) { EXPECT_FALSE(DecodeModel(cut).ok()); });
}

// Whatever an attacker writes behind a right checksum is refused, or is a model that answers.
TEST(PartedModelFileTest, DamageIsRefusedOrHarmless) {
  const std::string bytes = EncodeModel(*MakePartedModel());
  const Eigen::VectorXd features = Eigen::VectorXd::LinSpaced(14, -1, 1);
  ForEachCorruption(bytes, [&](const std::string& damaged) {
    const auto read = DecodeModel(Reseal(damaged));
    if (!read.ok()) return;
    const DetailModel& detail = (*read)->detail_model();
    DetailModel::Workspace workspace;
    Eigen::VectorXf coefficients(detail.num_components());
    detail.PredictCoefficients(features.head(detail.num_features()), &workspace, coefficients);
    EXPECT_TRUE(coefficients.allFinite());
  });
}

class GoldenModelTest : public ::testing::TestWithParam<std::tuple<Learner, int>> {};

TEST_P(GoldenModelTest, StaysReadable) {
  const auto [learner, version] = GetParam();
  const std::string path = InSourceFolder(
      absl::StrCat("tests/golden/model_v", version, "_", LearnerName(learner), ".pleat"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string golden, ReadFile(path));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto read, DecodeModel(golden));
  const auto expected = SmallModelBuilder(learner).Build();
  EXPECT_EQ(read->name(), "small");
  EXPECT_EQ(read->record().learner, LearnerName(learner));
  EXPECT_EQ(read->rig().rest_positions, expected->rig().rest_positions);
  const PartedBasis& basis = read->detail_model().basis();
  EXPECT_LT((basis.Dense() - expected->detail_model().basis().Dense()).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_EQ(basis.Mean(), expected->detail_model().basis().Mean());
}

INSTANTIATE_TEST_SUITE_P(Versions, GoldenModelTest,
                         ::testing::Combine(::testing::Values(Learner::kGp, Learner::kSgplvm,
                                                              Learner::kRidge, Learner::kRegional),
                                            ::testing::Values(1, 2, 3, 4, 5)));

}  // namespace
}  // namespace pleat
