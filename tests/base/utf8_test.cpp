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

}  // namespace
}  // namespace pleat
