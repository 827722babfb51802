#include "pleat/formats/alembic_reader.h"

#include <limits>
#include <string>

#include "formats/alembic_scene.h"
#include "pleat/formats/alembic_writer.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

struct Decoded {
  absl::StatusOr<MeshSequence> sequence = absl::UnknownError("");
  InputReport report;

  const InputNote* Find(const std::string& kind) const {
    for (const InputNote& note : report.notes) {
      if (note.kind == kind) return &note;
    }
    return nullptr;
  }
};

Decoded DecodeBytes(const std::string& bytes, const AlembicOptions& options = {}) {
  Decoded decoded;
  decoded.sequence = DecodeAlembic(bytes, "a.abc", options, {}, &decoded.report);
  return decoded;
}

// One mesh with two samples at those times.
Decoded DecodeTimes(const AlembicTimeSampling& times, const std::string& metadata = "",
                    const AlembicOptions& options = {}) {
  AlembicBuilder builder;
  const uint32_t sampling = builder.AddTimeSampling(times);
  const ObjectToWrite mesh =
      MeshObject(&builder, {.frames = {Square(0), Square(1), Square(2)}, .sampling = sampling});
  return DecodeBytes(builder.Finish({mesh}, metadata), options);
}

TEST(AlembicReaderTest, FrameRatesAreFractions) {
  EXPECT_EQ(DecodeTimes(Uniform(24)).sequence->frame_rate(), (FrameRate{24, 1}));
  EXPECT_EQ(DecodeTimes({1001.0 / 30000, {0}}).sequence->frame_rate(), (FrameRate{30000, 1001}));
  EXPECT_EQ(DecodeTimes({kAcyclicSeconds, {1, 1.04, 1.08}}).sequence->frame_rate(),
            (FrameRate{25, 1}));
  EXPECT_EQ(DecodeTimes(Uniform(24), "", {.frame_rate = FrameRate{7, 2}}).sequence->frame_rate(),
            (FrameRate{7, 2}));
}

TEST(AlembicReaderTest, RatesThatTheArchiveDoesNotSayAreAWarning) {
  const AlembicTimeSampling uneven = {1.0 / 24, {0, 0.01}};
  for (const AlembicTimeSampling& times : {uneven, AlembicTimeSampling{}}) {
    const Decoded decoded = DecodeTimes(times);
    EXPECT_EQ(decoded.sequence->num_frames(), 3);
    EXPECT_EQ(decoded.sequence->frame_rate(), (FrameRate{30, 1}));
    ASSERT_NE(decoded.Find("frame_rate_assumed"), nullptr);
    EXPECT_EQ(decoded.Find("frame_rate_assumed")->severity, NoteSeverity::kWarning);
    EXPECT_EQ(DecodeTimes(times, "_ai_DCC_FPS=25.0").sequence->frame_rate(), (FrameRate{25, 1}));
    const Decoded told = DecodeTimes(times, "", {.frame_rate = FrameRate{12, 1}});
    EXPECT_EQ(told.Find("frame_rate_assumed"), nullptr);
  }
  EXPECT_NE(DecodeTimes(Uniform(24, 0.5)).Find("times_ignored"), nullptr);
  EXPECT_EQ(DecodeTimes(Uniform(24)).Find("times_ignored"), nullptr);
}

TEST(AlembicReaderTest, TransformsAboveAreApplied) {
  AlembicBuilder builder;
  const uint32_t sampling = builder.AddTimeSampling(Uniform(25));
  SceneXform inner = {.name = "inner", .operations = {0x00}, .samples = {{2, 2, 2}}};
  inner.children = {MeshObject(&builder, {.frames = {Square(0), Square(1)}, .sampling = sampling})};
  SceneXform outer = {.name = "outer",
                      .operations = {0x10},
                      .samples = {{10, 0, 0}, {20, 0, 0}},
                      .sampling = sampling};
  outer.children = {XformObject(&builder, inner)};
  const Decoded decoded = DecodeBytes(builder.Finish({XformObject(&builder, outer)}, ""));
  ASSERT_THAT(decoded.sequence, IsOk());
  ASSERT_EQ(decoded.sequence->num_frames(), 2);
  // Vertex 2 is at 1 1 h: doubled first, then moved.
  EXPECT_EQ(decoded.sequence->frame(0).col(2), Eigen::Vector3f(12, 2, 0));
  EXPECT_EQ(decoded.sequence->frame(1).col(2), Eigen::Vector3f(22, 2, 2));
}

TEST(AlembicReaderTest, TransformsAtOtherTimesAreInterpolated) {
  AlembicBuilder builder;
  const uint32_t frames = builder.AddTimeSampling(Uniform(2));
  const uint32_t seconds = builder.AddTimeSampling(Uniform(1));
  SceneXform xform = {.operations = {0x10}, .samples = {{0, 0, 0}, {8, 0, 0}}, .sampling = seconds};
  xform.children = {
      MeshObject(&builder, {.frames = {Square(0), Square(1), Square(2)}, .sampling = frames})};
  const Decoded decoded = DecodeBytes(builder.Finish({XformObject(&builder, xform)}, ""));
  ASSERT_THAT(decoded.sequence, IsOk());
  EXPECT_EQ(decoded.sequence->frame(1).col(0), Eigen::Vector3f(4, 0, 1));
  EXPECT_NE(decoded.Find("transforms_between_samples"), nullptr);
}

TEST(AlembicReaderTest, AStillMeshMovesWithItsTransform) {
  AlembicBuilder builder;
  const uint32_t sampling = builder.AddTimeSampling(Uniform(10));
  SceneXform xform = {.operations = {0x10},
                      .samples = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {3, 0, 0}},
                      .sampling = sampling};
  xform.children = {MeshObject(&builder, {.frames = {Square(0)}})};
  const Decoded decoded = DecodeBytes(builder.Finish({XformObject(&builder, xform)}, ""));
  ASSERT_THAT(decoded.sequence, IsOk());
  ASSERT_EQ(decoded.sequence->num_frames(), 4);
  EXPECT_EQ(decoded.sequence->frame_rate(), (FrameRate{10, 1}));
  EXPECT_EQ(decoded.sequence->frame(3).col(0), Eigen::Vector3f(3, 0, 0));
  // Equal samples are one frame in memory.
  EXPECT_EQ(&decoded.sequence->frame(1), &decoded.sequence->frame(2));
}

TEST(AlembicReaderTest, FramesThatRepeatShareMemory) {
  AlembicBuilder builder;
  const ObjectToWrite mesh =
      MeshObject(&builder, {.frames = {Square(0), Square(1), Square(0), Square(1), Square(1)}});
  const Decoded decoded = DecodeBytes(builder.Finish({mesh}, ""));
  ASSERT_EQ(decoded.sequence->num_frames(), 5);
  EXPECT_EQ(&decoded.sequence->frame(0), &decoded.sequence->frame(2));
  EXPECT_EQ(&decoded.sequence->frame(1), &decoded.sequence->frame(4));
  EXPECT_NE(&decoded.sequence->frame(0), &decoded.sequence->frame(1));
}

TEST(AlembicReaderTest, MeshesAreJoinedWithTheirAppearance) {
  AlembicBuilder builder;
  SceneMesh plain = {.name = "plain", .frames = {Square(0), Square(1)}};
  SceneMesh painted = {.name = "painted", .frames = {Square(5), Square(6)}};
  PropertyToWrite uv =
      ArrayProperty<float>(&builder, "uv", AlembicType::kFloat32, 2, {{0, 0, 1, 0, 1, 1, 0, 1}});
  painted.more = {uv};
  painted.children = {FaceSetObject(&builder, "skin", {{0}})};
  SceneMesh other = {.name = "other", .frames = {Square(7), Square(8)}, .more = {uv}};
  other.children = {FaceSetObject(&builder, "skin", {{0}})};
  const Decoded decoded = DecodeBytes(builder.Finish(
      {MeshObject(&builder, plain), MeshObject(&builder, painted), MeshObject(&builder, other)},
      ""));
  ASSERT_THAT(decoded.sequence, IsOk());
  EXPECT_EQ(decoded.sequence->num_vertices(), 12);
  EXPECT_THAT(decoded.sequence->topology().corner_vertices(),
              ElementsAre(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8));
  EXPECT_EQ(decoded.sequence->frame(1)(2, 4), 6);
  const MeshAppearance& appearance = decoded.sequence->appearance();
  EXPECT_THAT(appearance.corner_texcoords, ElementsAre(-1, -1, -1, -1, 3, 2, 1, 0, 7, 6, 5, 4));
  EXPECT_THAT(appearance.material_names, ElementsAre("skin"));
  EXPECT_THAT(appearance.face_materials, ElementsAre(-1, 0, 0));
}

TEST(AlembicReaderTest, FaultsNameFileObjectAndFrame) {
  AlembicBuilder changing, bad;
  const ObjectToWrite mesh = MeshObject(
      &changing,
      {.name = "m", .frames = {Square(0), Square(1)}, .indices = {{0, 1, 2, 3}, {0, 2, 1, 3}}});
  EXPECT_THAT(DecodeBytes(changing.Finish({mesh}, "")).sequence,
              HasStatus(kInvalid, HasSubstr("a.abc: '/m': the topology changes: frame 1")));
  std::vector<float> infinite = Square(1);
  infinite[4] = std::numeric_limits<float>::infinity();
  const ObjectToWrite second =
      MeshObject(&bad, {.name = "m", .frames = {Square(0), Square(0), Square(2), infinite}});
  EXPECT_THAT(DecodeBytes(bad.Finish({second}, "")).sequence,
              HasStatus(kInvalid, HasSubstr("frame 3, vertex 1")));
  EXPECT_THAT(DecodeBytes("").sequence, HasStatus(kInvalid, HasSubstr("empty")));
  EXPECT_THAT(DecodeBytes("\x89HDF\r\n\x1a\n").sequence,
              HasStatus(kInvalid, AllOf(HasSubstr("HDF5"), HasSubstr("toOgawa"))));
}

TEST(AlembicReaderTest, LimitsAreChecked) {
  AlembicBuilder builder;
  const std::string bytes =
      builder.Finish({MeshObject(&builder, {.frames = {Square(0), Square(1), Square(2)}})}, "");
  for (const MeshLimits& limits : {MeshLimits{.max_vertices = 3}, MeshLimits{.max_frames = 2},
                                   MeshLimits{.max_sequence_bytes = 3 * 48 - 1}}) {
    EXPECT_THAT(DecodeBytes(bytes, {.limits = limits}).sequence,
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
  }
}

TEST(AlembicReaderTest, TransformsCountToo) {
  AlembicBuilder builder;
  SceneXform xform = {.operations = {0x10}, .samples = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}};
  xform.children = {MeshObject(&builder, {.frames = {Square(0)}})};
  const std::string bytes = builder.Finish({XformObject(&builder, xform)}, "");
  EXPECT_THAT(DecodeBytes(bytes, {.limits = {.max_sequence_bytes = 3 * 128}}).sequence, IsOk());
  EXPECT_THAT(DecodeBytes(bytes, {.limits = {.max_sequence_bytes = 3 * 128 - 1}}).sequence,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("1 transforms at 3")));
}

// Millions of samples in one header, all the same: nothing of that size may be allocated.
TEST(AlembicReaderTest, SamplesThatAreOnlyClaimedAreRefused) {
  AlembicBuilder builder;
  PropertyToWrite points =
      ArrayProperty<float>(&builder, "P", AlembicType::kFloat32, 3, {Square(0)});
  points.samples.assign(3'000'000, points.samples[0]);
  ObjectToWrite mesh = MeshObject(&builder, {.frames = {Square(0)}});
  mesh.properties[0].properties[0] = points;
  const std::string bytes = builder.Finish({mesh}, "");
  EXPECT_LT(bytes.size(), 2000u);
  EXPECT_THAT(DecodeBytes(bytes).sequence,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("3000000 samples")));
}

// One archive with everything in it, damaged in every byte.
std::string EverythingArchive() {
  AlembicBuilder builder;
  const uint32_t cyclic = builder.AddTimeSampling({0.5, {0, 0.1}});
  const uint32_t acyclic = builder.AddTimeSampling({kAcyclicSeconds, {0, 0.1, 0.5}});
  PropertyToWrite uv = {.name = "uv", .metadata = "geoScope=fvr"};
  uv.properties = {
      ArrayProperty<float>(&builder, ".vals", AlembicType::kFloat32, 2, {{0, 0, 1, 1}}),
      ArrayProperty<uint32_t>(&builder, ".indices", AlembicType::kUint32, 1, {{0, 1, 0, 1}})};
  SceneMesh mesh = {.schema = std::string(kSubdivisionSchema),
                    .frames = {Square(0), Square(1), Square(1)},
                    .sampling = acyclic,
                    .more = {uv},
                    .children = {FaceSetObject(&builder, "skin", {{0}})}};
  SceneXform xform = {.operations = {0x20, 0x30},
                      .samples = {{1, 0, 0, 30, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1},
                                  {1, 0, 0, 60, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 4, 1}},
                      .sampling = cyclic,
                      .children = {MeshObject(&builder, std::move(mesh))}};
  return builder.Finish({XformObject(&builder, std::move(xform))}, "_ai_DCC_FPS=24");
}

TEST(AlembicReaderTest, DamagedArchivesFailCleanlyOrAreValid) {
  const std::string whole = EverythingArchive();
  ASSERT_THAT(DecodeBytes(whole).sequence, IsOk());
  ForEachTruncation(whole, [](const std::string& damaged) {
    EXPECT_FALSE(DecodeBytes(damaged).sequence.ok()) << damaged.size();
  });
  int num_read = 0;
  ForEachCorruption(whole, [&](const std::string& damaged) {
    const Decoded decoded = DecodeBytes(damaged);
    if (!decoded.sequence.ok()) return;
    ++num_read;
    EXPECT_GT(decoded.sequence->num_vertices(), 0);
    EXPECT_LE(decoded.sequence->num_vertices(), 1000);
  });
  EXPECT_GT(num_read, 0);
}

TEST(AlembicReaderTest, BytesBehindTheArchiveDoNotMatter) {
  EXPECT_THAT(DecodeBytes(EverythingArchive() + std::string(100, 'x')).sequence, IsOk());
}

}  // namespace
}  // namespace pleat
