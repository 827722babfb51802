#include "zip_archive.h"

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

std::string MakeZip(ZipWriterOptions options = {}) {
  ZipWriter zip(options);
  zip.Add("a.npy", std::string(3000, 'a') + "end");
  zip.Add("b.npy", "short");
  zip.Add("empty", "");
  return zip.Finish();
}

constexpr uint64_t kEnough = 1 << 20;

std::string ReadMember(const ZipArchive& archive, const std::string& name) {
  std::string inflated;
  const absl::StatusOr<std::string_view> bytes =
      archive.Read(*archive.Find(name), kEnough, &inflated);
  EXPECT_THAT(bytes, IsOk());
  return bytes.ok() ? std::string(*bytes) : "";
}

TEST(ZipArchiveTest, MembersComeBackStoredDeflatedAndWide) {
  for (const bool deflates : {false, true}) {
    for (const uint64_t wide_from : {uint64_t{0xffffffff}, uint64_t{0}}) {
      const std::string bytes = MakeZip({.deflates = deflates, .wide_from = wide_from});
      PLEAT_ASSERT_OK_AND_ASSIGN(const ZipArchive archive, ZipArchive::Open(bytes));
      ASSERT_EQ(archive.members().size(), 3u);
      EXPECT_EQ(ReadMember(archive, "a.npy"), std::string(3000, 'a') + "end");
      EXPECT_EQ(ReadMember(archive, "b.npy"), "short");
      EXPECT_EQ(ReadMember(archive, "empty"), "");
      EXPECT_EQ(archive.Start(archive.members()[0], 5), "aaaaa");
      EXPECT_EQ(archive.Find("c"), nullptr);
    }
  }
}

TEST(ZipArchiveTest, TheLastOfMembersWithOneNameCounts) {
  ZipWriter zip;
  zip.Add("a", "first");
  zip.Add("a", "second");
  const std::string bytes = zip.Finish();
  PLEAT_ASSERT_OK_AND_ASSIGN(const ZipArchive archive, ZipArchive::Open(bytes));
  EXPECT_EQ(ReadMember(archive, "a"), "second");
}

TEST(ZipArchiveTest, ACommentMayFollow) {
  std::string bytes = MakeZip();
  bytes[bytes.size() - 2] = 5;
  bytes += "hello";
  EXPECT_THAT(ZipArchive::Open(bytes), IsOk());
}

TEST(ZipArchiveTest, DeclaredSizesAreNotBelieved) {
  const std::string bytes = MakeZip({.deflates = true});
  PLEAT_ASSERT_OK_AND_ASSIGN(const ZipArchive archive, ZipArchive::Open(bytes));
  ZipMember member = archive.members()[0];
  std::string inflated;
  member.bytes = uint64_t{1} << 40;
  EXPECT_THAT(archive.Read(member, uint64_t{1} << 50, &inflated),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("declares")));
  EXPECT_EQ(inflated.capacity(), std::string().capacity());
  member.bytes = 3002;
  EXPECT_THAT(archive.Read(member, kEnough, &inflated),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("damaged")));
  member = archive.members()[0];
  EXPECT_THAT(archive.Read(member, 100, &inflated),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("100")));
  member.method = 12;
  EXPECT_THAT(archive.Read(member, kEnough, &inflated),
              HasStatus(kInvalid, HasSubstr("method 12")));
  member.is_encrypted = true;
  EXPECT_THAT(archive.Read(member, kEnough, &inflated),
              HasStatus(kInvalid, HasSubstr("encrypted")));
}

void ReadWhatIsThere(const std::string& damaged) {
  const absl::StatusOr<ZipArchive> archive = ZipArchive::Open(damaged);
  if (!archive.ok()) return;
  for (const ZipMember& member : archive->members()) {
    std::string inflated;
    const absl::StatusOr<std::string_view> bytes = archive->Read(member, kEnough, &inflated);
    if (bytes.ok()) {
      EXPECT_EQ(bytes->size(), member.bytes);
    }
    EXPECT_LE(archive->Start(member, 10).size(), 10u);
  }
}

TEST(ZipArchiveTest, DamagedArchivesFailCleanly) {
  for (const bool deflates : {false, true}) {
    for (const uint64_t wide_from : {uint64_t{0xffffffff}, uint64_t{0}}) {
      ZipWriter zip({.deflates = deflates, .wide_from = wide_from});
      zip.Add("a", "some text, some text, some text");
      zip.Add("b", "");
      const std::string bytes = zip.Finish();
      ForEachTruncation(bytes, [](const std::string& damaged) {
        EXPECT_FALSE(ZipArchive::Open(damaged).ok()) << damaged.size();
      });
      ForEachCorruption(bytes, ReadWhatIsThere);
    }
  }
}

}  // namespace
}  // namespace pleat
