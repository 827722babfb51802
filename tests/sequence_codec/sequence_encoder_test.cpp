#include "sequence_encoder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/sequence_codec/sequence_decoder.h"
#include "sequence_codec/compressed_clip.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

const ResidualGrid kNoResiduals;

SequenceEncoder MakeEncoder(const MeshSequence& sequence, bool keep_face_order = true,
                            int num_threads = 1) {
  return SequenceEncoder(sequence, AnalyzeSequence(sequence, num_threads, {}).value(),
                         Eigen::Vector3d::Zero(), keep_face_order, num_threads);
}

MeshSequence Decode(const std::string& bytes) {
  return SequenceDecoder::Open(bytes).value().DecodeAll().value();
}

double RmsError(const MeshSequence& a, const MeshSequence& b) {
  double square = 0;
  for (int t = 0; t < a.num_frames(); ++t) {
    square += (a.FrameAsDouble(t) - b.FrameAsDouble(t)).squaredNorm();
  }
  return std::sqrt(square / (3.0 * a.num_frames() * a.num_vertices()));
}

TEST(SequenceEncoderTest, FinerStepsCostMoreBytesAndMoreComponentsAndErrLess) {
  const MeshSequence sequence = MakeWavingTorus(12, 8, 40);
  const SequenceEncoder encoder = MakeEncoder(sequence);
  size_t last_size = 0;
  double last_error = 1e9;
  int last_count = -1;
  for (const double step_m : {.1, .02, .004, .0008}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, encoder.Encode(step_m, kNoResiduals, {}));
    const double error = RmsError(Decode(bytes), sequence);
    const int count = encoder.NumComponents(encoder.analysis().segments[0], step_m);
    EXPECT_GT(bytes.size(), last_size) << step_m;
    EXPECT_LT(error, last_error) << step_m;
    EXPECT_GE(count, last_count) << step_m;
    EXPECT_LT(error, step_m);
    last_size = bytes.size();
    last_error = error;
    last_count = count;
  }
}

TEST(SequenceEncoderTest, EncodingAgainAndWithMoreThreadsGivesTheSameBytes) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 40);
  const SequenceEncoder encoder = MakeEncoder(sequence);
  const std::string bytes = encoder.Encode(.01, kNoResiduals, {}).value();
  EXPECT_EQ(encoder.Encode(.01, kNoResiduals, {}).value(), bytes);
  EXPECT_EQ(MakeEncoder(sequence, true, 3).Encode(.01, kNoResiduals, {}).value(), bytes);
}

TEST(SequenceEncoderTest, WhatIsNoMotionComesBackAsItWas) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 5);
  const MeshSequence decoded = Decode(MakeEncoder(sequence).Encode(.01, kNoResiduals, {}).value());
  EXPECT_EQ(decoded.name(), "waving torus");
  EXPECT_EQ(decoded.frame_rate(), (FrameRate{24000, 1001}));
  EXPECT_TRUE(decoded.topology() == sequence.topology());
}

// A face as the list of its vertices from the smallest on, with the material that it has.
std::vector<std::vector<int>> FaceSet(const MeshSequence& sequence) {
  std::vector<std::vector<int>> faces;
  for (int f = 0; f < sequence.topology().num_faces(); ++f) {
    const auto face = sequence.topology().face(f);
    std::vector<int> corners(face.begin(), face.end());
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    corners.push_back(sequence.appearance().face_materials[f]);
    faces.push_back(corners);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

TEST(SequenceEncoderTest, FacesInAnotherOrderKeepTheirMaterialsAndAreSmaller) {
  const MeshSequence plain = MakeWavingTorus(20, 12, 2);
  MeshSequenceOptions options;
  options.appearance.material_names = {"a", "b"};
  for (int f = 0; f < plain.topology().num_faces(); ++f) {
    options.appearance.face_materials.push_back(f * 7 % 13 % 2);
  }
  const MeshSequence sequence =
      MeshSequence::Create(plain.topology(), {plain.frame(0), plain.frame(1)}, options).value();
  const SequenceEncoder kept = MakeEncoder(sequence, true), free = MakeEncoder(sequence, false);
  EXPECT_LT(free.topology_bytes(), kept.topology_bytes());
  const MeshSequence decoded = Decode(free.Encode(.01, kNoResiduals, {}).value());
  EXPECT_FALSE(decoded.topology() == sequence.topology());
  EXPECT_EQ(FaceSet(decoded), FaceSet(sequence));
}

TEST(SequenceEncoderTest, FilesThatAreListedAsModeledAreCodedAsAList) {
  const Topology quads = QuadsAsModeled(12, 12);
  const MeshSequence sequence =
      MeshSequence::Create(quads, {Eigen::Matrix3Xf::Random(3, quads.num_vertices())}).value();
  const SequenceEncoder encoder = MakeEncoder(sequence);
  EXPECT_LT(encoder.topology_bytes(), 120u);
  EXPECT_TRUE(Decode(encoder.Encode(.01, kNoResiduals, {}).value()).topology() == quads);
}

TEST(SequenceEncoderTest, ProgressGrowsToOneAndCancellationIsHeard) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 40);
  const SequenceEncoder encoder = MakeEncoder(sequence);
  double last = 0;
  const Progress watched(
      [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last);
        last = update.fraction;
      },
      nullptr);
  ASSERT_THAT(encoder.Encode(.01, kNoResiduals, watched), IsOk());
  EXPECT_EQ(last, 1);
  EXPECT_THAT(encoder.Encode(.01, kNoResiduals, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::HasSubstr("cancelled")));
}

}  // namespace
}  // namespace pleat
