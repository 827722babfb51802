#include <gmock/gmock.h>

#include "c_character.h"
#include "support/hostile_bytes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ModelHandleTest : public CCharacterTest {
 protected:
  pleat_model_info Info() {
    pleat_model_info info{};
    info.struct_size = sizeof(info);
    EXPECT_EQ(pleat_model_get_info(model_.get(), &info, &error_), PLEAT_OK) << error_.message;
    return info;
  }
};

TEST_F(ModelHandleTest, TellsWhatTheCharacterIs) {
  const pleat_model_info info = Info();
  EXPECT_EQ(info.num_vertices, 96u);
  EXPECT_EQ(info.num_faces, 88u);
  EXPECT_EQ(info.num_corners, 4 * 88u);
  EXPECT_EQ(info.num_triangles, 2 * 88u);
  EXPECT_EQ(info.num_texcoords, character_->parts().appearance.texcoords.size());
  EXPECT_EQ(info.num_joints, 3u);
  EXPECT_EQ(info.num_coefficients, 2u);
  EXPECT_EQ(info.history, 3u);
  EXPECT_EQ(info.frames_per_second, 25);
  EXPECT_EQ(info.memory_bytes, character_->memory_bytes());
  EXPECT_EQ(pleat_model_name(model_.get()), character_->name());
}

TEST_F(ModelHandleTest, TellsTheSkeleton) {
  const Skeleton& skeleton = character_->skeleton();
  std::vector<double> positions(9);
  ASSERT_EQ(pleat_model_copy_joints(model_.get(), positions.data(), 9, &error_), PLEAT_OK);
  for (uint32_t j = 0; j < 3; ++j) {
    EXPECT_EQ(pleat_model_joint_name(model_.get(), j), skeleton.joint(j).name);
    EXPECT_EQ(pleat_model_joint_parent(model_.get(), j), skeleton.parent(j));
    EXPECT_EQ(Eigen::Map<Eigen::Vector3d>(positions.data() + 3 * j), skeleton.rest_position(j));
  }
  EXPECT_EQ(pleat_model_joint_name(model_.get(), 3), nullptr);
  EXPECT_EQ(pleat_model_joint_parent(model_.get(), 3), -2);
}

TEST_F(ModelHandleTest, TellsTheMesh) {
  const Topology& topology = character_->topology();
  const pleat_model_info info = Info();
  std::vector<uint32_t> triangles(3 * info.num_triangles), sizes(info.num_faces),
      corners(info.num_corners);
  ASSERT_EQ(pleat_model_copy_triangles(model_.get(), triangles.data(), triangles.size(), &error_),
            PLEAT_OK);
  ASSERT_EQ(pleat_model_copy_face_sizes(model_.get(), sizes.data(), sizes.size(), &error_),
            PLEAT_OK);
  ASSERT_EQ(pleat_model_copy_corners(model_.get(), corners.data(), corners.size(), &error_),
            PLEAT_OK);
  EXPECT_TRUE(std::equal(triangles.begin(), triangles.end(), topology.triangles().data()));
  EXPECT_TRUE(std::equal(corners.begin(), corners.end(), topology.corner_vertices().begin()));
  EXPECT_EQ(sizes, std::vector<uint32_t>(88, 4));
}

TEST_F(ModelHandleTest, TellsTextureCoordinates) {
  CharacterModel::Parts parts = character_->parts();
  parts.appearance.texcoords = {{.25f, .5f}, {1, 0}};
  parts.appearance.corner_texcoords.assign(parts.topology.num_corners(), 1);
  parts.appearance.corner_texcoords[7] = -1;
  const CModel model = ReadCModel(EncodeModel(*CharacterModel::Create(parts).value()));
  std::vector<float> texcoords(4);
  std::vector<int32_t> corners(parts.topology.num_corners());
  ASSERT_EQ(pleat_model_copy_texcoords(model.get(), texcoords.data(), 4, &error_), PLEAT_OK)
      << error_.message;
  ASSERT_EQ(pleat_model_copy_corner_texcoords(model.get(), corners.data(), corners.size(), &error_),
            PLEAT_OK);
  EXPECT_EQ(texcoords, (std::vector<float>{.25f, .5f, 1, 0}));
  EXPECT_EQ(corners, parts.appearance.corner_texcoords);
}

TEST_F(ModelHandleTest, WrongCountsAndNullAreErrors) {
  std::vector<uint32_t> values(1000);
  EXPECT_EQ(pleat_model_copy_triangles(model_.get(), values.data(), 7, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("there are 528 values of triangles and room for 7"));
  EXPECT_EQ(pleat_model_copy_triangles(model_.get(), nullptr, 528, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_model_copy_corners(nullptr, values.data(), 352, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("model is NULL"));
  pleat_model_info info{};
  EXPECT_EQ(pleat_model_get_info(model_.get(), &info, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("struct_size is 0"));
  EXPECT_EQ(pleat_model_get_info(model_.get(), nullptr, nullptr), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_model_name(nullptr), nullptr);
  EXPECT_EQ(pleat_model_joint_name(nullptr, 0), nullptr);
  EXPECT_EQ(pleat_model_joint_parent(nullptr, 0), -2);
  pleat_model_destroy(nullptr);
  EXPECT_EQ(pleat_model_create(bytes_.data(), bytes_.size(), nullptr, nullptr, &error_),
            PLEAT_INVALID_ARGUMENT);
  pleat_model* model = model_.get();
  EXPECT_EQ(pleat_model_create(nullptr, 10, nullptr, &model, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(model, nullptr) << "a failure leaves no handle";
}

// What is no model, or one of the future, is refused with words.
TEST_F(ModelHandleTest, OtherFilesAndLaterVersionsAreRefusedWithWords) {
  pleat_model* model = nullptr;
  EXPECT_EQ(pleat_model_create("o cube", 6, nullptr, &model, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("model file"));
  std::string later = bytes_;
  later[8] = 99;  // the version follows the eight bytes of the magic
  later = Reseal(later);
  EXPECT_EQ(pleat_model_create(later.data(), later.size(), nullptr, &model, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("version 99"));
}

// A model is upsampled to its full basis in memory, which a host may bound.
TEST_F(ModelHandleTest, TheHostBoundsWhatAModelTakes) {
  pleat_model_options options{.struct_size = sizeof(options), .max_unfolded_bytes = 8};
  pleat_model* model = nullptr;
  EXPECT_EQ(pleat_model_create(bytes_.data(), bytes_.size(), &options, &model, &error_),
            PLEAT_RESOURCE_EXHAUSTED);
  EXPECT_STRNE(error_.message, "");
  options.max_unfolded_bytes = 0;  // the default
  EXPECT_EQ(pleat_model_create(bytes_.data(), bytes_.size(), &options, &model, &error_), PLEAT_OK);
  pleat_model_destroy(model);
  options.struct_size = 3;
  EXPECT_EQ(pleat_model_create(bytes_.data(), bytes_.size(), &options, &model, &error_),
            PLEAT_INVALID_ARGUMENT);
}

TEST_F(ModelHandleTest, DamagedBytesAreErrorsWithWords) {
  const auto expect_error = [&](const std::string& damaged) {
    pleat_model* model = nullptr;
    const pleat_code code =
        pleat_model_create(damaged.data(), damaged.size(), nullptr, &model, &error_);
    ASSERT_NE(code, PLEAT_OK);
    ASSERT_EQ(model, nullptr);
    ASSERT_STRNE(error_.message, "");
  };
  ForEachTruncation(bytes_, expect_error);
}

TEST_F(ModelHandleTest, SaysItsVersion) {
  EXPECT_EQ(pleat_api_version(), static_cast<uint32_t>(PLEAT_API_VERSION));
  EXPECT_THAT(pleat_version(), ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
}  // namespace pleat
