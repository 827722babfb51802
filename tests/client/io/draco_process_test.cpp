#include "cli/io/draco_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstring>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/base/file.h"
#include "pleat/stream/frame_encoder.h"
#include "support/hostile_bytes.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kSmallMemory = uint64_t{192} << 20;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMemoryIsLimited = false;  // draco_child/main.cpp
#else
constexpr bool kMemoryIsLimited = true;
#endif

uint64_t OwnPeakBytes() {
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

std::string Varint(uint32_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}

std::string Header(int minor, int type, int method) {
  const char fields[] = {
      2, static_cast<char>(minor), static_cast<char>(type), static_cast<char>(method), 0, 0};
  return "DRACO" + std::string(fields, sizeof fields);
}

// Counts at the limits, and hardly a byte behind them.
std::vector<std::pair<std::string, std::string>> Bombs() {
  const std::string tail(40, '\x01');
  std::string edgebreaker = Header(2, 1, 1) + std::string(1, '\0') + Varint(4'000'000) +
                            Varint(8'000'000) + std::string(1, '\0') + Varint(8'000'000) +
                            Varint(0) + Varint(0) + Varint(0);
  std::string cloud = Header(3, 0, 0);
  const int32_t num_points = 4'000'000;
  cloud.append(reinterpret_cast<const char*>(&num_points), 4);
  const char attributes[] = {1, 1, 0, 9, 16, 0, 0};  // one decoder, one attribute of 16 float32
  cloud.append(attributes, sizeof attributes);
  return {{"edgebreaker", edgebreaker + tail},
          {"valence", Header(2, 1, 1) + '\x02' + edgebreaker.substr(12) + tail},
          {"sequential", Header(2, 1, 0) + Varint(8'000'000) + Varint(4'000'000) + tail},
          {"cloud", cloud + tail},
          {"kd-tree", Header(3, 0, 1) + cloud.substr(11) + tail}};
}

class DracoProcessTest : public testing::Test {
 protected:
  absl::StatusOr<DracoGeometry> Decode(const std::string& bytes,
                                       const DracoProcessOptions& options = {}) {
    const std::string path = folder_.File("x.drc");
    EXPECT_THAT(WriteFile(path, bytes), IsOk());
    return DecodeDracoInChild(path, {}, options, &usage_);
  }

  TemporaryFolder folder_;
  DracoProcessUsage usage_;
};

TEST_F(DracoProcessTest, GivesWhatWasEncoded) {
  const MeshSequence sequence = MovingTetrahedron(1);
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        FrameEncoder encoder,
        FrameEncoder::Create(sequence.topology(), sequence.frame(0), {.encoding = encoding}));
    PLEAT_ASSERT_OK_AND_ASSIGN(const DracoGeometry geometry,
                               Decode(encoder.Encode(sequence.frame(0)).value()));
    const bool is_mesh = encoding == FrameEncoding::kDracoMesh;
    const std::vector<int32_t>& vertices =
        is_mesh ? geometry.vertex_numbers : encoder.header().vertex_order;
    ASSERT_EQ(vertices.size(), 4u);
    for (int i = 0; i < 4; ++i) {
      EXPECT_LE((geometry.positions.col(i) - sequence.frame(0).col(vertices[i])).norm(),
                encoder.header().box.step_m());
    }
    EXPECT_EQ(geometry.triangles.cols(), is_mesh ? 4 : 0);
    EXPECT_GT(usage_.peak_memory_bytes, 1u << 20);
  }
}

TEST_F(DracoProcessTest, DamageIsNamedAndNeverMore) {
  const MeshSequence sequence = MovingTetrahedron(1);
  FrameEncoder encoder = FrameEncoder::Create(sequence.topology(), sequence.frame(0),
                                              {.encoding = FrameEncoding::kDracoMesh})
                             .value();
  const std::string good = encoder.Encode(sequence.frame(0)).value();
  for (size_t length = 0; length < good.size(); length += 3) {
    const auto cut = Decode(good.substr(0, length));
    EXPECT_THAT(cut, HasStatus(absl::StatusCode::kDataLoss, HasSubstr("x.drc: "))) << length;
  }
  for (size_t i = 0; i < good.size(); i += 2) {
    std::string damaged = good;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    const absl::Status status = Decode(damaged).status();
    EXPECT_TRUE(status.ok() || absl::IsDataLoss(status) || absl::IsResourceExhausted(status))
        << status;
  }
  EXPECT_THAT(DecodeDracoInChild(folder_.File("none.drc")),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("none.drc")));
}

TEST_F(DracoProcessTest, HeadersOverTheLimitsAreRefusedFirst) {
  const std::string tail(40, '\0');
  for (const std::string& bytes :
       {Header(2, 1, 1) + std::string(1, '\0') + Varint(4'000'001) + Varint(1) + tail,
        Header(2, 1, 0) + Varint(8'000'001) + Varint(3) + tail,
        Header(3, 0, 0) + std::string("\xff\xff\xff\x7f", 4) + tail}) {
    EXPECT_THAT(Decode(bytes),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("the limit is")));
    if (kMemoryIsLimited) {  // a sanitizer needs memory of its own
      EXPECT_LT(usage_.peak_memory_bytes, uint64_t{40} << 20);
    }
  }
}

TEST_F(DracoProcessTest, BombsStayBelowTheMemoryLimit) {
  if (!kMemoryIsLimited) GTEST_SKIP() << "sanitizers reserve terabytes of addresses";
  const uint64_t before = OwnPeakBytes();
  uint64_t largest_unlimited = 0;
  for (const auto& [name, bytes] : Bombs()) {
    EXPECT_LT(bytes.size(), 100u);
    DracoProcessOptions options;
    options.cpu_seconds = 5;
    options.memory_bytes = uint64_t{4} << 30;
    EXPECT_FALSE(Decode(bytes, options).ok()) << name;
    largest_unlimited = std::max(largest_unlimited, usage_.peak_memory_bytes);
    options.memory_bytes = kSmallMemory;
    const absl::Status status = Decode(bytes, options).status();
    EXPECT_TRUE(absl::IsDataLoss(status) || absl::IsResourceExhausted(status)) << name << status;
    EXPECT_LE(usage_.peak_memory_bytes, kSmallMemory) << name;
  }
  EXPECT_GT(largest_unlimited, kSmallMemory);  // the limit was needed
  EXPECT_LT(OwnPeakBytes() - before, uint64_t{32} << 20);
}

TEST_F(DracoProcessTest, TimeIsLimitedAndCancellationActsAtOnce) {
  const std::string path = folder_.File("x.drc");
  ASSERT_THAT(WriteFile(path, Bombs()[0].second), IsOk());
  EXPECT_THAT(DecodeDracoInChild(path, {}, {.wall_seconds = 0}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more than 0 s")));
  EXPECT_THAT(DecodeDracoInChild(path, Progress({}, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

TEST_F(DracoProcessTest, AFolderOfDracoMeshesIsASequence) {
  const MeshSequence sequence = MovingTetrahedron(3);
  FrameEncoder encoder = FrameEncoder::Create(sequence.topology(), sequence.frame(0),
                                              {.encoding = FrameEncoding::kDracoMesh})
                             .value();
  for (int t = 0; t < 3; ++t) {
    ASSERT_THAT(WriteFile(folder_.File("take_" + std::to_string(8 + t) + ".drc"),
                          encoder.Encode(sequence.frame(t)).value()),
                IsOk());
  }
  for (const std::string& input : {folder_.path(), folder_.File("take_*.drc")}) {
    const Outcome outcome = RunPleat({"inspect", input, "--json"});
    EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("\"num_frames\": 3"));
    EXPECT_THAT(outcome.out, HasSubstr("\"num_vertices\": 4"));
  }
  ASSERT_THAT(WriteFile(folder_.File("take_11.drc"), Bombs()[3].second), IsOk());
  const Outcome outcome = RunPleat({"inspect", folder_.path()});
  EXPECT_NE(outcome.code, ExitCode::kOk);
  EXPECT_THAT(outcome.err, HasSubstr("take_11.drc"));
}

}  // namespace
}  // namespace pleat
