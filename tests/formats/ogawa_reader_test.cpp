#include "ogawa_reader.h"

#include <string>

#include "ogawa_writer.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;
constexpr auto kOgawaDamage = absl::StatusCode::kDataLoss;

// A root with "abc", an empty data, an empty group and a group with "abc" again.
std::string SmallOgawa() {
  OgawaWriter writer;
  const OgawaRef data = writer.AddData("abc");
  const OgawaRef inner = writer.AddGroup(std::vector<OgawaRef>{data});
  const OgawaRef root = writer.AddGroup(std::vector<OgawaRef>{
      data, writer.AddData(""), writer.AddGroup(std::vector<OgawaRef>{}), inner});
  return writer.Finish(root);
}

// The file of one root group with that reference.
std::string RootWith(uint64_t reference) {
  std::string bytes("Ogawa\xff\0\1\x10\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0", 24);
  bytes.append(reinterpret_cast<const char*>(&reference), sizeof(reference));
  return bytes;
}

TEST(OgawaReaderTest, FollowsReferences) {
  const std::string bytes = SmallOgawa();
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaReader reader, OgawaReader::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaGroup root, reader.Group(reader.root()));
  ASSERT_EQ(root.size(), 4u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string_view data, reader.Data(root.child(0)));
  EXPECT_EQ(data, "abc");
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string_view nothing, reader.Data(root.child(1)));
  EXPECT_TRUE(nothing.empty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaGroup empty, reader.Group(root.child(2)));
  EXPECT_EQ(empty.size(), 0u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaGroup inner, reader.Group(root.child(3)));
  ASSERT_EQ(inner.size(), 1u);
  EXPECT_EQ(inner.child(0), root.child(0));
}

TEST(OgawaReaderTest, KindsAreNotMixedUp) {
  const std::string bytes = SmallOgawa();
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaReader reader, OgawaReader::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaGroup root, reader.Group(reader.root()));
  EXPECT_THAT(reader.Group(root.child(0)), HasStatus(kOgawaDamage, HasSubstr("group should be")));
  EXPECT_THAT(reader.Data(root.child(3)), HasStatus(kOgawaDamage, HasSubstr("data should be")));
}

TEST(OgawaReaderTest, HeadersAreChecked) {
  std::string bytes = SmallOgawa();
  EXPECT_THAT(OgawaReader::Open("ogawa"), HasStatus(kInvalid, HasSubstr("'Ogawa'")));
  EXPECT_THAT(OgawaReader::Open("Ogawa\xff"), HasStatus(kOgawaDamage, HasSubstr("cut off")));
  bytes[5] = '\0';
  EXPECT_THAT(OgawaReader::Open(bytes), HasStatus(kInvalid, HasSubstr("never closed")));
  bytes[5] = '\xff';
  bytes[7] = 2;
  EXPECT_THAT(OgawaReader::Open(bytes), HasStatus(kInvalid, HasSubstr("version 2")));
}

TEST(OgawaReaderTest, ReferencesOutOfTheFileAreRefused) {
  for (const uint64_t position :
       {uint64_t{8}, uint64_t{25}, uint64_t{32}, uint64_t{33}, ~uint64_t{0} >> 1}) {
    for (const uint64_t bit : {uint64_t{0}, OgawaRef::kDataBit}) {
      const std::string bytes = RootWith(position | bit);
      PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaReader reader, OgawaReader::Open(bytes));
      PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaGroup root, reader.Group(reader.root()));
      const OgawaRef ref = root.child(0);
      EXPECT_EQ((ref.is_data() ? reader.Data(ref).status() : reader.Group(ref).status()).code(),
                kOgawaDamage)
          << position;
    }
  }
}

TEST(OgawaReaderTest, CountsBeyondTheFileAreRefused) {
  // The root group as its own child: 1 child. As data it would be one byte.
  const std::string bytes = RootWith(16);
  PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaReader reader, OgawaReader::Open(bytes));
  EXPECT_TRUE(reader.Group(OgawaRef{16}).ok());
  std::string many = bytes;
  for (const uint64_t count : {uint64_t{2}, uint64_t{1} << 61, ~uint64_t{0}}) {
    std::memcpy(many.data() + 16, &count, sizeof(count));
    PLEAT_ASSERT_OK_AND_ASSIGN(const OgawaReader damaged, OgawaReader::Open(many));
    EXPECT_THAT(damaged.Group(OgawaRef{16}), HasStatus(kOgawaDamage, HasSubstr("children")));
  }
}

TEST(OgawaReaderTest, DamagedBytesNeverReadOutside) {
  const auto walk = [](const std::string& damaged) {
    const absl::StatusOr<OgawaReader> reader = OgawaReader::Open(damaged);
    if (!reader.ok()) return;
    const absl::StatusOr<OgawaGroup> root = reader->Group(reader->root());
    if (!root.ok()) return;
    for (size_t i = 0; i < root->size(); ++i) {
      const absl::StatusOr<std::string_view> data = reader->Data(root->child(i));
      if (!data.ok() || data->empty()) continue;
      EXPECT_GE(data->data(), damaged.data());
      EXPECT_LE(data->data() + data->size(), damaged.data() + damaged.size());
    }
  };
  ForEachTruncation(SmallOgawa(), walk);
  ForEachCorruption(SmallOgawa(), walk);
}

}  // namespace
}  // namespace pleat
