#include "pleat/stream/frame_decoder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <new>

#include "absl/strings/match.h"
#include "pleat/base/random.h"
#include "pleat/stream/frame_encoder.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PLEAT_SANITIZED 1
#endif

namespace pleat {
namespace {

using ::testing::HasSubstr;

struct Stream {
  StreamHeader header;
  std::string frame;
};

Stream MakeStream(FrameEncoding encoding, const TestMesh& mesh, int speed = 5) {
  FrameEncoder encoder =
      FrameEncoder::Create(mesh.topology, mesh.positions, {.encoding = encoding, .speed = speed})
          .value();
  std::string frame = encoder.Encode(Bend(mesh.positions, 1)).value();
  return {encoder.header(), std::move(frame)};
}

// Runs `body` in a child with `megabytes` of address space beyond what is in use and a limit of
// `seconds`; true when it ends by itself.
template <typename Body>
bool EndsWithinLimits(int megabytes, int seconds, Body body) {
  const pid_t child = fork();
  if (child == 0) {
#ifndef PLEAT_SANITIZED
    FILE* file = fopen("/proc/self/statm", "r");
    unsigned long pages = 0;
    if (file == nullptr || fscanf(file, "%lu", &pages) != 1) _exit(3);
    const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) +
                         static_cast<rlim_t>(megabytes) * 1'000'000;
    const rlimit memory{bytes, bytes};
    if (setrlimit(RLIMIT_AS, &memory) != 0) _exit(4);
#else
    (void)megabytes;
#endif
    std::set_new_handler([] { _exit(7); });  // the decoder itself would report bad_alloc
    alarm(static_cast<unsigned>(seconds));
    body();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(FrameDecoderTest, EveryTruncationIsRefused) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    const Stream stream = MakeStream(encoding, torus);
    PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(stream.header));
    Eigen::Matrix3Xf positions;
    for (size_t size = 0; size < stream.frame.size(); ++size) {
      // The last bytes hold the grid, so every cut loses something.
      EXPECT_THAT(decoder.Decode(stream.frame.substr(0, size), &positions),
                  HasStatus(absl::StatusCode::kDataLoss, testing::_))
          << size;
    }
    EXPECT_THAT(decoder.Decode(stream.frame, &positions), IsOk());
  }
}

TEST(FrameDecoderTest, CorruptedBytesStayWithinMemoryAndTime) {
  const TestMesh torus = MakeTorus(16, 12, 2);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    for (const int speed : {0, 5, 10}) {
      const Stream stream = MakeStream(encoding, torus, speed);
      EXPECT_TRUE(EndsWithinLimits(100, 20,
                                   [&] {
                                     FrameDecoder decoder =
                                         FrameDecoder::Create(stream.header).value();
                                     Random random(11);
                                     Eigen::Matrix3Xf positions;
                                     for (int round = 0; round < 3000; ++round) {
                                       std::string bytes = stream.frame;
                                       const int num_changes = 1 + random.UniformInt(4);
                                       for (int change = 0; change < num_changes; ++change) {
                                         // Half of the changes hit the headers, where the counts
                                         // are.
                                         const size_t limit =
                                             random.UniformInt(2) == 0 ? 60 : bytes.size();
                                         bytes[random.UniformInt(static_cast<int>(limit))] =
                                             static_cast<char>(random.NextBits());
                                       }
                                       if (decoder.Decode(bytes, &positions).ok() &&
                                           (positions.cols() != 192 || !positions.allFinite())) {
                                         _exit(5);
                                       }
                                     }
                                   }))
          << static_cast<int>(encoding) << " speed " << speed;
    }
  }
}

// Counts of two thousand million points in a few bytes: what made plain Draco reach 22 GB.
TEST(FrameDecoderTest, HugeCountsAreRefusedBeforeDracoSeesThem) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  const Stream cloud = MakeStream(FrameEncoding::kDracoPointCloud, torus);
  const Stream mesh = MakeStream(FrameEncoding::kDracoMesh, torus);
  EXPECT_TRUE(EndsWithinLimits(50, 5, [&] {
    Eigen::Matrix3Xf positions;
    FrameDecoder cloud_decoder = FrameDecoder::Create(cloud.header).value();
    std::string bytes = cloud.frame;
    bytes.replace(11, 4, std::string("\xff\xff\xff\x7f", 4));
    const absl::Status points = cloud_decoder.Decode(bytes, &positions);
    if (!absl::StrContains(points.message(), "2147483647 points")) _exit(5);
    FrameDecoder mesh_decoder = FrameDecoder::Create(mesh.header).value();
    bytes = mesh.frame.substr(0, 12) + "\xff\xff\xff\xff\x07\xff\xff\xff\xff\x07" +
            std::string(64, '\1');
    if (mesh_decoder.Decode(bytes, &positions).ok()) _exit(6);
  }));
}

TEST(FrameDecoderTest, HostileHeadersAreRefused) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  const StreamHeader good = MakeStream(FrameEncoding::kDracoPointCloud, torus).header;
  ASSERT_THAT(FrameDecoder::Create(good), IsOk());

  StreamHeader bad = good;
  bad.num_vertices = 2'000'000'000;
  EXPECT_THAT(FrameDecoder::Create(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("limit")));
  bad = good;
  bad.num_vertices = -1;
  EXPECT_FALSE(FrameDecoder::Create(bad).ok());
  bad = good;
  bad.num_triangles = 2'000'000'000;
  EXPECT_THAT(FrameDecoder::Create(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("limit")));
  bad = good;
  bad.vertex_order[3] = bad.vertex_order[4];
  EXPECT_THAT(FrameDecoder::Create(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("permutation")));
  bad = good;
  bad.vertex_order.pop_back();
  EXPECT_FALSE(FrameDecoder::Create(bad).ok());
  bad = good;
  bad.box.range_m = 0;
  EXPECT_FALSE(FrameDecoder::Create(bad).ok());
  bad = good;
  bad.topology.clear();
  EXPECT_FALSE(FrameDecoder::Create(bad).ok());
  bad = good;
  bad.num_triangles -= 1;
  EXPECT_THAT(FrameDecoder::Create(bad),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("declared")));
}

TEST(FrameDecoderTest, FramesOfTheOtherKindAreRefused) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  const Stream cloud = MakeStream(FrameEncoding::kDracoPointCloud, torus);
  const Stream mesh = MakeStream(FrameEncoding::kDracoMesh, torus);
  Eigen::Matrix3Xf positions;
  EXPECT_FALSE(FrameDecoder::Create(cloud.header)->Decode(mesh.frame, &positions).ok());
  EXPECT_FALSE(FrameDecoder::Create(mesh.header)->Decode(cloud.frame, &positions).ok());
  const Stream other = MakeStream(FrameEncoding::kDracoPointCloud, MakeTorus(10, 9, 2));
  EXPECT_FALSE(FrameDecoder::Create(cloud.header)->Decode(other.frame, &positions).ok());
}

}  // namespace
}  // namespace pleat
