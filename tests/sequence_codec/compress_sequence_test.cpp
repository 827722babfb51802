#include "pleat/sequence_codec/compress_sequence.h"

#include <gtest/gtest.h>

#include "pleat/sequence_codec/sequence_decoder.h"
#include "sequence_codec/compressed_clip.h"
#include "support/hostile_bytes.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

MeshSequence Decoded(const std::string& bytes) {
  return SequenceDecoder::Open(bytes)->DecodeAll().value();
}

double LargestErrorMm(const MeshSequence& a, const MeshSequence& b) {
  double largest = 0;
  for (int t = 0; t < a.num_frames(); ++t) {
    const Eigen::Matrix3Xd difference = a.FrameAsDouble(t) - b.FrameAsDouble(t);
    largest = std::max(largest, difference.colwise().norm().maxCoeff());
  }
  return 1e3 * largest;
}

double KgPercent(const MeshSequence& truth, const MeshSequence& other) {
  double error = 0, spread = 0;
  for (int t = 0; t < truth.num_frames(); ++t) {
    const Eigen::Matrix3Xd frame = truth.FrameAsDouble(t);
    const Eigen::Vector3d center = frame.rowwise().mean();
    error += (frame - other.FrameAsDouble(t)).squaredNorm();
    spread += (frame.colwise() - center).squaredNorm();
  }
  return 100 * std::sqrt(error / spread);
}

TEST(CompressSequenceTest, TheLargestErrorIsPromisedForEveryVertex) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 40);
  for (const double bound_mm : {0.05, 1.0, 20.0}) {
    CompressSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               CompressSequence(sequence, {.max_error_mm = bound_mm}, &summary));
    const MeshSequence decoded = Decoded(bytes);
    EXPECT_LE(LargestErrorMm(sequence, decoded), bound_mm);
    EXPECT_NEAR(summary.max_error_mm, LargestErrorMm(sequence, decoded), 1e-9);
    EXPECT_NEAR(summary.kg_percent, KgPercent(sequence, decoded), 1e-9);
    EXPECT_EQ(summary.num_bytes, bytes.size());
    EXPECT_NEAR(summary.bpvf, 8.0 * static_cast<double>(bytes.size()) / (24 * 12 * 40), 1e-12);
    EXPECT_TRUE(decoded.topology() == sequence.topology());
    EXPECT_EQ(decoded.frame_rate(), sequence.frame_rate());
    EXPECT_EQ(decoded.name(), sequence.name());
  }
}

TEST(CompressSequenceTest, TheKgErrorIsReachedAndNotMissedByMuch) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 40);
  size_t last_size = 0;
  for (const double kg_percent : {5.0, 1.0, 0.2}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const std::string bytes,
        CompressSequence(sequence, {.goal = CompressionGoal::kKg, .kg_percent = kg_percent},
                         nullptr));
    const double reached = KgPercent(sequence, Decoded(bytes));
    EXPECT_LE(reached, kg_percent);
    EXPECT_GT(reached, 0.7 * kg_percent);
    EXPECT_GT(bytes.size(), last_size);
    last_size = bytes.size();
  }
}

TEST(CompressSequenceTest, AGridIsExact) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 20);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string bytes,
      CompressSequence(sequence, {.goal = CompressionGoal::kGrid, .grid_bits = 10}, nullptr));
  SequenceDecoder decoder = SequenceDecoder::Open(bytes).value();
  const double step_mm = decoder.promise().grid_step_mm;
  const MeshSequence decoded = decoder.DecodeAll().value();
  Eigen::Vector3d low = sequence.FrameAsDouble(0).col(0);
  for (int t = 0; t < sequence.num_frames(); ++t) {
    low = low.cwiseMin(sequence.FrameAsDouble(t).rowwise().minCoeff());
  }
  for (int t = 0; t < sequence.num_frames(); ++t) {
    for (int v = 0; v < sequence.num_vertices(); ++v) {
      for (int c = 0; c < 3; ++c) {
        const double truth = (sequence.FrameAsDouble(t)(c, v) - low[c]) / (step_mm / 1e3);
        const double found = (decoded.FrameAsDouble(t)(c, v) - low[c]) / (step_mm / 1e3);
        ASSERT_NEAR(found, std::floor(truth + 0.5), 1e-3);
      }
    }
  }
}

TEST(CompressSequenceTest, SmallerThanHalfOfItsNoiseFreeGridIntegers) {
  const MeshSequence sequence = MakeWavingTorus(40, 20, 60, 0);
  CompressSummary summary;
  ASSERT_THAT(CompressSequence(sequence, {.max_error_mm = 1}, &summary), IsOk());
  EXPECT_LT(summary.bpvf_without_topology, 1.5);  // 96 as float32
}

TEST(CompressSequenceTest, ThreadsDoNotChangeTheFile) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 40);
  CompressOptions options{.max_error_mm = 0.5, .num_threads = 1};
  const std::string one = CompressSequence(sequence, options, nullptr).value();
  options.num_threads = 3;
  EXPECT_EQ(CompressSequence(sequence, options, nullptr).value(), one);
}

TEST(CompressSequenceTest, LongSequencesAreCutIntoSegments) {
  const MeshSequence sequence = MakeWavingTorus(6, 5, 530);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             CompressSequence(sequence, {.max_error_mm = 2}, nullptr));
  EXPECT_LE(LargestErrorMm(sequence, Decoded(bytes)), 2);
}

TEST(CompressSequenceTest, OddSequencesKeepThePromise) {
  const TestMesh torus = MakeTorus(8, 6, 3);
  const TestMesh lonely = WithExtra(torus, 3, {{0, 1, 20}, {0, 1, 21}, {0, 1, 22}});
  const Topology point = *Topology::Create(1, {}, {});
  const std::vector<MeshSequence> odd = {
      *MeshSequence::Create(torus.topology, {torus.positions}),                   // one frame
      *MeshSequence::Create(torus.topology, {torus.positions, torus.positions}),  // no motion
      *MeshSequence::Create(lonely.topology, {lonely.positions, 2 * lonely.positions}),  // unclean
      *MeshSequence::Create(point, {Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6)}),
      *MeshSequence::Create(torus.topology, {Eigen::Matrix3Xf::Zero(3, 48)}),
  };
  for (const MeshSequence& sequence : odd) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               CompressSequence(sequence, {.max_error_mm = 1}, nullptr));
    EXPECT_LE(LargestErrorMm(sequence, Decoded(bytes)), 1);
    EXPECT_TRUE(Decoded(bytes).topology() == sequence.topology());
  }
}

TEST(CompressSequenceTest, AppearanceIsKept) {
  MeshSequenceOptions options;
  options.appearance = {
      {{0, 0}, {1, 0.5f}}, {0, 1, -1, 0, 1, 1, 0}, {"skin", ""}, {1, -1}, "a.mtl"};
  Eigen::Matrix3Xf frame(3, 4);
  frame << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0.25f;
  const MeshSequence sequence = *MeshSequence::Create(
      *Topology::Create(4, {0, 1, 2, 3, 0, 2, 3}, {4, 3}), {frame, frame * 2}, options);
  const MeshSequence decoded = Decoded(CompressSequence(sequence, {}, nullptr).value());
  EXPECT_EQ(decoded.appearance().texcoords, sequence.appearance().texcoords);
  EXPECT_EQ(decoded.appearance().corner_texcoords, sequence.appearance().corner_texcoords);
  EXPECT_EQ(decoded.appearance().material_names, sequence.appearance().material_names);
  EXPECT_EQ(decoded.appearance().face_materials, sequence.appearance().face_materials);
  EXPECT_EQ(decoded.appearance().material_library, "a.mtl");
}

// Corners of one face from its lowest vertex on, each with its texture coordinate, then the
// material.
std::vector<std::vector<float>> FaceTexts(const MeshSequence& sequence) {
  const Topology& topology = sequence.topology();
  const MeshAppearance& appearance = sequence.appearance();
  std::vector<std::vector<float>> faces;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto face = topology.face(f);
    const auto lowest = std::min_element(face.begin(), face.end()) - face.begin();
    std::vector<float> text{static_cast<float>(appearance.face_materials[f])};
    for (size_t i = 0; i < face.size(); ++i) {
      const size_t corner = (i + static_cast<size_t>(lowest)) % face.size();
      text.push_back(static_cast<float>(face[corner]));
      const size_t at = static_cast<size_t>(topology.face_start(f)) + corner;
      text.push_back(static_cast<float>(appearance.corner_texcoords[at]));
    }
    faces.push_back(text);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

TEST(CompressSequenceTest, FacesInAnyOrderAreTheSameFacesForLess) {
  const TestMesh mesh = MakeTorus(24, 12, 5);
  Random random(2);
  MeshSequenceOptions options;
  options.appearance.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  options.appearance.material_names = {"a", "b"};
  for (int i = 0; i < mesh.topology.num_corners(); ++i) {
    options.appearance.corner_texcoords.push_back(random.UniformInt(3));
  }
  std::vector<int32_t> corners, sizes;  // the torus with its faces shuffled
  std::vector<int> order(mesh.topology.num_faces());
  for (int f = 0; f < mesh.topology.num_faces(); ++f) order[f] = f;
  for (int f = mesh.topology.num_faces() - 1; f > 0; --f) {
    std::swap(order[f], order[random.UniformInt(f + 1)]);
  }
  for (const int f : order) {
    const auto face = mesh.topology.face(f);
    corners.insert(corners.end(), face.begin(), face.end());
    sizes.push_back(static_cast<int32_t>(face.size()));
    options.appearance.face_materials.push_back(random.UniformInt(2));
  }
  const MeshSequence sequence =
      *MeshSequence::Create(*Topology::Create(mesh.topology.num_vertices(), corners, sizes),
                            {mesh.positions, Bend(mesh.positions, 1)}, options);
  CompressSummary kept, any;
  ASSERT_THAT(CompressSequence(sequence, {}, &kept), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             CompressSequence(sequence, {.keep_face_order = false}, &any));
  const MeshSequence decoded = Decoded(bytes);
  EXPECT_LE(LargestErrorMm(sequence, decoded), 1);
  EXPECT_EQ(FaceTexts(decoded), FaceTexts(sequence));
  EXPECT_LT(any.num_topology_bytes + 280, kept.num_topology_bytes);  // a byte per face
}

TEST(CompressSequenceTest, RefusesWhatItCannotPromise) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 4);
  EXPECT_THAT(CompressSequence(sequence, {.max_error_mm = 1e-9}, nullptr),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("max_error_mm")));
  EXPECT_THAT(
      CompressSequence(sequence, {.goal = CompressionGoal::kGrid, .grid_bits = 40}, nullptr),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("grid_bits")));
  const Topology point = *Topology::Create(1, {}, {});
  EXPECT_THAT(CompressSequence(*MeshSequence::Create(point, {Eigen::Vector3f(1, 2, 3)}),
                               {.goal = CompressionGoal::kKg}, nullptr),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("extent")));
  Eigen::Matrix3Xf far = sequence.frame(0) * 1e5f;
  EXPECT_THAT(CompressSequence(*MeshSequence::Create(sequence.topology(), {far}),
                               {.max_error_mm = 1e-2}, nullptr),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("float32")));
}

TEST(CompressSequenceTest, CanBeCancelled) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 20);
  const Progress cancelled({}, [] { return true; });
  EXPECT_THAT(CompressSequence(sequence, {}, nullptr, cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

MeshSequence MovedBy(const MeshSequence& sequence, const Eigen::Vector3f& offset) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    frames.emplace_back(sequence.frame(t).colwise() + offset);
  }
  return MeshSequence::Create(sequence.topology(), frames, {.name = sequence.name()}).value();
}

TEST(CompressSequenceTest, PromisesHoldFarFromTheOrigin) {
  const MeshSequence near = MakeWavingTorus(24, 12, 40);
  for (const float distance : {1e3f, 3e4f, 1e6f}) {
    const MeshSequence far = MovedBy(near, {distance, 0, -distance});
    for (const double kg_percent : {1.0, .01}) {
      CompressSummary summary;
      PLEAT_ASSERT_OK_AND_ASSIGN(
          const std::string bytes,
          CompressSequence(far, {.goal = CompressionGoal::kKg, .kg_percent = kg_percent},
                           &summary));
      EXPECT_LE(KgPercent(far, Decoded(bytes)), kg_percent) << distance;
    }
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const std::string exact,
        CompressSequence(far, {.goal = CompressionGoal::kGrid, .grid_bits = 16}, nullptr));
    EXPECT_LT(LargestErrorMm(far, Decoded(exact)), 1e3 * 2e-7 * distance + .1) << distance;
  }
}

TEST(CompressSequenceTest, AStillShapeFarAwayHasAnOriginInItsFile) {
  const MeshShape box = MakeBox({.25, .5, 1});
  const Eigen::Matrix3Xf frame =
      box.positions.cast<float>().colwise() + Eigen::Vector3f(1 << 20, 1 << 19, .375f);
  const MeshSequence still = MeshSequence::Create(box.topology, {frame, frame, frame}).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string bytes,
      CompressSequence(still, {.goal = CompressionGoal::kKg, .kg_percent = .01}, nullptr));
  EXPECT_LE(KgPercent(still, Decoded(bytes)), .01);
  ForEachCorruption(bytes, [](const std::string& damaged) {
    absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(damaged);
    if (decoder.ok()) (void)decoder->DecodeAll().ok();
  });
}

}  // namespace
}  // namespace pleat
