// The archives beside the checkout, where there are any: written by the reference library, by other
// programs, and damaged ones. expected.json says what the reference library reads from them.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "pleat/base/file.h"
#include "pleat/formats/alembic_reader.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using nlohmann::json;

json ExpectedArchives() {
  const std::optional<std::string> path = FindSharedData("abc/expected.json");
  return path ? json::parse(ReadFile(*path).value()) : json();
}

// The numbers of the file have seven digits.
void ExpectVertex(const json& truth, const Eigen::Vector3f& position, const std::string& where) {
  for (int i = 0; i < 3; ++i) {
    const double value = truth[static_cast<size_t>(i)];
    EXPECT_NEAR(position(i), value, 1e-6 * std::max(1.0, std::abs(value))) << where;
  }
}

void ExpectMesh(const json& truth, const std::string& path) {
  const std::string object = truth["path"];
  const std::string where = path + " " + object;
  ReadSequenceOptions options;
  options.object = object;
  const absl::StatusOr<MeshSequence> sequence = ReadSequence(path, options);
  const json& first = truth["samples"][0];
  std::set<std::pair<int, int>> counts;
  for (const json& sample : truth["samples"]) {
    counts.emplace(sample["num_vertices"], sample["num_faces"]);
  }
  if (first["num_vertices"] == 0) {
    EXPECT_THAT(sequence, HasStatus(kInvalid, testing::HasSubstr("no vertices"))) << where;
    return;
  }
  if (truth["topology"] == "heterogeneous") {
    ASSERT_GT(counts.size(), 1u) << where;
    EXPECT_THAT(sequence, HasStatus(kInvalid, testing::HasSubstr("the topology changes: frame ")));
    return;
  }
  ASSERT_THAT(sequence, IsOk()) << where;
  EXPECT_EQ(sequence->num_vertices(), first["num_vertices"]) << where;
  EXPECT_EQ(sequence->topology().num_faces(), first["num_faces"]) << where;
  // A mesh that only its transforms move has the frames of these.
  if (truth["num_samples"] != 1) {
    EXPECT_EQ(sequence->num_frames(), truth["num_samples"]) << where;
  }
  for (const json& sample : truth["samples"]) {
    const int t = sample["i"];
    if (t >= sequence->num_frames()) continue;
    ExpectVertex(sample["first_world"], sequence->frame(t).leftCols<1>(), where);
    ExpectVertex(sample["last_world"], sequence->frame(t).rightCols<1>(), where);
  }
}

TEST(AlembicArchivesTest, GiveWhatTheReferenceLibraryReads) {
  PLEAT_SHARED_DATA_OR_SKIP(folder, "abc");
  int num_meshes = 0;
  const json expected = ExpectedArchives();
  for (const auto& [name, truth] : expected.items()) {
    const std::string path = folder + "/" + name;
    if (truth.is_object()) {
      EXPECT_THAT(ReadSequence(path), HasStatus(kInvalid, testing::HasSubstr("HDF5"))) << name;
      continue;
    }
    if (truth.empty()) {
      EXPECT_THAT(ReadSequence(path),
                  HasStatus(absl::StatusCode::kNotFound, testing::HasSubstr("no mesh")))
          << name;
    }
    for (const json& mesh : truth) {
      ExpectMesh(mesh, path);
      ++num_meshes;
    }
  }
  EXPECT_GE(num_meshes, 18);
}

TEST(AlembicArchivesTest, PositionsAreThoseOfThePointCachesBitByBit) {
  for (const char* name : {"horse_uv_acyclic", "rumba_subd_repeats", "samba_xform_cm",
                           "static_mesh_animated_xforms"}) {
    PLEAT_SHARED_DATA_OR_SKIP(archive, std::string("abc/") + name + ".abc");
    PLEAT_SHARED_DATA_OR_SKIP(cache, std::string("abc/") + name + ".pc2");
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(archive));
    PLEAT_ASSERT_OK_AND_ASSIGN(const PointCache truth, ReadPointCache(cache));
    ASSERT_EQ(sequence.num_frames(), static_cast<int>(truth.frames.size())) << name;
    for (int t = 0; t < sequence.num_frames(); ++t) {
      const Eigen::Matrix3Xf& frame = sequence.frame(t);
      ASSERT_EQ(frame.cols(), truth.frames[t].cols());
      EXPECT_EQ(std::memcmp(frame.data(), truth.frames[t].data(),
                            static_cast<size_t>(frame.size()) * sizeof(float)),
                0)
          << name << " " << t;
    }
  }
}

// The faces of the archive run clockwise; turned, they are those of the OBJ that it was made from.
TEST(AlembicArchivesTest, FacesAreThoseOfTheMeshTheyWereMadeFrom) {
  for (const auto& [archive_name, mesh_name] :
       {std::pair("abc/horse_uv_acyclic.abc", "horse_gallop.obj"),
        std::pair("abc/samba_shutter_cyclic.abc", "samba.obj"),
        std::pair("abc/rumba_subd_repeats.abc", "rumba.obj")}) {
    PLEAT_SHARED_DATA_OR_SKIP(archive, archive_name);
    PLEAT_SHARED_DATA_OR_SKIP(mesh, mesh_name);
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(archive));
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence truth, ReadSequence(mesh));
    EXPECT_EQ(sequence.topology(), truth.topology()) << archive_name;
  }
}

TEST(AlembicArchivesTest, MaterialsAndTexcoordsAreRead) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "abc/horse_uv_acyclic.abc");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(path));
  const MeshAppearance& appearance = sequence.appearance();
  EXPECT_THAT(appearance.material_names, testing::ElementsAre("front", "back"));
  EXPECT_THAT(std::vector<int32_t>(appearance.face_materials.begin(),
                                   appearance.face_materials.begin() + 4),
              testing::ElementsAre(0, 1, 0, 1));
  EXPECT_EQ(appearance.texcoords.size(), 8431u);
  // There is one for each vertex, with its number.
  EXPECT_EQ(appearance.corner_texcoords, sequence.topology().corner_vertices());
}

TEST(AlembicArchivesTest, WhatIsWrittenComesBack) {
  PLEAT_SHARED_DATA_OR_SKIP(folder, "abc");
  int num_written = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".abc") continue;
    const absl::StatusOr<MeshSequence> sequence = ReadSequence(entry.path().string());
    if (!sequence.ok()) continue;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const MeshSequence back,
        DecodeAlembic(EncodeAlembic(*sequence), "back.abc",
                      {.name = sequence->name(), .frame_rate = sequence->frame_rate()}));
    EXPECT_EQ(EncodeSequence(back), EncodeSequence(*sequence)) << entry.path();
    ++num_written;
  }
  EXPECT_GE(num_written, 10);
}

TEST(AlembicArchivesTest, DamagedArchivesFailCleanlyOrAreRead) {
  PLEAT_SHARED_DATA_OR_SKIP(folder, "abc/hostile");
  int num_files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++num_files;
    const std::string path = entry.path().string();
    const absl::StatusOr<MeshSequence> sequence = ReadSequence(path);
    if (sequence.ok()) continue;
    EXPECT_THAT(std::string(sequence.status().message()),
                testing::HasSubstr(entry.path().filename().string()));
  }
  EXPECT_EQ(num_files, 45);
}

}  // namespace
}  // namespace pleat
