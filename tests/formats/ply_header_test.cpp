#include "ply_header.h"

#include <gtest/gtest.h>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr char kHeader[] =
    "ply\n"
    "format binary_little_endian 1.0\n"
    "comment made by a test\n"
    "element vertex 8\n"
    "property float x\n"
    "property double y\r\n"
    "  property\tuchar  red\n"
    "element face 12\n"
    "property list uchar int vertex_indices\n"
    "end_header\n";

absl::Status StatusOf(const std::string& text) { return ParsePlyHeader(text, "a.ply").status(); }

TEST(PlyHeaderTest, ElementsAndPropertiesKeepTheirOrder) {
  const std::string file = std::string(kHeader) + "body";
  PLEAT_ASSERT_OK_AND_ASSIGN(const PlyHeader header, ParsePlyHeader(file, "a.ply"));
  EXPECT_EQ(header.encoding, PlyEncoding::kLittleEndian);
  EXPECT_EQ(file.substr(header.body_offset), "body");
  EXPECT_EQ(header.num_lines, 10);
  ASSERT_EQ(header.elements.size(), 2u);
  EXPECT_EQ(header.elements[0].count, 8);
  ASSERT_EQ(header.elements[0].properties.size(), 3u);
  EXPECT_EQ(header.elements[0].properties[1].type, PlyScalar::kFloat64);
  EXPECT_EQ(header.elements[0].FindProperty("red"), 2);
  EXPECT_EQ(header.elements[0].FindProperty("green"), -1);
  const PlyProperty& list = header.elements[1].properties[0];
  EXPECT_TRUE(list.is_list);
  EXPECT_EQ(list.size_type, PlyScalar::kUint8);
  EXPECT_EQ(list.type, PlyScalar::kInt32);
}

TEST(PlyHeaderTest, BothNamesOfEveryTypeAreTheSameType) {
  for (const auto& [name, other, bytes] :
       {std::tuple("char", "int8", 1), std::tuple("uchar", "uint8", 1),
        std::tuple("short", "int16", 2), std::tuple("ushort", "uint16", 2),
        std::tuple("int", "int32", 4), std::tuple("uint", "uint32", 4),
        std::tuple("float", "float32", 4), std::tuple("double", "float64", 8)}) {
    const auto type_of = [](const std::string& type) {
      return ParsePlyHeader(
                 "ply\nformat ascii 1.0\nelement v 1\nproperty " + type + " x\nend_header\n",
                 "a.ply")
          .value()
          .elements[0]
          .properties[0]
          .type;
    };
    EXPECT_EQ(type_of(name), type_of(other)) << name;
    EXPECT_EQ(PlyScalarBytes(type_of(name)), bytes) << name;
  }
}

TEST(PlyHeaderTest, FaultsAreToldWithFileAndLine) {
  const std::string begin = "ply\nformat ascii 1.0\n";
  for (const auto& [text, fault] : std::vector<std::pair<std::string, std::string>>{
           {"plx\n", "a.ply:1: a PLY file begins with the line 'ply'"},
           {"\n", "a.ply:1: a PLY file begins with the line 'ply'"},
           {"ply\nformat zip 1.0\n", "a.ply:2: the format must be ascii"},
           {"ply\nformat\n", "a.ply:2: the format must be ascii"},
           {begin + "element vertex\n", "a.ply:3: expected 'element NAME COUNT'"},
           {begin + "element vertex -1\n", "a.ply:3: expected 'element NAME COUNT'"},
           {begin + "element vertex 1e3\n", "a.ply:3: expected 'element NAME COUNT'"},
           {begin + "element vertex 99999999999999999999\n", "a.ply:3: expected 'element"},
           {begin + "property float x\n", "a.ply:3: a property before the first element"},
           {begin + "element v 1\nproperty x\n", "a.ply:4: expected 'property TYPE NAME'"},
           {begin + "element v 1\nproperty half x\n", "a.ply:4: unknown property type"},
           {begin + "element v 1\nproperty list float int x\n",
            "a.ply:4: the length of a list must be an integer"},
           {begin + "elements v 1\n", "a.ply:3: unknown header line"},
           {"ply\nelement v 1\nend_header\n", "a.ply:3: the header names no format"}}) {
    EXPECT_THAT(StatusOf(text),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::StartsWith(fault)))
        << text;
  }
}

TEST(PlyHeaderTest, EveryCutIsAFileThatIsCutOff) {
  ForEachTruncation(std::string(kHeader), [](const std::string& cut) {
    EXPECT_THAT(StatusOf(cut),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::StartsWith("a.ply")))
        << cut.size();
  });
  EXPECT_THAT(StatusOf("ply\nformat ascii 1.0\n"),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        "a.ply: no 'end_header' line: the file is cut off or not a PLY file"));
}

TEST(PlyHeaderTest, HeadersWithoutEndAreNotReadForEver) {
  std::string many = "ply\nformat ascii 1.0\nelement v 1\n";
  for (int i = 0; i < 1001; ++i) many += "property float x\n";
  EXPECT_THAT(StatusOf(many + "end_header\n"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("too many properties")));
  std::string comments = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 10'000; ++i) comments += "comment\n";
  EXPECT_THAT(StatusOf(comments + "end_header\n"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no 'end_header' line")));
}

}  // namespace
}  // namespace pleat
