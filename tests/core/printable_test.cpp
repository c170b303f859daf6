// Text of files as messages show it.
#include <gtest/gtest.h>

#include "core/excerpt.h"
#include "core/printable.h"

namespace sdm {
namespace {

TEST(Printable, PrintableTextIsUnchanged) {
  for (const char* text : {"", "part.stl", "C:\\parts\\a.obj", "Pièce n° 7", "日本語 😀", "\\u001b"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\\u001b[31mb");
  EXPECT_EQ(printable("a\r\nb\tc\a"), "a\\u000d\\u000ab\\u0009c\\u0007");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(printable("\x7f"), "\\u007f");
  EXPECT_EQ(printable("\u009b31m"), "\\u009b31m");  // CSI of C1
}

TEST(Printable, MarksOfDirectionAndSeparatorsAreEscaped) {
  EXPECT_EQ(printable("\u202agpj.\u202e"), "\\u202agpj.\\u202e");
  EXPECT_EQ(printable("\u2066a\u2069\u200f\u061c"), "\\u2066a\\u2069\\u200f\\u061c");
  EXPECT_EQ(printable("a\u2028b\u2029"), "a\\u2028b\\u2029");
}

TEST(Printable, BytesThatAreNotUtf8AreEscaped) {
  EXPECT_EQ(printable("a\xff\x80z"), "a\\xff\\x80z");
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");                    // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond Unicode
  EXPECT_EQ(printable("\xe6\x97"), "\\xe6\\x97");                    // cut
  EXPECT_EQ(printable("\xe6\x1b"), "\\xe6\\u001b");
}

TEST(Printable, EscapingTwiceChangesNothing) {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  const std::string once = printable(all);
  EXPECT_EQ(printable(once), once);
}

TEST(Printable, ExcerptsAreCut) {
  EXPECT_EQ(excerpt("short"), "short");
  EXPECT_EQ(excerpt("0123456789 and more", 10), "0123456789...");
  EXPECT_EQ(excerpt(std::string(1000, 'x')).size(), 64u + 3);
  EXPECT_EQ(excerpt("ab\x1b", 3), "ab\\u001b");
  EXPECT_EQ(excerpt("aä", 2), "a...");
  EXPECT_EQ(excerpt("a😀b", 4), "a...");
  EXPECT_EQ(excerpt("\x80\x80\x80\x80\x80\x80", 5), "\\x80\\x80...");
}

}  // namespace
}  // namespace sdm
