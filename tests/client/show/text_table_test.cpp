#include "cli/show/text_table.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(TextTable, AlignsColumns) {
  EXPECT_EQ(FormatTable({"name", "mean %"}, {{"skinned", "1.2"}, {"zéro", "10.25"}}),
            "name     mean %\n"
            "skinned     1.2\n"
            "zéro      10.25\n");
}

TEST(TextTable, NoRowsIsTheHeader) { EXPECT_EQ(FormatTable({"a", "b"}, {}), "a  b\n"); }

TEST(TextTable, MarkdownHasARuleBelowItsHeader) {
  EXPECT_EQ(FormatMarkdownTable({"a", "mm"}, {{"x", "1"}, {"y", "2"}}),
            "| a | mm |\n|---|---:|\n| x | 1 |\n| y | 2 |\n");
}

TEST(TextTable, FormatsBytes) {
  EXPECT_EQ(FormatBytes(0), "0 B");
  EXPECT_EQ(FormatBytes(999), "999 B");
  EXPECT_EQ(FormatBytes(1500), "1.5 kB");
  EXPECT_EQ(FormatBytes(20939132), "20.9 MB");
  EXPECT_EQ(FormatBytes(999999), "1.0 MB");
}

}  // namespace
}  // namespace pleat
