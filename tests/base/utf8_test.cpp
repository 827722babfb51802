#include "pleat/base/utf8.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

const char kReplacement[] = "\xef\xbf\xbd";

TEST(Utf8Test, KeepsWhatIsValid) {
  for (const char* text :
       {"", "samba",
        "Gr\xc3\xbc\xc3\x9f"
        "e",
        "\xe6\xad\xa9\xe3\x81\x8f", "\xf0\x9f\x92\x83", "\xf4\x8f\xbf\xbf", "\xee\x80\x80"}) {
    EXPECT_EQ(ToValidUtf8(text), text);
  }
}

TEST(Utf8Test, ReplacesWhatIsNot) {
  EXPECT_EQ(ToValidUtf8("a\xff"
                        "b"),
            std::string("a") + kReplacement + "b");
  EXPECT_EQ(ToValidUtf8("\xc3"), kReplacement);                                  // cut off
  EXPECT_EQ(ToValidUtf8("\xc0\xaf"), std::string(kReplacement) + kReplacement);  // overlong
  for (const char* text :
       {"\xed\xa0\x80", "\xe0\x80\x80", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80"}) {
    const std::string result = ToValidUtf8(text);
    EXPECT_EQ(result.find(kReplacement), 0u);
    EXPECT_EQ(ToValidUtf8(result), result);
  }
}

TEST(Utf8Test, NamesOfOtherEncodingsAreLatin1AndStayDifferent) {
  EXPECT_EQ(NameToUtf8("Gr\xc3\xbcn"), "Gr\xc3\xbcn");
  EXPECT_EQ(NameToUtf8("B\xe6r"), "B\xc3\xa6r");
  EXPECT_NE(NameToUtf8("B\xe6r"), NameToUtf8("B\xf8r"));
  for (int byte = 0; byte < 256; ++byte) {
    const std::string name = {'a', static_cast<char>(byte), 'z'};
    EXPECT_TRUE(IsValidUtf8(NameToUtf8(name))) << byte;
    EXPECT_EQ(NameToUtf8(name) == name, byte < 0x80) << byte;
  }
}

TEST(Utf8Test, APrefixCutsNoSequence) {
  const std::string text = "a\xc3\xbc\xe6\xad\xa9\xf0\x9f\x92\x83!";
  for (size_t size = 0; size <= text.size() + 1; ++size) {
    const std::string_view prefix = Utf8Prefix(text, size);
    EXPECT_LE(prefix.size(), size);
    EXPECT_TRUE(IsValidUtf8(prefix)) << size;
    EXPECT_GT(prefix.size() + 4, std::min(size, text.size())) << size;
  }
  EXPECT_EQ(Utf8Prefix(std::string(9, '\x80'), 5).size(),
            1u);  // no sequence: the end is found soon
}

TEST(Utf8Test, MessagesHoldNoControls) {
  EXPECT_EQ(EscapeControls("a\x1b[31mred\x07\n"), "a\\x1b[31mred\\x07\\x0a");
  EXPECT_EQ(EscapeControls("two\nlines\t\r", true), "two\nlines\t\\x0d");
  EXPECT_EQ(EscapeControls("\xc2\x9b"
                           "2J"),
            "\\xc2\\x9b"
            "2J");  // C1: CSI in one character
  EXPECT_EQ(EscapeControls("Gr\xc3\xbcn \xff"), "Gr\xc3\xbcn \\xff");
  for (int byte = 0; byte < 256; ++byte) {
    const std::string escaped = EscapeControls(std::string{'a', static_cast<char>(byte)});
    EXPECT_TRUE(IsValidUtf8(escaped));
    for (const char c : escaped) EXPECT_FALSE(c >= 0 && c < 0x20) << byte;
  }
}

}  // namespace
}  // namespace pleat
