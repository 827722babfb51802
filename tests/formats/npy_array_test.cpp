#include "npy_array.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// An array of any type whose items are given as bytes.
template <typename T>
std::string NpyOf(const std::string& descr, const std::vector<T>& items,
                  const std::vector<int64_t>& shape, bool is_fortran = false) {
  std::string bytes = NpyHeader(descr, shape);
  if (is_fortran) bytes.replace(bytes.find("False"), 5, "True ");
  for (T item : items) {
    std::string raw(reinterpret_cast<const char*>(&item), sizeof(T));
    if (descr[0] == '>') std::reverse(raw.begin(), raw.end());
    bytes += raw;
  }
  return bytes;
}

TEST(NpyArrayTest, HeadersEndAtAMultipleOf64) {
  for (const auto& shape : {std::vector<int64_t>{}, {7}, {175, 10002, 3}}) {
    EXPECT_EQ(NpyHeader("<f4", shape).size() % 64, 0u);
  }
}

TEST(NpyArrayTest, NumbersOfAllTypes) {
  const auto first = [](const std::string& bytes) {
    const absl::StatusOr<NpyArray> array = ParseNpy(bytes);
    EXPECT_THAT(array, IsOk());
    return array.ok() ? NpyNumber(*array, 1) : -1e9;
  };
  EXPECT_EQ(first(NpyOf<int8_t>("|i1", {0, -5}, {2})), -5);
  EXPECT_EQ(first(NpyOf<uint8_t>("|u1", {0, 250}, {2})), 250);
  EXPECT_EQ(first(NpyOf<int16_t>(">i2", {0, -500}, {2})), -500);
  EXPECT_EQ(first(NpyOf<uint16_t>("<u2", {0, 65000}, {2})), 65000);
  EXPECT_EQ(first(NpyOf<int32_t>(">i4", {0, -70000}, {2})), -70000);
  EXPECT_EQ(first(NpyOf<uint32_t>("<u4", {0, 4000000000u}, {2})), 4e9);
  EXPECT_EQ(first(NpyOf<int64_t>(">i8", {0, -(int64_t{1} << 40)}, {2})), -std::ldexp(1, 40));
  EXPECT_EQ(first(NpyOf<uint64_t>("<u8", {0, 3}, {2})), 3);
  EXPECT_EQ(first(NpyOf<float>(">f4", {0, 1.5f}, {2})), 1.5);
  EXPECT_EQ(first(NpyOf<double>(">f8", {0, -1e-300}, {2})), -1e-300);
  EXPECT_EQ(first(NpyOf<uint16_t>("<f2", {0, 0xc500}, {2})), -5);
  EXPECT_EQ(first(NpyOf<uint16_t>("<f2", {0, 1}, {2})), std::ldexp(1, -24));
  EXPECT_EQ(first(NpyOf<uint16_t>("<f2", {0, 0x7c00}, {2})),
            std::numeric_limits<double>::infinity());
}

TEST(NpyArrayTest, PositionsInBothOrdersAndPrecisions) {
  // 2 frames of 2 vertices; the value tells frame, vertex and axis.
  std::vector<double> c_order, fortran_order;
  const auto value = [](int t, int v, int k) { return 100. * t + 10 * v + k; };
  for (int t = 0; t < 2; ++t)
    for (int v = 0; v < 2; ++v)
      for (int k = 0; k < 3; ++k) c_order.push_back(value(t, v, k));
  for (int k = 0; k < 3; ++k)
    for (int v = 0; v < 2; ++v)
      for (int t = 0; t < 2; ++t) fortran_order.push_back(value(t, v, k));
  const auto as_floats = [](const std::vector<double>& values) {
    return std::vector<float>(values.begin(), values.end());
  };
  for (const std::string& bytes :
       {NpyOf<double>("<f8", c_order, {2, 2, 3}), NpyOf<double>(">f8", c_order, {2, 2, 3}),
        NpyOf<float>("<f4", as_floats(c_order), {2, 2, 3}),
        NpyOf<float>(">f4", as_floats(c_order), {2, 2, 3}),
        NpyOf<double>("<f8", fortran_order, {2, 2, 3}, true),
        NpyOf<float>(">f4", as_floats(fortran_order), {2, 2, 3}, true)}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(bytes));
    std::vector<Eigen::Matrix3Xf> frames;
    EXPECT_FALSE(TakeNpyPositions(array, &frames));
    ASSERT_EQ(frames.size(), 2u);
    for (int t = 0; t < 2; ++t)
      for (int v = 0; v < 2; ++v)
        for (int k = 0; k < 3; ++k) EXPECT_EQ(frames[t](k, v), value(t, v, k));
  }
}

TEST(NpyArrayTest, RoundingIsSaid) {
  std::vector<Eigen::Matrix3Xf> frames;
  const std::string bytes = NpyOf<double>("<f8", {0.1, 0, 0}, {1, 3});
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(bytes));
  EXPECT_TRUE(TakeNpyPositions(array, &frames));
  EXPECT_EQ(frames[0](0, 0), 0.1f);
}

TEST(NpyArrayTest, IntegersInBothOrders) {
  const std::string rows = NpyOf<int64_t>("<i8", {0, 1, 2, 3, 4, 5}, {2, 3});
  const std::string columns = NpyOf<uint8_t>("|u1", {0, 3, 1, 4, 2, 5}, {2, 3}, true);
  for (const std::string& bytes : {rows, columns}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(bytes));
    EXPECT_THAT(*NpyIntegers(array), ElementsAre(0, 1, 2, 3, 4, 5));
  }
  const std::string large = NpyOf<int64_t>("<i8", {int64_t{1} << 31}, {1});
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpy(large));
  EXPECT_THAT(NpyIntegers(array), HasStatus(kInvalid, HasSubstr("32 bits")));
}

TEST(NpyArrayTest, SizesAreCheckedAgainstTheBytes) {
  const std::string bytes = EncodeNpyFloats(std::vector<float>{1, 2, 3}, {1, 1, 3});
  EXPECT_THAT(ParseNpy(bytes.substr(0, bytes.size() - 1)),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("12 bytes, but 11")));
  EXPECT_THAT(ParseNpy(NpyHeader("<f4", {int64_t{1} << 62, int64_t{1} << 62})),
              HasStatus(kInvalid, HasSubstr("larger than any file")));
}

TEST(NpyArrayTest, DamagedArraysFailCleanly) {
  const std::string bytes = EncodeNpyFloats(std::vector<float>(6, 1.f), {1, 2, 3});
  ForEachTruncation(bytes, [](const std::string& damaged) {
    EXPECT_FALSE(ParseNpy(damaged).ok()) << damaged.size();
  });
  ForEachCorruption(bytes, [](const std::string& damaged) {
    const absl::StatusOr<NpyArray> array = ParseNpy(damaged);
    if (array.ok()) {
      EXPECT_LE(array->data.size(), damaged.size());
    }
  });
}

}  // namespace
}  // namespace pleat
