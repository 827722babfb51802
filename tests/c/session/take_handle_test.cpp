#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "c/c_character.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat_server.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

using CTake = std::unique_ptr<pleat_take, Destroyer<pleat_take, pleat_take_destroy>>;

// Two triangles that move, as a caller has them.
class TakeHandleTest : public ::testing::Test {
 protected:
  pleat_take_mesh Mesh() const {
    pleat_take_mesh mesh{};
    mesh.struct_size = sizeof(mesh);
    mesh.name = "flag";
    mesh.num_vertices = 4;
    mesh.num_frames = 3;
    mesh.face_sizes = sizes_.data();
    mesh.num_faces = sizes_.size();
    mesh.corners = corners_.data();
    mesh.num_corners = corners_.size();
    mesh.rate_numerator = 24;
    mesh.rate_denominator = 1;
    return mesh;
  }
  CTake Create() {
    const pleat_take_mesh mesh = Mesh();
    pleat_take* take = nullptr;
    EXPECT_EQ(pleat_take_create(&mesh, positions_.data(), positions_.size(), &take, &error_),
              PLEAT_OK)
        << error_.message;
    return CTake(take);
  }
  void ExpectRefused(const pleat_take_mesh& mesh, pleat_code code, const std::string& words) {
    pleat_take* take = nullptr;
    EXPECT_EQ(pleat_take_create(&mesh, positions_.data(), positions_.size(), &take, &error_), code);
    EXPECT_EQ(take, nullptr);
    EXPECT_THAT(error_.message, HasSubstr(words));
  }

  std::vector<uint32_t> sizes_ = {3, 3}, corners_ = {0, 1, 2, 0, 2, 3};
  std::vector<float> positions_ = [] {
    std::vector<float> positions;
    for (int i = 0; i < 36; ++i) positions.push_back(static_cast<float>(i * i % 17));
    return positions;
  }();
  TemporaryFolder folder_;
  pleat_error error_{};
};

TEST_F(TakeHandleTest, ArraysBecomeATakeThatFilesKeepBitByBit) {
  const CTake take = Create();
  pleat_take_info info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(pleat_take_get_info(take.get(), &info, &error_), PLEAT_OK);
  EXPECT_EQ(info.num_vertices, 4u);
  EXPECT_EQ(info.num_faces, 2u);
  EXPECT_EQ(info.num_frames, 3u);
  EXPECT_EQ(info.rate_numerator, 24);
  EXPECT_EQ(std::string(pleat_take_name(take.get())), "flag");
  for (const char* name : {"flag.abc", "flag.pseq"}) {
    const std::string path = folder_.File(name);
    ASSERT_EQ(pleat_take_write(take.get(), path.c_str(), &error_), PLEAT_OK) << error_.message;
    const auto read = ReadSequence(path);
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->num_frames(), 3);
    for (int t = 0; t < 3; ++t) {
      EXPECT_EQ(read->frame(t),
                Eigen::Map<const Eigen::Matrix3Xf>(positions_.data() + 12 * t, 3, 4));
    }
    pleat_take* again = nullptr;
    ASSERT_EQ(pleat_take_read(path.c_str(), nullptr, nullptr, &again, &error_), PLEAT_OK);
    const CTake owner(again);
    ASSERT_EQ(pleat_take_get_info(again, &info, &error_), PLEAT_OK);
    EXPECT_EQ(info.num_frames, 3u);
  }
  EXPECT_EQ(pleat_take_write(take.get(), folder_.File("flag.fbx").c_str(), &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr(".abc"));
}

TEST_F(TakeHandleTest, WhatMakesNoTakeIsRefused) {
  pleat_take_mesh mesh = Mesh();
  mesh.num_frames = 4;
  ExpectRefused(mesh, PLEAT_INVALID_ARGUMENT, "have 48");
  mesh = Mesh();
  mesh.num_vertices = 0;
  ExpectRefused(mesh, PLEAT_INVALID_ARGUMENT, "0 vertices");
  mesh = Mesh();
  mesh.num_vertices = 0xffffffff;
  ExpectRefused(mesh, PLEAT_RESOURCE_EXHAUSTED, "at most");
  mesh = Mesh();
  mesh.rate_denominator = 0;
  ExpectRefused(mesh, PLEAT_INVALID_ARGUMENT, "rate");
  mesh = Mesh();
  mesh.corners = nullptr;
  ExpectRefused(mesh, PLEAT_INVALID_ARGUMENT, "corners is NULL");
  mesh = Mesh();
  mesh.struct_size = 3;
  ExpectRefused(mesh, PLEAT_INVALID_ARGUMENT, "struct_size");
  corners_[4] = 4;
  ExpectRefused(Mesh(), PLEAT_INVALID_ARGUMENT, "4");
  corners_[4] = 0x80000000;
  ExpectRefused(Mesh(), PLEAT_INVALID_ARGUMENT, "out of range");
  corners_[4] = 2;
  positions_[20] = NAN;
  ExpectRefused(Mesh(), PLEAT_INVALID_ARGUMENT, "vertex 2");
}

TEST_F(TakeHandleTest, AFileThatIsNotThereSaysSo) {
  pleat_take* take = nullptr;
  EXPECT_EQ(pleat_take_read(folder_.File("none.pc2").c_str(), nullptr, nullptr, &take, &error_),
            PLEAT_NOT_FOUND);
  EXPECT_EQ(take, nullptr);
  EXPECT_THAT(error_.message, HasSubstr("none.pc2"));
  EXPECT_EQ(pleat_take_note(nullptr, 0), nullptr);
}

}  // namespace
}  // namespace pleat
