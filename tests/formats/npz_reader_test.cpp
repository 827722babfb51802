#include "npy_array.h"
#include "pleat/formats/npz.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "zip_archive.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<float>& TwoFramesOfFour() {
  static const std::vector<float>& values = *new std::vector<float>(2 * 4 * 3, 0.5f);
  return values;
}

// An archive of positions of 2 frames of 4 vertices and the arrays in `more`.
std::string ArchiveWith(const std::vector<std::pair<std::string, std::string>>& more,
                        bool deflates = false) {
  ZipWriter zip({.deflates = deflates});
  zip.Add("positions.npy", EncodeNpyFloats(TwoFramesOfFour(), {2, 4, 3}));
  for (const auto& [name, array] : more) zip.Add(name + ".npy", array);
  return zip.Finish();
}

std::string Integers(const std::vector<int32_t>& values, const std::vector<int64_t>& shape) {
  return EncodeNpyIntegers(values, shape);
}

TEST(NpzReaderTest, TablesOfFacesMayEndInMinusOne) {
  const std::string bytes =
      ArchiveWith({{"faces", Integers({0, 1, 2, 3, 0, 1, 2, -1, 1, 2, -1, -1}, {3, 4})}});
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpzContents contents, DecodeNpz(bytes, "a.npz"));
  ASSERT_TRUE(contents.topology);
  EXPECT_EQ(contents.topology->num_faces(), 2);
  EXPECT_THAT(contents.topology->face(0), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(contents.topology->face(1), ElementsAre(0, 1, 2));
  ASSERT_EQ(contents.notes.size(), 1u);
  EXPECT_EQ(contents.notes[0].kind, "faces_left_out");
}

TEST(NpzReaderTest, FacesMayBeAListWithSizes) {
  const std::string corners = Integers({0, 1, 2, 0, 1, 2, 3}, {7});
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const NpzContents contents,
      DecodeNpz(ArchiveWith({{"faces", corners}, {"face_sizes", Integers({3, 4}, {2})}}), "a"));
  EXPECT_EQ(contents.topology->num_faces(), 2);
  EXPECT_THAT(DecodeNpz(ArchiveWith({{"faces", corners}}), "a"),
              HasStatus(kInvalid, HasSubstr("face_sizes")));
  EXPECT_THAT(
      DecodeNpz(ArchiveWith({{"faces", corners}, {"face_sizes", Integers({3, 5}, {2})}}), "a"),
      HasStatus(kInvalid, HasSubstr("faces")));
}

TEST(NpzReaderTest, FramesRatesInAllForms) {
  const auto rate_of = [](const std::string& name, const std::string& array) {
    const absl::StatusOr<NpzContents> contents = DecodeNpz(ArchiveWith({{name, array}}), "a");
    EXPECT_THAT(contents, IsOk());
    return contents->frame_rate;
  };
  EXPECT_EQ(rate_of("frame_rate", Integers({30000, 1001}, {2})), (FrameRate{30000, 1001}));
  EXPECT_EQ(rate_of("fps", Integers({25}, {})), (FrameRate{25, 1}));
  EXPECT_EQ(rate_of("mocap_framerate", EncodeNpyFloats(std::vector<float>{29.97f}, {})),
            (FrameRate{2997, 100}));
  EXPECT_EQ(rate_of("fps", EncodeNpyFloats(std::vector<float>{-1}, {})), std::nullopt);
  EXPECT_EQ(rate_of("fps", EncodeNpyTexts({"fast"})), std::nullopt);
  EXPECT_EQ(rate_of("frame_rate", Integers({30, 0}, {2})), std::nullopt);
}

TEST(NpzReaderTest, KeysAreTheUsers) {
  NpzKeys keys;
  ASSERT_THAT(SetNpzKey("positions=b", &keys), IsOk());
  ASSERT_THAT(SetNpzKey("faces=tri=angles", &keys), IsOk());
  EXPECT_EQ(keys.faces, "tri=angles");
  EXPECT_THAT(SetNpzKey("colors=x", &keys), HasStatus(kInvalid, HasSubstr("positions, faces")));
  EXPECT_THAT(SetNpzKey("faces", &keys), HasStatus(kInvalid, HasSubstr("ROLE=NAME")));
  const std::string bytes =
      ArchiveWith({{"b", EncodeNpyFloats(std::vector<float>(12, 7.f), {1, 4, 3})}}, true);
  PLEAT_ASSERT_OK_AND_ASSIGN(const NpzContents contents,
                             DecodeNpz(bytes, "a.npz", {.positions = "b"}));
  EXPECT_EQ(contents.frames[0](0, 0), 7);
}

TEST(NpzReaderTest, WhatIsWrongIsNamed) {
  const auto expect = [](const std::string& bytes, const std::string& message) {
    EXPECT_THAT(DecodeNpz(bytes, "a.npz"),
                HasStatus(kInvalid, AllOf(HasSubstr("a.npz"), HasSubstr(message))));
  };
  expect("", "empty");
  expect("hello", "neither");
  expect("glTF....", "GLB");
  expect(EncodeNpyFloats(std::vector<float>(8), {2, 4}), "float32 (2, 4)");
  expect(EncodeNpyIntegers(std::vector<int32_t>(12), {4, 3}), "int32 (4, 3)");
  expect(NpyHeader("<f4", {int64_t{1} << 40, 0, 3}), "which is nothing");
  expect(ArchiveWith({{"faces", Integers({0, 1, 4}, {1, 3})}}), "faces");
  expect(ArchiveWith({{"faces", Integers({1, 2, 3, 2, 3, 4}, {2, 3})}}), "from 1");
  expect(ArchiveWith({{"faces", EncodeNpyTexts({"x"})}}), "text");
  expect(ArchiveWith({{"faces", Integers({0, 1, 2}, {1, 3})}, {"name", Integers({1}, {1})}}),
         "must be text");
  ZipWriter zip;
  zip.Add("x.npy", EncodeNpyTexts({"x"}));
  expect(zip.Finish(), "--key positions=NAME");
  EXPECT_THAT(DecodeNpz(ArchiveWith({}), "a", {}, {.max_sequence_bytes = 40}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
}

TEST(NpzReaderTest, DamagedArchivesFailCleanly) {
  for (const bool deflates : {false, true}) {
    const std::string bytes = ArchiveWith(
        {{"faces", Integers({0, 1, 2, 3}, {1, 4})}, {"x", EncodeNpyTexts({"x"})}}, deflates);
    ForEachTruncation(bytes, [](const std::string& damaged) {
      EXPECT_FALSE(DecodeNpz(damaged, "a.npz").ok()) << damaged.size();
    });
    ForEachCorruption(bytes, [](const std::string& damaged) {
      const absl::StatusOr<NpzContents> contents = DecodeNpz(damaged, "a.npz");
      if (contents.ok()) {
        EXPECT_EQ(contents->frames[0].cols(), 4);
      }
    });
  }
}

}  // namespace
}  // namespace pleat
