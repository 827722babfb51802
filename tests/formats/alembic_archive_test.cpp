#include "alembic_archive.h"

#include <string>
#include <vector>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string TreeArchive() {
  AlembicBuilder builder;
  builder.AddTimeSampling(Uniform(25));
  return builder.Finish({{.name = "a",
                          .metadata = "schema=S;x=1",
                          .children = {{.name = "b"}, {.name = "c", .children = {{.name = "d"}}}}},
                         {.name = "e\x1b", .metadata = std::string(300, 'm')}},
                        "k=v");
}

TEST(AlembicArchiveTest, ObjectsComeInTheOrderOfTheFile) {
  const std::string bytes = TreeArchive();
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicArchive archive, AlembicArchive::Open(bytes));
  std::vector<std::string> paths;
  for (size_t i = 0; i < archive.objects().size(); ++i) {
    paths.push_back(archive.Path(static_cast<int>(i)));
  }
  EXPECT_THAT(paths, ElementsAre("/", "/a", "/a/b", "/a/c", "/a/c/d", "/e\\x1b"));
  EXPECT_EQ(archive.schema(1), "S");
  EXPECT_EQ(archive.objects()[5].metadata, std::string(300, 'm'));
  EXPECT_EQ(archive.metadata(), "k=v");
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicTimeSampling* sampling, archive.TimeSampling(1));
  EXPECT_EQ(*sampling, Uniform(25));
  EXPECT_THAT(archive.TimeSampling(2), HasStatus(kInvalid, HasSubstr("archive has 2")));
}

TEST(AlembicArchiveTest, PathsNameObjects) {
  const std::string bytes = TreeArchive();
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicArchive archive, AlembicArchive::Open(bytes));
  EXPECT_TRUE(archive.HasPath(4, "/a/c/d"));
  EXPECT_TRUE(archive.HasPath(4, "/a/c/d/"));
  for (const char* other : {"", "/", "d", "c/d", "/c/d", "/a/c/dd", "/a/c", "//a/c/d"}) {
    EXPECT_FALSE(archive.HasPath(4, other)) << other;
  }
  EXPECT_TRUE(archive.HasPath(0, "/"));
}

TEST(AlembicArchiveTest, MetadataIsFoundByKey) {
  EXPECT_EQ(MetadataValue("a=1;b=2=3;c", "a"), "1");
  EXPECT_EQ(MetadataValue("a=1;b=2=3;c", "b"), "2=3");
  EXPECT_EQ(MetadataValue("a=1;b=2=3;c", "c"), "");
  EXPECT_EQ(MetadataValue("", "a"), "");
}

TEST(AlembicArchiveTest, MoreMetadataThanTheIndexHoldsIsWrittenInPlace) {
  AlembicBuilder builder;
  std::vector<ObjectToWrite> objects;
  for (int i = 0; i < 300; ++i) {
    objects.push_back({.name = "o" + std::to_string(i), .metadata = "n=" + std::to_string(i)});
  }
  const std::string bytes = builder.Finish(objects, "");
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicArchive archive, AlembicArchive::Open(bytes));
  ASSERT_EQ(archive.objects().size(), 301u);
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(MetadataValue(archive.objects()[i + 1].metadata, "n"), std::to_string(i));
  }
}

// Writes a reference over the one that child `child` of the group at `group` has.
void Redirect(std::string* bytes, uint64_t group, size_t child, uint64_t to) {
  std::memcpy(bytes->data() + group + 8 + 8 * child, &to, sizeof(to));
}

uint64_t NumberIn(const std::string& bytes, uint64_t position) {
  uint64_t number;
  std::memcpy(&number, bytes.data() + position, sizeof(number));
  return number;
}

TEST(AlembicArchiveTest, CirclesEnd) {
  std::string bytes = TreeArchive();
  const uint64_t root = NumberIn(bytes, 8);
  const uint64_t top = NumberIn(bytes, root + 8 + 8 * 2);
  // The child "a" of the top object becomes the top object itself.
  Redirect(&bytes, top, 1, top);
  EXPECT_THAT(AlembicArchive::Open(bytes),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("lead back")));
}

TEST(AlembicArchiveTest, DeepTreesAreReadAndTooDeepOnesRefused) {
  for (const int depth : {900, 1100}) {
    ObjectToWrite object = {.name = "leaf"};
    for (int i = 1; i < depth; ++i) {
      ObjectToWrite parent = {.name = "x"};
      parent.children.push_back(std::move(object));
      object = std::move(parent);
    }
    const std::string bytes = AlembicBuilder().Finish({object}, "");
    const auto archive = AlembicArchive::Open(bytes);
    EXPECT_EQ(archive.ok(), depth == 900);
    if (archive.ok()) continue;
    EXPECT_THAT(archive, HasStatus(kInvalid, HasSubstr("1000 deep")));
  }
}

TEST(AlembicArchiveTest, TheRootIsChecked) {
  const std::string whole = TreeArchive();
  const uint64_t root = NumberIn(whole, 8);
  const auto with = [&](uint64_t position, int32_t value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + position, &value, sizeof(value));
    return AlembicArchive::Open(bytes).status();
  };
  EXPECT_THAT(with(root, 5), HasStatus(kInvalid, HasSubstr("5 children")));
  // The two versions are the first data of the file.
  EXPECT_THAT(with(24, 1), HasStatus(kInvalid, HasSubstr("layout 1")));
  EXPECT_THAT(with(24 + 4 + 8, 9998), HasStatus(kInvalid, HasSubstr("9998")));
}

TEST(AlembicArchiveTest, NamesAreBounded) {
  const std::string name(5000, 'n');
  EXPECT_THAT(AlembicArchive::Open(AlembicBuilder().Finish({{.name = name}}, "")),
              HasStatus(kInvalid, HasSubstr("5000 bytes")));
  EXPECT_THAT(AlembicArchive::Open(AlembicBuilder().Finish({{.name = ""}}, "")),
              HasStatus(kInvalid, HasSubstr("0 bytes")));
}

}  // namespace
}  // namespace pleat
