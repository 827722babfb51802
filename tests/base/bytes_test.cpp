#include "pleat/base/bytes.h"

#include <array>
#include <limits>
#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

TEST(BytesTest, ReadsBackWhatWasWritten) {
  ByteWriter writer;
  const std::vector<float> values = {1.5f, -2.25f, 3e30f};
  writer.Write<uint16_t>(0x1234);
  writer.Write(-1.25);
  writer.WriteArray(std::span(values));
  writer.WriteString("names");
  writer.WriteRaw("raw");
  const std::string bytes = writer.bytes();
  EXPECT_EQ(bytes.size(), 2 + 8 + 12 + 4 + 5 + 3u);
  EXPECT_EQ(bytes[0], 0x34);  // little-endian

  ByteReader reader(bytes);
  PLEAT_ASSERT_OK_AND_ASSIGN(const uint16_t number, reader.Read<uint16_t>("number"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const double real, reader.Read<double>("real"));
  std::vector<float> read(3);
  ASSERT_THAT(reader.ReadArray(std::span(read), "values"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string text, reader.ReadString(10, "text"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string_view raw, reader.ReadRaw(3, "raw"));
  EXPECT_EQ(number, 0x1234);
  EXPECT_EQ(real, -1.25);
  EXPECT_EQ(read, values);
  EXPECT_EQ(text, "names");
  EXPECT_EQ(raw, "raw");
  EXPECT_EQ(reader.remaining(), 0u);
}

TEST(BytesTest, EndOfDataNamesFieldAndOffset) {
  ByteReader reader("abc");
  PLEAT_ASSERT_OK_AND_ASSIGN(const uint8_t first, reader.Read<uint8_t>("first"));
  EXPECT_EQ(first, 'a');
  EXPECT_THAT(reader.Read<uint32_t>("vertex count"),
              HasStatus(absl::StatusCode::kDataLoss,
                        testing::AllOf(HasSubstr("vertex count"), HasSubstr("byte 1"))));
  EXPECT_EQ(reader.remaining(), 2u);  // a failed read takes nothing
}

TEST(BytesTest, StringLongerThanItsLimitOrTheDataIsRefused) {
  ByteWriter writer;
  writer.WriteString("0123456789");
  ByteReader limited(writer.bytes());
  EXPECT_THAT(limited.ReadString(9, "name"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("limit is 9")));
  ByteReader cut(std::string_view(writer.bytes()).substr(0, 8));
  EXPECT_THAT(cut.ReadString(100, "name"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("name")));
}

TEST(BytesTest, CountsThatOverflowAreRefused) {
  ByteReader reader("12345678");
  const uint64_t huge = std::numeric_limits<uint64_t>::max();
  EXPECT_FALSE(reader.Require(huge, 8, "items").ok());
  EXPECT_FALSE(reader.Require(huge / 8 + 2, 8, "items").ok());  // times 8 wraps to a small number
  EXPECT_TRUE(reader.Require(2, 4, "items").ok());
  EXPECT_FALSE(reader.Require(3, 4, "items").ok());
  EXPECT_TRUE(reader.Require(huge, 0, "nothing").ok());
}

TEST(BytesTest, EmptyArraysAreFine) {
  ByteWriter writer;
  writer.WriteArray(std::span<const int32_t>());
  EXPECT_EQ(writer.size(), 0u);
  ByteReader reader("");
  EXPECT_THAT(reader.ReadArray(std::span<int32_t>(), "nothing"), IsOk());
}

}  // namespace
}  // namespace pleat
