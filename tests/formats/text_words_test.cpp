#include "text_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(TextWordsTest, WordsEndAtSpacesAndBraces) {
  TextWords words("ROOT a b {\r\n}x");
  EXPECT_EQ(words.Next(), "ROOT");
  EXPECT_EQ(words.RestOfName(), "a b");
  EXPECT_EQ(words.Next(), "{");
  EXPECT_EQ(words.Next(), "}");
  EXPECT_EQ(words.line(), 2);
  EXPECT_EQ(words.Next(), "x");
  EXPECT_EQ(words.Next(), "");
}

TEST(TextWordsTest, LinesEndInEveryWayAndEmptyOnesAreSkipped) {
  TextWords words("a 1 \r\rb\n \t\nc");
  EXPECT_EQ(words.NextLine(), "a 1");
  EXPECT_EQ(words.NextLine(), "b");
  EXPECT_EQ(words.line(), 3);
  EXPECT_EQ(words.NextLine(), "c");
  EXPECT_EQ(words.line(), 5);
  EXPECT_EQ(words.NextLine(), "");
}

TEST(TextWordsTest, NumbersAreWholeWordsAndFinite) {
  double value = 0;
  EXPECT_TRUE(ParseNumber("-1.5e2", &value));
  EXPECT_EQ(value, -150);
  EXPECT_TRUE(ParseNumber("+.25", &value));
  EXPECT_EQ(value, .25);
  for (const char* wrong : {"", "1,5", "nan", "inf", "1e999", "1.#QNAN", "+-1", "0x1", "1 "}) {
    EXPECT_FALSE(ParseNumber(wrong, &value)) << wrong;
  }
}

TEST(TextWordsTest, WordsForMessagesAreShortAndPlain) {
  EXPECT_EQ(QuotedWord("a\x1b"), "'a\\x1b'");
  EXPECT_EQ(QuotedWord(std::string(100, 'x')).size(), 45u);
}

}  // namespace
}  // namespace pleat
