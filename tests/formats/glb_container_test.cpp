#include "glb_container.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string U32(uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); }

std::string Chunk(uint32_t kind, const std::string& content) {
  return U32(static_cast<uint32_t>(content.size())) + U32(kind) + content;
}

std::string Glb(const json& root, const std::string& binary) {
  const std::string chunks = Chunk(0x4E4F534A, root.dump()) + Chunk(0x004E4942, binary);
  return U32(0x46546C67) + U32(2) + U32(static_cast<uint32_t>(12 + chunks.size())) + chunks;
}

// Two VEC3 of floats behind four bytes, and three normalized numbers of each integer type.
class GlbContainerTest : public testing::Test {
 protected:
  GlbContainerTest() {
    binary_ = U32(0);
    for (const float x : {1.f, 2.f, 3.f, -4.f, 5.f, .5f}) {
      binary_.append(reinterpret_cast<const char*>(&x), 4);
    }
    binary_ += std::string("\x7f\x80\xff\x00", 4);
    root_ = {{"buffers", {{{"byteLength", binary_.size()}}}},
             {"bufferViews",
              {{{"buffer", 0}, {"byteOffset", 4}, {"byteLength", 24}},
               {{"buffer", 0}, {"byteOffset", 28}, {"byteLength", 4}}}},
             {"accessors",
              {{{"bufferView", 0}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}},
               {{"bufferView", 1},
                {"componentType", 5121},
                {"normalized", true},
                {"count", 4},
                {"type", "SCALAR"}}}}};
  }

  // Opens and reads the first accessor.
  absl::Status Read(const json& root) const {
    const std::string bytes = Glb(root, binary_);
    const absl::StatusOr<GlbContainer> glb = GlbContainer::Open(bytes);
    return glb.ok() ? glb->Access(0, "VEC3").status() : glb.status();
  }

  std::string binary_;
  json root_;
};

TEST_F(GlbContainerTest, AccessorsReadNumbersOfTheirType) {
  const std::string bytes = Glb(root_, binary_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor vectors, glb.Access(0, "VEC3"));
  ASSERT_EQ(vectors.count(), 2u);
  EXPECT_EQ(vectors.At(0, 2), 3);
  EXPECT_EQ(vectors.At(1, 0), -4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor numbers, glb.Access(1, "SCALAR"));
  ASSERT_EQ(numbers.count(), 4u);
  EXPECT_DOUBLE_EQ(numbers.At(0, 0), 127 / 255.);
  EXPECT_DOUBLE_EQ(numbers.At(2, 0), 1);
}

TEST_F(GlbContainerTest, SignedNumbersAreNormalizedToMinusOne) {
  root_["accessors"][1]["componentType"] = 5120;
  const std::string bytes = Glb(root_, binary_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor numbers, glb.Access(1, "SCALAR"));
  EXPECT_EQ(numbers.At(0, 0), 1);
  EXPECT_EQ(numbers.At(1, 0), -1);  // -128 is -1, too (glTF 2.0, section 3.6.2.2)
  EXPECT_DOUBLE_EQ(numbers.At(2, 0), -1 / 127.);
}

TEST_F(GlbContainerTest, ListsAndEntriesThatAreMissingAreEmptyAndNull) {
  const std::string bytes = Glb(root_, binary_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  EXPECT_EQ(glb.List("accessors").size(), 2u);
  EXPECT_TRUE(glb.List("skins").empty());
  EXPECT_TRUE(glb.Entry("accessors", 1).is_object());
  for (const json& index : {json(2), json(-1), json("0"), json(nullptr), json(0.5)}) {
    EXPECT_TRUE(glb.Entry("accessors", index).is_null()) << index;
  }
}

TEST_F(GlbContainerTest, AccessorsThatLeaveTheFileAreRefused) {
  ASSERT_THAT(Read(root_), IsOk());
  for (const auto& [path, value] :
       std::vector<std::pair<std::string, json>>{{"/accessors/0/count", 3},
                                                 {"/accessors/0/count", 0},
                                                 {"/accessors/0/count", -1},
                                                 {"/accessors/0/count", 4'000'000'000'000'000},
                                                 {"/accessors/0/byteOffset", 1},
                                                 {"/accessors/0/byteOffset", -4},
                                                 {"/accessors/0/componentType", 7},
                                                 {"/bufferViews/0/byteOffset", 9},
                                                 {"/bufferViews/0/byteLength", 1'000'000},
                                                 {"/bufferViews/0/byteLength", "24"},
                                                 {"/bufferViews/0/byteStride", 0},
                                                 {"/bufferViews/0/byteStride", 13}}) {
    json changed = root_;
    changed[json::json_pointer(path)] = value;
    EXPECT_THAT(Read(changed), HasStatus(absl::StatusCode::kInvalidArgument,
                                         "GLB: an accessor reaches beyond its buffer"))
        << path << value;
  }
}

// A list of indices 0, 127 (in bytes) and values that lie in the first view.
TEST_F(GlbContainerTest, SparseListsThatLeaveTheFileAreRefused) {
  root_["accessors"][0]["count"] = 20;
  root_["accessors"][0].erase("bufferView");
  root_["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", 1}, {"byteOffset", 3}, {"componentType", 5121}}},
      {"values", {{"bufferView", 0}}}};
  ASSERT_THAT(Read(root_), IsOk());
  for (const auto& [path, value] : std::vector<std::pair<std::string, json>>{
           {"/accessors/0/count", 1'000'000'000},
           {"/accessors/0/sparse/count", 0},
           {"/accessors/0/sparse/count", 2},
           {"/accessors/0/sparse/count", 1'000'000'000},
           {"/accessors/0/sparse/indices", 7},
           {"/accessors/0/sparse/indices/byteOffset", 0},
           {"/accessors/0/sparse/indices/byteOffset", 4},
           {"/accessors/0/sparse/indices/byteOffset", -1},
           {"/accessors/0/sparse/indices/componentType", 5126},
           {"/accessors/0/sparse/indices/componentType", 5125},
           {"/accessors/0/sparse/indices/bufferView", 2},
           {"/accessors/0/sparse/values/bufferView", 1},
           {"/accessors/0/sparse/values/byteOffset", 13},
           {"/bufferViews/0/byteStride", 16}}) {
    json changed = root_;
    changed[json::json_pointer(path)] = value;
    EXPECT_THAT(Read(changed), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("GLB: ")))
        << path << value;
  }
}

TEST_F(GlbContainerTest, WhatIsNotSupportedIsSaid) {
  json sparse = root_;
  sparse["accessors"][0]["sparse"] = json::object();
  EXPECT_THAT(Read(sparse), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("sparse")));
  json other = root_;
  other["buffers"][0]["uri"] = "file.bin";
  EXPECT_THAT(Read(other),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no other files")));
  for (const char* name : {"EXT_meshopt_compression", "KHR_draco_mesh_compression"}) {
    json compressed = root_;
    compressed["extensionsRequired"] = {"KHR_materials_unlit", name};
    EXPECT_THAT(Read(compressed), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(name)));
  }
  json unlit = root_;
  unlit["extensionsRequired"] = {"KHR_materials_unlit"};
  EXPECT_THAT(Read(unlit), IsOk());
  json type = root_;
  type["accessors"][0]["type"] = "VEC2";
  EXPECT_THAT(Read(type), HasStatus(absl::StatusCode::kInvalidArgument,
                                    "GLB: an accessor of type VEC3 is missing"));
}

TEST_F(GlbContainerTest, OtherFilesAndDamageAreNamed) {
  const std::string bytes = Glb(root_, binary_);
  std::string version = bytes;
  version[4] = 1;
  EXPECT_THAT(GlbContainer::Open(version),
              HasStatus(absl::StatusCode::kInvalidArgument, "GLB: version 1, not 2"));
  EXPECT_THAT(GlbContainer::Open("ply\nformat ascii 1.0\nelement"),
              HasStatus(absl::StatusCode::kInvalidArgument, "GLB: not a binary glTF file"));
  EXPECT_THAT(GlbContainer::Open(U32(0x46546C67) + U32(2) + U32(20) + Chunk(0x4E4F534A, "")),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("JSON chunk")));
  root_["deep"] = json::parse(std::string(70, '[') + std::string(70, ']'));
  EXPECT_THAT(Read(root_), HasStatus(kInvalid, HasSubstr("nested deeper than 64")));
  ForEachTruncation(bytes,
                    [](const std::string& cut) { EXPECT_FALSE(GlbContainer::Open(cut).ok()); });
}

// Whatever a byte becomes, an accessor that is given out lies inside the file (sanitizers look).
TEST_F(GlbContainerTest, CorruptedFilesGiveAccessorsInsideTheFileOrNone) {
  ForEachCorruption(Glb(root_, binary_), [](const std::string& damaged) {
    const absl::StatusOr<GlbContainer> glb = GlbContainer::Open(damaged);
    if (!glb.ok()) return;
    const absl::StatusOr<GlbAccessor> accessor = glb->Access(0, "VEC3");
    if (!accessor.ok()) return;
    double sum = 0;
    for (size_t i = 0; i < accessor->count(); ++i) {
      for (int k = 0; k < 3; ++k) sum += accessor->At(i, k);
    }
    EXPECT_LE(accessor->count(), damaged.size()) << sum;
  });
}

}  // namespace
}  // namespace pleat
