#include "pleat/mesh/mesh_sections.h"

#include <string>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Topology TriangleAndQuad() { return *Topology::Create(5, {0, 1, 2, 0, 2, 3, 4}, {3, 4}); }

MeshAppearance Painted() {
  MeshAppearance appearance;
  appearance.texcoords = {{0, 0.5f}, {1, 0.25f}};
  appearance.corner_texcoords = {0, 1, -1, 0, 0, 1, 1};
  appearance.material_names = {"skin", "cloth"};
  appearance.face_materials = {1, 0};
  appearance.material_library = "figure.mtl";
  return appearance;
}

TEST(MeshSectionsTest, FacesRoundTrip) {
  const Topology topology = TriangleAndQuad();
  ByteWriter writer;
  WriteFaces(topology, &writer);
  EXPECT_EQ(writer.size(), 4u * (2 + 7));
  ByteReader reader(writer.bytes());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology read, ReadFaces(&reader, 5, 2, 7));
  EXPECT_TRUE(read == topology);
  EXPECT_EQ(reader.remaining(), 0u);
  ByteReader hostile(writer.bytes());
  EXPECT_THAT(ReadFaces(&hostile, 5, 0xffffffff, 7),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("face sizes")));
}

TEST(MeshSectionsTest, AppearanceRoundTrips) {
  const MeshAppearance appearance = Painted();
  const uint32_t flags = AppearanceFlags(appearance);
  EXPECT_EQ(flags, kHasCornerTexcoords | kHasFaceMaterials);
  ByteWriter writer;
  WriteMaterialNames(appearance, &writer);
  WriteAppearanceLists(appearance, &writer);
  ByteReader reader(writer.bytes());
  MeshAppearance read;
  ASSERT_THAT(ReadMaterialNames(&reader, 2, &read), IsOk());
  ASSERT_THAT(ReadAppearanceLists(&reader, 2, flags, TriangleAndQuad(), &read), IsOk());
  EXPECT_EQ(reader.remaining(), 0u);
  EXPECT_EQ(read.material_library, "figure.mtl");
  EXPECT_THAT(read.material_names, ElementsAre("skin", "cloth"));
  EXPECT_EQ(read.texcoords, appearance.texcoords);
  EXPECT_EQ(read.corner_texcoords, appearance.corner_texcoords);
  EXPECT_EQ(read.face_materials, appearance.face_materials);
}

TEST(MeshSectionsTest, FlagsOfEmptyListsAndUnknownFlagsAreRefused) {
  EXPECT_THAT(CheckAppearanceFlags(3, 7, 2), IsOk());
  EXPECT_FALSE(CheckAppearanceFlags(kHasCornerTexcoords, 0, 2).ok());
  EXPECT_FALSE(CheckAppearanceFlags(kHasFaceMaterials, 7, 0).ok());
  EXPECT_THAT(CheckAppearanceFlags(4, 7, 2),
              HasStatus(absl::StatusCode::kInvalidArgument, "unknown flags 4"));
}

TEST(MeshSectionsTest, LongNamesAreCutWhenTheyAreWritten) {
  ByteWriter writer;
  WriteName(std::string(kMaxNameBytes + 1, 'n'), &writer);
  ByteReader reader(writer.bytes());
  EXPECT_EQ(ReadName(&reader, "name")->size(), kMaxNameBytes);
  ByteWriter hostile;
  hostile.WriteString(std::string(kMaxNameBytes + 1, 'n'));
  ByteReader hostile_reader(hostile.bytes());
  EXPECT_THAT(ReadName(&hostile_reader, "name"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("the limit is 4096")));
}

TEST(MeshSectionsTest, FrameRatesArePositive) {
  EXPECT_EQ(*MakeFrameRate(30000, 1001), (FrameRate{30000, 1001}));
  for (const uint32_t wrong : {0u, 0x80000000u}) {
    EXPECT_FALSE(MakeFrameRate(wrong, 1).ok());
    EXPECT_FALSE(MakeFrameRate(30, wrong).ok());
  }
}

TEST(MeshSectionsTest, EveryCutIsNoticedBeforeAnythingIsAllocated) {
  const Topology topology = TriangleAndQuad();
  const MeshAppearance appearance = Painted();
  ByteWriter faces, names, lists;
  WriteFaces(topology, &faces);
  WriteMaterialNames(appearance, &names);
  WriteAppearanceLists(appearance, &lists);
  ForEachTruncation(std::string(faces.bytes()), [](const std::string& bytes) {
    ByteReader reader(bytes);
    EXPECT_EQ(ReadFaces(&reader, 5, 2, 7).status().code(), absl::StatusCode::kDataLoss);
  });
  ForEachTruncation(std::string(names.bytes()), [](const std::string& bytes) {
    ByteReader reader(bytes);
    MeshAppearance read;
    EXPECT_EQ(ReadMaterialNames(&reader, 2, &read).code(), absl::StatusCode::kDataLoss);
  });
  ForEachTruncation(std::string(lists.bytes()), [&](const std::string& bytes) {
    ByteReader reader(bytes);
    MeshAppearance read;
    EXPECT_EQ(ReadAppearanceLists(&reader, 2, 3, topology, &read).code(),
              absl::StatusCode::kDataLoss);
  });
}

TEST(MeshSectionsTest, CountsThatTheBytesCannotHoldAreRefused) {
  const std::string bytes(64, '\1');
  MeshAppearance read;
  for (const uint32_t count : {0x11u, 0x10000000u, 0x80000000u, 0xffffffffu}) {
    ByteReader names(bytes), lists(bytes), sizes(bytes), corners(bytes);
    EXPECT_FALSE(ReadMaterialNames(&names, count, &read).ok()) << count;
    EXPECT_FALSE(ReadAppearanceLists(&lists, count, 0, TriangleAndQuad(), &read).ok()) << count;
    EXPECT_FALSE(ReadFaces(&sizes, 5, count, 7).ok()) << count;
    EXPECT_FALSE(ReadFaces(&corners, 5, 0, count).ok()) << count;
  }
}

TEST(MeshSectionsTest, CorruptFacesAreRefusedOrValid) {
  ByteWriter writer;
  WriteFaces(TriangleAndQuad(), &writer);
  int num_valid = 0;
  ForEachCorruption(std::string(writer.bytes()), [&](const std::string& bytes) {
    ByteReader reader(bytes);
    const absl::StatusOr<Topology> read = ReadFaces(&reader, 5, 2, 7);
    if (!read.ok()) return;
    ++num_valid;
    EXPECT_EQ(read->num_corners(), 7);
    EXPECT_LT(read->triangles().maxCoeff(), 5);
    EXPECT_GE(read->triangles().minCoeff(), 0);
  });
  EXPECT_GT(num_valid, 0);
}

}  // namespace
}  // namespace pleat
