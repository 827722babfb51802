#include "pleat/formats/mdd.h"

#include <cstdlib>
#include <cstring>

#include "pleat/base/file.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/sequence_reader.h"
#include "support/hostile_bytes.h"
#include "support/mesh_shapes.h"
#include "support/python_oracle.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

MddCache MakeMdd() {
  MddCache cache;
  for (int t = 0; t < 3; ++t) {
    cache.times_s.push_back(static_cast<float>(t) / 24);
    cache.frames.push_back(Eigen::Matrix3Xf::Constant(3, 4, 0.1f * static_cast<float>(t)));
    cache.frames.back()(1, 2) = -7;
  }
  return cache;
}

TEST(MddTest, LayoutIsThePublishedOne) {
  const std::string bytes = EncodeMdd(MakeMdd());
  ASSERT_EQ(bytes.size(), 8u + 3 * 4 + 3 * 4 * 12);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\0\0\0\3\0\0\0\4", 8));
  // -7 is c0 e0 00 00: frame 0, vertex 2, y.
  EXPECT_EQ(bytes.substr(8 + 12 + 2 * 12 + 4, 4), std::string("\xc0\xe0\0\0", 4));
}

TEST(MddTest, FileRoundTrips) {
  const TemporaryFolder folder;
  const MddCache cache = MakeMdd();
  ASSERT_THAT(WriteMdd(folder.File("a.mdd"), cache), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MddCache read, ReadMdd(folder.File("a.mdd")));
  EXPECT_EQ(read.times_s, cache.times_s);
  ASSERT_EQ(read.frames.size(), 3u);
  for (int t = 0; t < 3; ++t) EXPECT_EQ(read.frames[t], cache.frames[t]);
}

TEST(MddTest, WhatIsWrongIsNamed) {
  const std::string bytes = EncodeMdd(MakeMdd());
  const auto with = [&](size_t at, uint32_t value) {
    std::string changed = bytes;
    for (size_t i = 0; i < 4; ++i) changed[at + i] = static_cast<char>(value >> (24 - 8 * i));
    return DecodeMdd(changed, "a.mdd");
  };
  EXPECT_THAT(DecodeMdd("", "a.mdd"), HasStatus(kInvalid, HasSubstr("empty")));
  EXPECT_THAT(DecodeMdd("abc", "a.mdd"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("byte 3")));
  EXPECT_THAT(with(0, 0), HasStatus(kInvalid, HasSubstr("0 frames")));
  EXPECT_THAT(with(4, 0xffffffff), HasStatus(kInvalid, HasSubstr("-1 vertices")));
  EXPECT_THAT(with(4, 0x7fffffff),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
  EXPECT_THAT(DecodeMdd(bytes, "a.mdd", {.max_sequence_bytes = 100}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("100 bytes")));
  EXPECT_THAT(
      DecodeMdd(bytes.substr(0, bytes.size() - 1), "a.mdd"),
      HasStatus(absl::StatusCode::kDataLoss,
                AllOf(HasSubstr("a.mdd"), HasSubstr("2 whole frames"), HasSubstr("cut off"))));
  EXPECT_THAT(DecodeMdd(bytes + "x", "a.mdd"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("counts are wrong")));
  std::string swapped = bytes;
  std::reverse(swapped.begin(), swapped.begin() + 4);
  std::reverse(swapped.begin() + 4, swapped.begin() + 8);
  EXPECT_THAT(DecodeMdd(swapped, "a.mdd"), HasStatus(kInvalid, HasSubstr("little-endian")));
}

TEST(MddTest, DamagedFilesFailCleanlyOrReadWholeFrames) {
  const std::string bytes = EncodeMdd(MakeMdd());
  ForEachTruncation(bytes, [](const std::string& damaged) {
    EXPECT_FALSE(DecodeMdd(damaged, "a.mdd").ok()) << damaged.size();
  });
  ForEachCorruption(bytes, [](const std::string& damaged) {
    const absl::StatusOr<MddCache> cache = DecodeMdd(damaged, "a.mdd");
    if (!cache.ok()) return;
    EXPECT_EQ(EncodeMdd(*cache), damaged);  // the format has one form only
  });
}

// What Blender's Mesh Cache modifier makes of a file must be what was written, vertex by vertex.
TEST(MddTest, BlenderShowsTheSamePositions) {
  if (std::system("blender --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no Blender is here";
  const TemporaryFolder folder;
  const MeshShape box = MakeBox({1, 2, 3});
  MddCache cache;
  std::string expected;
  for (int t = 0; t < 5; ++t) {
    cache.times_s.push_back(static_cast<float>(t) / 24);
    cache.frames.push_back(box.positions.cast<float>() * (1 + 0.37f * static_cast<float>(t)));
    expected.append(reinterpret_cast<const char*>(cache.frames.back().data()),
                    static_cast<size_t>(cache.frames.back().size()) * 4);
  }
  ASSERT_THAT(WriteMdd(folder.File("a.mdd"), cache), IsOk());
  ASSERT_THAT(WriteFile(folder.File("expected.bin"), expected), IsOk());
  std::ofstream(folder.File("script.py")) << R"(
import array, bpy, sys
folder = sys.argv[-1]
values = array.array('f', open(folder + '/expected.bin', 'rb').read())
mesh = bpy.data.meshes.new('box')
mesh.from_pydata([tuple(values[3 * v:3 * v + 3]) for v in range(8)], [], [(0, 1, 2, 3), (4, 5, 6, 7)])
thing = bpy.data.objects.new('box', mesh)
bpy.context.scene.collection.objects.link(thing)
bpy.context.scene.render.fps = 24
modifier = thing.modifiers.new('cache', 'MESH_CACHE')
modifier.cache_format = 'MDD'
modifier.filepath = folder + '/a.mdd'
modifier.frame_start = 0
worst = 0
for t in range(5):
    bpy.context.scene.frame_set(t)
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    for v in range(8):
        for k in range(3):
            worst = max(worst, abs(evaluated.vertices[v].co[k] - values[24 * t + 3 * v + k]))
open(folder + '/worst.txt', 'w').write(repr(worst))
)";
  const std::string call =
      "blender -b -P '" + folder.File("script.py") + "' -- '" + folder.path() + "' >/dev/null 2>&1";
  ASSERT_EQ(std::system(call.c_str()), 0);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string worst, ReadFile(folder.File("worst.txt")));
  EXPECT_LT(std::stod(worst), 1e-6);
}

}  // namespace
}  // namespace pleat
