#include "npy_header.h"

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string WithDictionary(const std::string& text) {
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes.push_back(static_cast<char>(text.size() & 0xff));
  bytes.push_back(static_cast<char>(text.size() >> 8));
  return bytes + text;
}

absl::StatusOr<NpyArray> ParseDictionary(const std::string& text) {
  size_t num_bytes = 0;
  return ParseNpyHeader(WithDictionary(text), &num_bytes);
}

TEST(NpyHeaderTest, FormsOfPythonAreRead) {
  for (const char* text : {"{'descr': '>f8', 'fortran_order': True, 'shape': (2, 3), }   \n",
                           "{\"shape\":(2,3),\"descr\":\">f8\",\"fortran_order\":True}",
                           "{u'descr': '>f8', 'fortran_order': True, 'shape': (2L, 3L)}"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseDictionary(text));
    EXPECT_EQ(array.kind, 'f');
    EXPECT_EQ(array.item_bytes, 8u);
    EXPECT_TRUE(array.is_big_endian);
    EXPECT_TRUE(array.is_fortran);
    EXPECT_THAT(array.shape, ElementsAre(2, 3));
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const NpyArray one, ParseDictionary("{'descr': '<U7', 'fortran_order': False, 'shape': ()}"));
  EXPECT_EQ(one.item_bytes, 28u);
  EXPECT_TRUE(one.shape.empty());
}

TEST(NpyHeaderTest, LaterVersionsHaveLongerLengths) {
  const std::string text = "{'descr': '|u1', 'fortran_order': False, 'shape': (5,)}";
  std::string bytes("\x93NUMPY\x03\x00", 8);
  bytes += std::string({static_cast<char>(text.size()), 0, 0, 0}) + text;
  size_t num_bytes = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpyArray array, ParseNpyHeader(bytes, &num_bytes));
  EXPECT_EQ(num_bytes, bytes.size());
  EXPECT_THAT(array.shape, ElementsAre(5));
}

TEST(NpyHeaderTest, WhatIsNotReadIsNamed) {
  const auto expect = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(ParseDictionary(text), HasStatus(kInvalid, HasSubstr(message))) << text;
  };
  expect("{'descr': '|O', 'fortran_order': False, 'shape': (5,)}", "Python objects");
  expect("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (5,)}", "records");
  expect("{'descr': '<c8', 'fortran_order': False, 'shape': (5,)}", "'<c8'");
  expect("{'descr': '<f16', 'fortran_order': False, 'shape': (5,)}", "'<f16'");
  expect("{'descr': '<f4', 'fortran_order': 7, 'shape': (5,)}", "fortran_order");
  expect("{'descr': '<f4', 'fortran_order': False, 'shape': (-5,)}", "shape");
  expect("{'descr': '<f4', 'fortran_order': False}", "lacks 'shape'");
  expect("{'descr': '<f4', 'more': False}", "unknown key 'more'");
  expect("[]", "no dictionary");
}

TEST(NpyHeaderTest, DamagedHeadersFailCleanly) {
  const std::string bytes =
      WithDictionary("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }");
  const auto parse = [](const std::string& damaged) {
    size_t num_bytes = 0;
    if (ParseNpyHeader(damaged, &num_bytes).ok()) {
      EXPECT_LE(num_bytes, damaged.size());
    }
  };
  ForEachTruncation(bytes, parse);
  ForEachCorruption(bytes, parse);
}

}  // namespace
}  // namespace pleat
