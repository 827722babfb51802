#include "pleat/formats/ply_reader.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

absl::StatusOr<MeshFile> DecodeBytes(std::string_view bytes, const MeshLimits& limits = {}) {
  return DecodePly(bytes, "m.ply", limits);
}

constexpr char kAscii[] =
    "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 4\r\n"
    "property uchar red\r\nproperty float x\r\nproperty double y\r\nproperty float z\r\n"
    "element edge 1\r\nproperty int a\r\nproperty list uchar int b\r\n"
    "element face 2\r\nproperty list uchar int vertex_index\r\nproperty float quality\r\n"
    "end_header\r\n"
    "255 0 0 0\r\n254 1 0.1 0\r\n253 1 1 -2e1\r\n252 0 1 0\r\n7 2 1 2\r\n"
    "3 0 1 2 0.5\r\n4 0 1 2 3 0.5\r\n";

// Appends values in the byte order of the file.
class BinaryBody {
 public:
  explicit BinaryBody(bool big_endian) : big_endian_(big_endian) {}
  template <typename T>
  BinaryBody& Add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian_) std::reverse(raw, raw + sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

// Vertices with a normal between x, y, z and texture coordinates; faces of a uint16-counted list
// of uint8; an unknown element between them.
std::string BinaryPly(bool big_endian) {
  const std::string header = absl::StrCat(
      "ply\nformat binary_", big_endian ? "big" : "little",
      "_endian 1.0\nelement vertex 3\nproperty double x\nproperty short nx\nproperty float y\n"
      "property int8 z\nproperty float s\nproperty float t\nelement extra 2\n"
      "property list uint uint16 numbers\nelement face 1\n"
      "property list ushort uchar vertex_indices\nend_header\n");
  BinaryBody body(big_endian);
  for (int v = 0; v < 3; ++v) {
    body.Add(0.5 * v).Add<int16_t>(-3).Add(-1.25f * v).Add(static_cast<int8_t>(-v));
    body.Add(0.1f * v).Add(1.0f);
  }
  body.Add<uint32_t>(2).Add<uint16_t>(7).Add<uint16_t>(8).Add<uint32_t>(0);
  body.Add<uint16_t>(3).Add<uint8_t>(2).Add<uint8_t>(1).Add<uint8_t>(0);
  return header + body.bytes();
}

TEST(PlyReaderTest, ReadsAsciiAmongOtherProperties) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(kAscii));
  ASSERT_EQ(mesh.positions.cols(), 4);
  EXPECT_EQ(mesh.positions.col(1), Eigen::Vector3f(1, 0.1f, 0));
  EXPECT_EQ(mesh.positions.col(2), Eigen::Vector3f(1, 1, -20));
  EXPECT_THAT(mesh.topology.face(0), ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh.topology.face(1), ElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(mesh.appearance.texcoords.empty());
}

TEST(PlyReaderTest, ReadsBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(BinaryPly(big_endian)));
    ASSERT_EQ(mesh.positions.cols(), 3);
    EXPECT_EQ(mesh.positions.col(2), Eigen::Vector3f(1, -2.5f, -2)) << big_endian;
    EXPECT_THAT(mesh.topology.face(0), ElementsAre(2, 1, 0));
    EXPECT_EQ(mesh.appearance.texcoords[2], Eigen::Vector2f(0.2f, 1));
    EXPECT_THAT(mesh.appearance.corner_texcoords, ElementsAre(2, 1, 0));
  }
}

TEST(PlyReaderTest, ReadsTexcoordsOfCorners) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeBytes("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                  "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                  "3 0 1 2 6 0 0 1 0 0 1\n"));
  EXPECT_THAT(mesh.appearance.corner_texcoords, ElementsAre(0, 1, 2));
  EXPECT_EQ(mesh.appearance.texcoords[1], Eigen::Vector2f(1, 0));
}

constexpr char kSquare[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

std::string WithLineEnds(const char* end, std::string_view text = kSquare) {
  std::string other;
  for (const char c : text) c == '\n' ? other.append(end) : other.append(1, c);
  return other;
}

TEST(PlyReaderTest, LineEndsAndByteOrderMarksDoNotMatter) {
  for (const char* end : {"\n", "\r", "\r\n"}) {
    for (const char* mark : {"", "\xef\xbb\xbf"}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(mark + WithLineEnds(end)));
      EXPECT_EQ(mesh.positions.col(3), Eigen::Vector3f(0, 1, 0));
      EXPECT_THAT(mesh.topology.face(1), ElementsAre(0, 2, 3));
    }
  }
  // The body of a binary file begins right behind a bare CR, whatever its first byte is.
  std::string binary =
      WithLineEnds("\r",
                   "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 1\n"
                   "property list uchar uchar vertex_indices\nend_header\n");
  const float values[9] = {std::bit_cast<float>(0x3f80000au), 0, 0, 0, 1, 0, 0, 0, 1};
  binary.append(reinterpret_cast<const char*>(values), sizeof(values));
  binary.append("\3\0\1\2", 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(binary));
  EXPECT_EQ(mesh.positions(0, 0), values[0]);
  EXPECT_THAT(DecodeBytes(WithLineEnds("\r").replace(WithLineEnds("\r").find("1 1 0"), 5, "1 1 x")),
              HasStatus(kInvalid, HasSubstr("line 12")));
}

TEST(PlyReaderTest, SmallFacesAndWhatIsDroppedAreSaid) {
  std::string text = kSquare;
  text.replace(text.find("face 2"), 6, "face 4");
  text += "2 0 1\n0\n";
  text.replace(text.find("property float z\n"), 17, "property float z\nproperty uchar red\n");
  for (const char* vertex : {"0 0 0\n1", "1 0 0\n1", "1 1 0\n0", "0 1 0\n3"}) {
    text.insert(text.find(vertex) + 5, " 9");
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(text));
  EXPECT_EQ(mesh.topology.num_faces(), 2);
  ASSERT_EQ(mesh.notes.size(), 2u);
  EXPECT_EQ(mesh.notes[0].text, "2 faces with fewer than 3 corners left out");
  EXPECT_EQ(mesh.notes[1].text, "not kept: red");
}

TEST(PlyReaderTest, TriangleStripsBecomeTrianglesThatFaceOneWay) {
  std::string text = kSquare;
  text.replace(text.find("element face 2"), 14, "element tristrips 1");
  text.erase(text.find("3 0 1 2\n"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeBytes(text + "4 0 1 3 2\n"));
  ASSERT_EQ(mesh.topology.num_faces(), 2);
  EXPECT_THAT(mesh.topology.face(0), ElementsAre(0, 1, 3));
  EXPECT_THAT(mesh.topology.face(1), ElementsAre(3, 1, 2));
  // -1 begins a new strip; repeated vertices make triangles without area, which are none.
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile two, DecodeBytes(text + "9 0 1 2 -1 0 2 2 3 1\n"));
  ASSERT_EQ(two.topology.num_faces(), 2);
  EXPECT_THAT(two.topology.face(0), ElementsAre(0, 1, 2));
  EXPECT_THAT(two.topology.face(1), ElementsAre(2, 3, 1));
  EXPECT_THAT(DecodeBytes(text + "4 0 1 3 9\n"), HasStatus(kInvalid, HasSubstr("vertex 9")));
  EXPECT_THAT(DecodeBytes(text + "4 0 1 3 -2\n"), HasStatus(kInvalid, HasSubstr("vertex -2")));
  EXPECT_THAT(DecodeBytes(text + "4 0 1 3 2\n", {.max_faces = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit of 1")));
}

TEST(PlyReaderTest, FaultsAreNamed) {
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string text = kAscii;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THAT(DecodeBytes(""), HasStatus(kInvalid, HasSubstr("m.ply: the file is empty")));
  EXPECT_THAT(DecodeBytes("v 0 0 0\n"),
              HasStatus(kInvalid, HasSubstr("m.ply:1: a PLY file begins")));
  EXPECT_THAT(DecodeBytes(replaced("ascii", "text")),
              HasStatus(kInvalid, HasSubstr("m.ply:2: the format")));
  EXPECT_THAT(DecodeBytes(replaced("double y", "real y")),
              HasStatus(kInvalid, HasSubstr("m.ply:7: unknown property type")));
  EXPECT_THAT(DecodeBytes(replaced("float z", "float w")),
              HasStatus(kInvalid, HasSubstr("no scalar property z")));
  EXPECT_THAT(DecodeBytes(replaced("vertex_index", "corners")),
              HasStatus(kInvalid, HasSubstr("no list vertex_indices or vertex_index")));
  EXPECT_THAT(DecodeBytes(replaced("253 1 1", "253 1 one")),
              HasStatus(kInvalid, HasSubstr("m.ply: line 18: cannot read vertex 2, y")));
  EXPECT_THAT(DecodeBytes(replaced("4 0 1 2 3", "4 0 1 2 4")),
              HasStatus(kInvalid, HasSubstr("face 1 names vertex 4")));
  EXPECT_THAT(DecodeBytes(replaced("253 1 1 -2e1", "253 1 1 -2e1 7")),
              HasStatus(kInvalid, HasSubstr("line 18: 5 values where the header declares 4")));
  EXPECT_THAT(DecodeBytes(replaced("253 1 1 -2e1", "253 1 1")),
              HasStatus(kInvalid, HasSubstr("line 18: 3 values where the header declares 4")));
  EXPECT_THAT(
      DecodeBytes(replaced("3 0 1 2 0.5", "3 0 1 2 0.5 1 0")),
      HasStatus(kInvalid, HasSubstr("line 21: more values than the header declares for face 0")));
  EXPECT_THAT(DecodeBytes(replaced("4 0 1 2 3", "4 0 1 -2 3")),
              HasStatus(kInvalid, HasSubstr("face 1")));
  EXPECT_THAT(DecodeBytes(replaced("element vertex 4", "element vertex -4")),
              HasStatus(kInvalid, HasSubstr("m.ply:4")));
  EXPECT_THAT(DecodeBytes(std::string_view(kAscii).substr(0, 100)),
              HasStatus(kInvalid, HasSubstr("end_header")));
}

TEST(PlyReaderTest, CountsBeyondTheBytesOrTheLimitsAreRefusedBeforeAllocation) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3000000\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n0123";
  EXPECT_THAT(DecodeBytes(header), HasStatus(kInvalid, HasSubstr("only 4 bytes follow")));
  EXPECT_THAT(DecodeBytes(header, {.max_vertices = 1000}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit is 1000")));
  // A list that claims four billion entries.
  std::string list =
      "ply\nformat binary_little_endian 1.0\nelement extra 1\nproperty list uint double n\n"
      "end_header\n";
  list.append("\xff\xff\xff\xff", 4);
  EXPECT_THAT(DecodeBytes(list), HasStatus(kInvalid, HasSubstr("length of list n")));
}

TEST(PlyReaderTest, DamagedFilesFailCleanlyOrReadAValidMesh) {
  for (const std::string& bytes : {std::string(kAscii), BinaryPly(false), BinaryPly(true)}) {
    const auto decode = [&](const std::string& damaged) {
      const absl::StatusOr<MeshFile> mesh = DecodeBytes(damaged, {.max_vertices = 1000});
      if (!mesh.ok()) return;
      EXPECT_EQ(mesh->positions.cols(), mesh->topology.num_vertices());
    };
    ForEachTruncation(bytes, decode);
    ForEachCorruption(bytes, decode);
  }
}

}  // namespace
}  // namespace pleat
