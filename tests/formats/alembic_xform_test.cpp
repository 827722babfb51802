#include "alembic_xform.h"

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

constexpr uint8_t kOpScale = 0x00, kOpTranslate = 0x10, kOpRotate = 0x20, kOpMatrix = 0x30;
constexpr uint8_t kOpRotateX = 0x40, kOpRotateY = 0x50, kOpRotateZ = 0x60;

struct XformArchive {
  std::string bytes;
  absl::StatusOr<AlembicArchive> archive = absl::UnknownError("");
  absl::StatusOr<AlembicXform> xform = absl::UnknownError("");

  explicit XformArchive(SceneXform scene, double fps = 24, int64_t max_samples = 1000) {
    AlembicBuilder builder;
    scene.sampling = builder.AddTimeSampling(Uniform(fps));
    const ObjectToWrite object = XformObject(&builder, std::move(scene));
    bytes = builder.Finish({object}, "");
    archive = AlembicArchive::Open(bytes);
    if (archive.ok()) xform = AlembicXform::Read(1, max_samples, &*archive);
  }

  // For column vectors, as everywhere else.
  Eigen::Matrix4d MatrixAt(double seconds) {
    const auto state = xform->At(seconds, &*archive);
    EXPECT_TRUE(state.ok());
    return xform->MatrixOf(*state, &*archive).value().transpose();
  }
};

Eigen::Matrix4d Moved4(double x, double y, double z) {
  return Eigen::Affine3d(Eigen::Translation3d(x, y, z)).matrix();
}

Eigen::Matrix4d Turned4(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Affine3d(Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized())).matrix();
}

TEST(AlembicXformTest, EveryOperationMeansWhatItSays) {
  std::vector<double> matrix(16);
  Eigen::Matrix4d truth = Moved4(1, 2, 3) * Turned4(20, {1, 1, 0});
  for (int i = 0; i < 16; ++i) matrix[i] = truth(i % 4, i / 4);  // rows of the transpose
  const struct {
    uint8_t operation;
    std::vector<double> numbers;
    Eigen::Matrix4d truth;
  } kCases[] = {
      {kOpScale, {2, 3, 4}, Eigen::Vector4d(2, 3, 4, 1).asDiagonal()},
      {kOpTranslate, {5, 6, 7}, Moved4(5, 6, 7)},
      {kOpRotate, {0, 3, 4, 50}, Turned4(50, {0, 3, 4})},
      {kOpRotate, {0, 0, 0, 50}, Eigen::Matrix4d::Identity()},
      {kOpMatrix, matrix, truth},
      {kOpRotateX, {30}, Turned4(30, Eigen::Vector3d::UnitX())},
      {kOpRotateY, {-40}, Turned4(-40, Eigen::Vector3d::UnitY())},
      {kOpRotateZ, {90}, Turned4(90, Eigen::Vector3d::UnitZ())},
      {kOpTranslate | 3, {1, 0, 0}, Moved4(1, 0, 0)},  // a hint changes nothing
  };
  for (const auto& test : kCases) {
    XformArchive archive({.operations = {test.operation}, .samples = {test.numbers}});
    ASSERT_THAT(archive.xform, IsOk());
    EXPECT_FALSE(archive.xform->changes());
    EXPECT_LT((archive.MatrixAt(0) - test.truth).cwiseAbs().maxCoeff(), 1e-15)
        << static_cast<int>(test.operation);
  }
}

TEST(AlembicXformTest, TheFirstOperationIsTheOutermost) {
  XformArchive archive(
      {.operations = {kOpTranslate, kOpRotateZ, kOpScale}, .samples = {{1, 2, 3, 90, 2, 2, 2}}});
  ASSERT_THAT(archive.xform, IsOk());
  const Eigen::Matrix4d truth = Moved4(1, 2, 3) * Turned4(90, Eigen::Vector3d::UnitZ()) *
                                Eigen::Matrix4d(Eigen::Vector4d(2, 2, 2, 1).asDiagonal());
  EXPECT_LT((archive.MatrixAt(0) - truth).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(AlembicXformTest, NumbersAreInterpolatedBetweenSamples) {
  XformArchive archive({.operations = {kOpTranslate}, .samples = {{0, 0, 0}, {8, 0, 0}, {8, 4, 0}}},
                       1);
  ASSERT_THAT(archive.xform, IsOk());
  EXPECT_TRUE(archive.xform->changes());
  EXPECT_EQ(archive.xform->times().num_samples, 3);
  EXPECT_EQ(archive.MatrixAt(-1), Moved4(0, 0, 0));
  EXPECT_EQ(archive.MatrixAt(0.25), Moved4(2, 0, 0));
  EXPECT_EQ(archive.MatrixAt(1), Moved4(8, 0, 0));
  EXPECT_EQ(archive.MatrixAt(1.5), Moved4(8, 2, 0));
  EXPECT_EQ(archive.MatrixAt(7), Moved4(8, 4, 0));
}

TEST(AlembicXformTest, InheritingMayChange) {
  XformArchive always({.inherits = {{1}}}), never({.inherits = {{0}}}),
      changing({.inherits = {{1}, {0}}}, 1);
  EXPECT_TRUE(always.xform->may_inherit());
  EXPECT_FALSE(never.xform->may_inherit());
  EXPECT_FALSE(never.xform->At(0, &*never.archive)->inherits);
  EXPECT_TRUE(changing.xform->may_inherit());
  EXPECT_TRUE(changing.xform->changes());
  EXPECT_TRUE(changing.xform->At(0.4, &*changing.archive)->inherits);
  EXPECT_FALSE(changing.xform->At(1, &*changing.archive)->inherits);
}

TEST(AlembicXformTest, WithoutOperationsItIsTheIdentity) {
  XformArchive archive(SceneXform{});
  ASSERT_THAT(archive.xform, IsOk());
  EXPECT_FALSE(archive.xform->changes());
  EXPECT_EQ(archive.MatrixAt(3), Eigen::Matrix4d::Identity());
}

TEST(AlembicXformTest, FaultsAreNamed) {
  EXPECT_THAT(XformArchive({.operations = {0x70}, .samples = {{1}}}).xform,
              HasStatus(kInvalid, HasSubstr("unknown type 7")));
  EXPECT_THAT(
      XformArchive({.operations = {kOpScale}, .samples = {{1, 1, 1}, {2, 2, 2}}}, 24, 1).xform,
      HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit of 1 frames")));
  XformArchive few({.operations = {kOpMatrix}, .samples = {{1, 2, 3}}});
  ASSERT_THAT(few.xform, IsOk());
  const auto state = few.xform->At(0, &*few.archive);
  ASSERT_THAT(state, IsOk());
  EXPECT_THAT(
      few.xform->MatrixOf(*state, &*few.archive),
      HasStatus(absl::StatusCode::kDataLoss, HasSubstr("3 numbers; its operations need 16")));
}

}  // namespace
}  // namespace pleat
