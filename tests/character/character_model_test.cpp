#include "pleat/character/character_model.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "pleat/skinning/user_rig.h"
#include "support/fake_training.h"
#include "support/not_a_number.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using Parts = CharacterModel::Parts;

Parts GoodParts() { return MakeFakeModel(MakeSwayingTube(2), {})->parts(); }

struct Misfit {
  const char* words;
  std::function<void(Parts&)> spoil;
};

class CharacterModelMisfitTest : public ::testing::TestWithParam<Misfit> {};

TEST_P(CharacterModelMisfitTest, IsNamed) {
  Parts parts = GoodParts();
  GetParam().spoil(parts);
  EXPECT_THAT(CharacterModel::Create(std::move(parts)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(GetParam().words)));
}

const Misfit kMisfits[] = {
    {"history", [](Parts& p) { p.options.history = 0; }},
    {"number of joints",
     [](Parts& p) {
       p.rig.skeleton = Skeleton::Create({{"one", -1, {0, 0, 0}}}).value();
     }},
    {"rest positions",
     [](Parts& p) { p.rig.rest_positions.conservativeResize(3, p.topology.num_vertices() - 1); }},
    {"not finite", [](Parts& p) { p.rig.rest_positions(1, 7) = kNan; }},
    {"weighted vertices",
     [](Parts& p) {
       std::vector<VertexInfluences> influences = p.rig.weights.influences();
       influences.pop_back();
       p.rig.weights = SkinWeights::Create(3, influences).value();
     }},
    {"joints of the weights",
     [](Parts& p) { p.rig.weights = SkinWeights::Create(4, p.rig.weights.influences()).value(); }},
    {"ascending", [](Parts& p) { p.control_vertices.clear(); }},
    {"ascending", [](Parts& p) { std::swap(p.control_vertices[0], p.control_vertices[1]); }},
    {"ascending", [](Parts& p) { p.control_vertices[1] = p.control_vertices[0]; }},
    {"ascending", [](Parts& p) { p.control_vertices[0] = -1; }},
    {"ascending", [](Parts& p) { p.control_vertices.back() = p.topology.num_vertices(); }},
    {"without an upsampler", [](Parts& p) { p.control_vertices.pop_back(); }},
    {"row count",
     [](Parts& p) {
       p.upsampler = RbfUpsampler::FromRows(1, {0, 1}, {0}, {1}).value();
     }},
    {"feature reference", [](Parts& p) { p.feature_reference.conservativeResize(5); }},
    {"feature reference is not finite", [](Parts& p) { p.feature_reference[0] = kNan; }},
    {"no detail model", [](Parts& p) { p.detail_model = nullptr; }},
    {"inputs of the detail model", [](Parts& p) { ++p.options.history; }}};

INSTANTIATE_TEST_SUITE_P(Parts, CharacterModelMisfitTest, ::testing::ValuesIn(kMisfits));

// Scratch memory is made for the most joints that a rig may have; a file can claim more.
TEST(CharacterModelTest, MoreJointsThanARigMayHaveAreRefused) {
  for (const int num_joints : {kMaxUserJoints, kMaxUserJoints + 1}) {
    Parts parts = GoodParts();
    std::vector<Joint> joints = parts.rig.skeleton.joints();
    while (static_cast<int>(joints.size()) < num_joints) {
      joints.push_back({"more" + std::to_string(joints.size()), 0, {0, 0, 0}});
    }
    parts.rig.skeleton = Skeleton::Create(std::move(joints)).value();
    parts.rig.weights = SkinWeights::Create(num_joints, parts.rig.weights.influences()).value();
    // What comes next in the checks still does not fit: only the reason tells.
    EXPECT_THAT(CharacterModel::Create(std::move(parts)),
                HasStatus(absl::StatusCode::kInvalidArgument,
                          HasSubstr(num_joints > kMaxUserJoints ? "the limit is 256"
                                                                : "feature reference")));
  }
}

TEST(CharacterModelTest, AnotherRecordChangesNothingElse) {
  const auto model = MakeFakeModel(MakeSwayingTube(2), {});
  TrainingRecord record;
  record.learner = "gp";
  record.num_frames = 123;
  const auto other = model->WithRecord(record);
  EXPECT_EQ(other->record().num_frames, 123);
  EXPECT_NE(model->record().num_frames, 123);
  EXPECT_EQ(&other->detail_model(), &model->detail_model());  // shared, not copied
  EXPECT_TRUE(other->topology() == model->topology());
  EXPECT_EQ(other->memory_bytes(), model->memory_bytes());
}

TEST(CharacterModelTest, AModelIsChargedForWhatItHolds) {
  const auto small = MakeFakeModel(MakeSwayingTube(2), {});
  const auto large = MakeFakeModel(MakeSwayingTube(2, "tube", 120, 8), {});
  // At least rest positions, weights and the skinning blocks of the further vertices.
  const auto further = static_cast<size_t>(large->num_vertices() - small->num_vertices());
  EXPECT_GT(large->memory_bytes(), small->memory_bytes() + further * (3 * sizeof(double) + 24));
}

// At a lower resolution the basis that is used is the control basis times the upsampling.
TEST(CharacterModelTest, UpsamplingIsFoldedIntoTheBasis) {
  const auto full = MakeFakeModel(MakeSwayingTube(2), {});
  EXPECT_EQ(&full->full_basis(), &full->detail_model().basis());
  Parts parts = full->parts();
  const int num_vertices = full->num_vertices();
  // The unit matrix as an upsampler: the same details, quantized once more.
  std::vector<int32_t> starts(num_vertices + 1), columns(num_vertices);
  std::iota(starts.begin(), starts.end(), 0);
  std::iota(columns.begin(), columns.end(), 0);
  parts.upsampler =
      RbfUpsampler::FromRows(num_vertices, starts, columns, std::vector<float>(num_vertices, 1.f))
          .value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upsampled, CharacterModel::Create(std::move(parts)));
  EXPECT_NE(&upsampled->full_basis(), &upsampled->detail_model().basis());
  EXPECT_LT((upsampled->full_basis().Mean() - full->full_basis().Mean()).cwiseAbs().maxCoeff(),
            1e-6);
  EXPECT_LT((upsampled->full_basis().Dense() - full->full_basis().Dense()).cwiseAbs().maxCoeff(),
            1e-4);
}

// With parts, a vertex between them is moved by the components of all that it is interpolated from.
TEST(CharacterModelTest, UpsamplingOfPartsIsFoldedIntoThem) {
  const auto full = MakeFakeModel(MakeSwayingTube(2), {});
  Parts parts = full->parts();
  const int num_vertices = full->num_vertices(), num_control = 8;
  std::vector<int32_t> starts = {0}, columns;
  std::vector<float> values;
  for (int v = 0; v < num_vertices; ++v) {
    const int first = v % (num_control - 1);
    columns.insert(columns.end(), {first, first + 1});
    values.insert(values.end(), {.75f, .25f});
    starts.push_back(static_cast<int32_t>(columns.size()));
  }
  parts.upsampler = RbfUpsampler::FromRows(num_control, starts, columns, values).value();
  parts.control_vertices = {0, 1, 2, 3, 4, 5, 6, 7};
  DetailModelParameters detail = parts.detail_model->parameters();
  const auto basis = [](int num_control_vertices, int seed) {
    return DetailBasis::Quantize(
               RandomMatrix(3 * num_control_vertices, 1, seed).col(0).cast<float>(),
               RandomMatrix(3 * num_control_vertices, 1, seed + 1),
               Eigen::VectorXd::Constant(1, 1e-6))
        .value()
        .parameters();
  };
  detail.basis = {
      .num_coefficients = 2,
      .parts = {{.vertices = {0, 1, 2}, .coefficients = {0}, .basis = basis(3, 1)},
                {.vertices = {3, 4, 5, 6, 7}, .coefficients = {1}, .basis = basis(5, 3)}}};
  parts.detail_model =
      std::make_shared<const DetailModel>(DetailModel::FromParameters(detail).value());
  const Eigen::MatrixXd control = parts.detail_model->basis().Dense();
  const Eigen::MatrixXf upsampler = parts.upsampler->matrix();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upsampled, CharacterModel::Create(std::move(parts)));
  EXPECT_EQ(upsampled->full_basis().num_parts(), 3);  // of the first, of the second, of both
  const Eigen::MatrixXd dense = upsampled->full_basis().Dense();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd own = control(Eigen::seqN(axis, num_control, 3), Eigen::all);
    const Eigen::MatrixXd expected = upsampler.cast<double>() * own;
    const Eigen::MatrixXd found = dense(Eigen::seqN(axis, num_vertices, 3), Eigen::all);
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-4);
  }
}

}  // namespace
}  // namespace pleat
