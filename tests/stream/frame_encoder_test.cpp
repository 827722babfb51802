#include "pleat/stream/frame_encoder.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "pleat/stream/frame_decoder.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Triangles as sets of rotations, so that order does not matter.
std::multiset<std::vector<int>> TriangleSet(const Topology& topology) {
  std::multiset<std::vector<int>> set;
  for (int f = 0; f < topology.num_triangles(); ++f) {
    std::vector<int> t{topology.triangles()(0, f), topology.triangles()(1, f),
                       topology.triangles()(2, f)};
    if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    set.insert(t);
  }
  return set;
}

double Tolerance(const QuantizationBox& box, const Eigen::Matrix3Xf& positions) {
  return box.step_m() * .5 * 1.001 + 4e-7 * (positions.cwiseAbs().maxCoeff() + box.range_m);
}

struct Case {
  const char* name;
  TestMesh mesh;
};

std::vector<Case> Cases() {
  const TestMesh torus = MakeTorus(24, 12, 3);
  return {{"torus", torus},
          {"isolated vertices", WithExtra(torus, 3, {})},
          {"non-manifold edge",
           WithExtra(torus, 1,
                     {{torus.topology.triangles()(0, 0), torus.topology.triangles()(1, 0), 288}})},
          {"touching vertex", WithExtra(torus, 2, {{5, 288, 289}})},
          {"degenerate triangle", WithExtra(torus, 0, {{7, 7, 9}})},
          {"vertex of a degenerate triangle only", WithExtra(torus, 1, {{288, 288, 9}})},
          {"doubled triangle", WithExtra(torus, 0, {torus.topology.triangles().col(4)})}};
}

TEST(FrameEncoderTest, EveryEncodingKeepsOrderAndHalfAStep) {
  for (const Case& c : Cases()) {
    for (const FrameEncoding encoding :
         {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
      for (const int bits : {8, 12, 20}) {
        for (const int speed : {0, 5, 7, 10}) {
          SCOPED_TRACE(testing::Message() << c.name << " encoding " << static_cast<int>(encoding)
                                          << " bits " << bits << " speed " << speed);
          PLEAT_ASSERT_OK_AND_ASSIGN(
              FrameEncoder encoder,
              FrameEncoder::Create(c.mesh.topology, c.mesh.positions,
                                   {.encoding = encoding, .position_bits = bits, .speed = speed}));
          PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(encoder.header()));
          const QuantizationBox& box = encoder.header().box;
          EXPECT_LE((decoder.reference() - c.mesh.positions).cwiseAbs().maxCoeff(),
                    Tolerance(box, c.mesh.positions));
          EXPECT_EQ(TriangleSet(decoder.topology()), TriangleSet(c.mesh.topology));
          for (const int t : {0, 1, 7}) {
            const Eigen::Matrix3Xf frame = Bend(c.mesh.positions, t);
            PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, encoder.Encode(frame));
            Eigen::Matrix3Xf decoded;
            ASSERT_THAT(decoder.Decode(bytes, &decoded), IsOk());
            ASSERT_EQ(decoded.cols(), frame.cols());
            EXPECT_LE((decoded - frame).cwiseAbs().maxCoeff(), Tolerance(box, frame));
          }
        }
      }
    }
  }
}

TEST(FrameEncoderTest, PositionsOutsideTheBoxAreNotClipped) {
  const TestMesh torus = MakeTorus(24, 12, 3);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    for (const int bits : {8, 12, 20}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(
          FrameEncoder encoder,
          FrameEncoder::Create(torus.topology, torus.positions,
                               {.encoding = encoding, .position_bits = bits}));
      PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(encoder.header()));
      for (const float offset : {-40.f, -3.f, 5.f, 40.f}) {
        const Eigen::Matrix3Xf frame =
            torus.positions.colwise() + Eigen::Vector3f(offset, -offset, offset / 2);
        PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, encoder.Encode(frame));
        Eigen::Matrix3Xf decoded;
        ASSERT_THAT(decoder.Decode(bytes, &decoded), IsOk());
        EXPECT_LE((decoded - frame).cwiseAbs().maxCoeff(),
                  Tolerance(encoder.header().box, frame) * (bits == 20 ? 4 : 1.01))
            << bits << " " << offset;
      }
      const Eigen::Matrix3Xf far = torus.positions.array() + 1000.f;
      EXPECT_THAT(encoder.Encode(far),
                  HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("vertex 0")));
    }
  }
}

TEST(FrameEncoderTest, RefusesWhatIsNotFinite) {
  const TestMesh torus = MakeTorus(8, 6, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameEncoder encoder,
                             FrameEncoder::Create(torus.topology, torus.positions));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Eigen::Matrix3Xf frame = torus.positions;
    frame(1, 17) = bad;
    EXPECT_THAT(encoder.Encode(frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 17")));
    EXPECT_FALSE(FrameEncoder::Create(torus.topology, frame).ok());
  }
  EXPECT_THAT(encoder.Encode(torus.positions), IsOk());  // still usable
}

TEST(FrameEncoderTest, RefusesBadOptions) {
  const TestMesh torus = MakeTorus(8, 6, 1);
  for (const FrameEncoderOptions& options :
       {FrameEncoderOptions{.position_bits = 7}, FrameEncoderOptions{.position_bits = 21},
        FrameEncoderOptions{.speed = 11}, FrameEncoderOptions{.speed = -1},
        FrameEncoderOptions{.box_margin = .5}}) {
    EXPECT_THAT(FrameEncoder::Create(torus.topology, torus.positions, options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("allowed")));
  }
  EXPECT_FALSE(FrameEncoder::Create(torus.topology, Eigen::Matrix3Xf::Zero(3, 5)).ok());
}

TEST(FrameEncoderTest, SameFrameGivesSameBytesInEverySession) {
  const TestMesh torus = MakeTorus(24, 12, 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameEncoder a, FrameEncoder::Create(torus.topology, torus.positions));
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameEncoder b, FrameEncoder::Create(torus.topology, torus.positions));
  EXPECT_EQ(a.header().topology, b.header().topology);
  ASSERT_THAT(b.Encode(Bend(torus.positions, 9)), IsOk());
  EXPECT_EQ(a.Encode(Bend(torus.positions, 2)).value(), b.Encode(Bend(torus.positions, 2)).value());
}

TEST(FrameEncoderTest, CanonicalOrderIsSmallerThanAShuffledOne) {
  const TestMesh torus = MakeTorus(120, 60, 5);
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameEncoder encoder,
                             FrameEncoder::Create(torus.topology, torus.positions));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, encoder.Encode(torus.positions));
  EXPECT_LT(bytes.size(), 3 * 12 / 8 * torus.positions.cols());  // raw 12-bit integers: 4.5
}

}  // namespace
}  // namespace pleat
