#include "pleat/base/sealed_file.h"

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

constexpr FileKind kKind = {"PLEATTST", 3, 2, "test file"};

std::string Seal(const FileKind& kind, std::string_view content) {
  ByteWriter writer;
  WriteFileKind(kind, &writer);
  writer.WriteRaw(content);
  return SealFile(&writer);
}

TEST(SealedFileTest, OpensWhatWasSealed) {
  const std::string bytes = Seal(kKind, "abc");
  EXPECT_EQ(bytes.size(), kFileKindBytes + 3 + 32);
  EXPECT_EQ(bytes.substr(0, 12), std::string("PLEATTST\3\0\0\0", 12));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SealedFile file, OpenSealedFile(kKind, bytes));
  EXPECT_EQ(file.version, 3u);
  EXPECT_EQ(file.bytes.substr(kFileKindBytes), "abc");
}

TEST(SealedFileTest, ReadsTheVersionsOfItsKindAlone) {
  const auto open = [](uint32_t version) {
    return OpenSealedFile(kKind, Seal({kKind.magic, version, version, ""}, "abc"));
  };
  EXPECT_EQ(open(2)->version, 2u);
  EXPECT_THAT(open(1), HasStatus(absl::StatusCode::kInvalidArgument,
                                 "test file version 1; this program reads version 2 to 3"));
  EXPECT_FALSE(open(4).ok());
  EXPECT_THAT(OpenSealedFile(kKind, ""),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("is empty")));
  EXPECT_THAT(OpenSealedFile(kKind, "PLEATSEQ and so on"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not a Pleat test file")));
  EXPECT_THAT(OpenSealedFile(kKind, "PLEAT"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not a Pleat test file")));
}

TEST(SealedFileTest, EveryTruncationAndCorruptionIsSeen) {
  const std::string bytes = Seal(kKind, "some content");
  ForEachTruncation(bytes,
                    [](const std::string& cut) { EXPECT_FALSE(OpenSealedFile(kKind, cut).ok()); });
  ForEachCorruption(
      bytes, [](const std::string& damaged) { EXPECT_FALSE(OpenSealedFile(kKind, damaged).ok()); });
}

}  // namespace
}  // namespace pleat
