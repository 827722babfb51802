#include "gltf_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "glb_container.h"
#include "pleat/base/file.h"
#include "pleat/formats/rig_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Two buffers of three floats each: one beside the file, one in the text ("1 2 3" as base64).
class GltfFileTest : public testing::Test {
 protected:
  GltfFileTest() {
    const float values[3] = {7, 8, 9};
    EXPECT_THAT(
        WriteFile(folder_.File("a b.bin"), {reinterpret_cast<const char*>(values), sizeof(values)}),
        IsOk());
    root_ = {
        {"asset", {{"version", "2.0"}}},
        {"buffers",
         {{{"byteLength", 12}, {"uri", "a%20b.bin"}},
          {{"byteLength", 12}, {"uri", "data:application/octet-stream;base64,AACAPwAAAEAAAEBA"}}}},
        {"bufferViews", {{{"buffer", 0}, {"byteLength", 12}}, {{"buffer", 1}, {"byteLength", 12}}}},
        {"accessors",
         {{{"bufferView", 0}, {"componentType", 5126}, {"count", 1}, {"type", "VEC3"}},
          {{"bufferView", 1}, {"componentType", 5126}, {"count", 1}, {"type", "VEC3"}}}}};
  }

  absl::StatusOr<std::string> Pack(const json& root) const {
    return PackGltf(root.dump(), folder_.File("rig.gltf"), MeshLimits());
  }

  const TemporaryFolder folder_;
  json root_;
};

TEST_F(GltfFileTest, BuffersOfAnyKindAreReadAsOne) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, Pack(root_));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor beside, glb.Access(0, "VEC3"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor inside, glb.Access(1, "VEC3"));
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(beside.At(0, k), 7 + k);
    EXPECT_EQ(inside.At(0, k), 1 + k);
  }
}

TEST_F(GltfFileTest, OnlyFilesBesideItAreOpened) {
  for (const char* uri : {"/etc/passwd", "../a%20b.bin", "sub/../../x.bin", "%2e%2e/x.bin", ""}) {
    json root = root_;
    root["buffers"][0]["uri"] = uri;
    EXPECT_THAT(Pack(root), HasStatus(kInvalid, HasSubstr("not beside the file"))) << uri;
  }
  json root = root_;
  root["buffers"][0]["uri"] = "none.bin";
  EXPECT_THAT(Pack(root), HasStatus(kInvalid, HasSubstr("'none.bin' is not beside it")));
  root["buffers"][0]["uri"] = "data:text/plain,abc";
  EXPECT_THAT(Pack(root), HasStatus(kInvalid, HasSubstr("not base64")));
}

TEST_F(GltfFileTest, DocumentsThatAreWrongAreNamed) {
  for (const auto& [path, value] :
       std::vector<std::pair<std::string, json>>{{"/buffers", 7},
                                                 {"/buffers/0", 7},
                                                 {"/bufferViews/0", 7},
                                                 {"/bufferViews/0/buffer", 2},
                                                 {"/bufferViews/0/buffer", -1},
                                                 {"/bufferViews/0/byteOffset", "x"}}) {
    json root = root_;
    root[json::json_pointer(path)] = value;
    EXPECT_THAT(Pack(root), HasStatus(kInvalid, HasSubstr("export as GLB"))) << path << value;
  }
  EXPECT_THAT(PackGltf("{", "a.gltf", {}), HasStatus(kInvalid, HasSubstr("not a JSON object")));
  EXPECT_THAT(PackGltf(std::string(100'000, '['), "a.gltf", {}),
              HasStatus(kInvalid, HasSubstr("nested deeper")));
}

TEST_F(GltfFileTest, ARigFileThatIsGltfIsReadAsSuchWhateverItsName) {
  for (const char* name : {"rig.gltf", "rig.json", "rig.glb"}) {
    ASSERT_THAT(WriteFile(folder_.File(name), R"({"asset": {"version": "2.0"}})"), IsOk());
    EXPECT_THAT(ReadRigFile(folder_.File(name)),
                HasStatus(kInvalid, testing::AllOf(HasSubstr(name), HasSubstr("no skin"),
                                                   HasSubstr("export as GLB"))));
  }
}

}  // namespace
}  // namespace pleat
