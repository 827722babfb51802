// Frames to Draco bytes and back: time and bytes per frame, on a made-up performer and, when it is
// on this machine, on the captured samba sequence.
#include <benchmark/benchmark.h>

#include <optional>

#include "pleat/formats/sequence_reader.h"
#include "pleat/performer/performer.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/stream/frame_encoder.h"
#include "support/shared_data.h"

namespace pleat {
namespace {

const std::optional<MeshSequence>& Performer10k() {
  static const std::optional<MeshSequence> sequence =
      GeneratePerformer({.num_frames = 10, .num_vertices = 10'000, .frame_rate = {30, 1}})
          ->sequence;
  return sequence;
}

std::optional<MeshSequence> ReadShared(const char* name) {
  const std::optional<std::string> path = FindSharedData(name);
  return path ? std::optional(ReadSequence(*path).value()) : std::nullopt;
}

const std::optional<MeshSequence>& Samba() {
  static const std::optional<MeshSequence> sequence = ReadShared("samba.pc2");
  return sequence;
}

const std::optional<MeshSequence>& Crane() {
  static const std::optional<MeshSequence> sequence = ReadShared("crane.pc2");
  return sequence;
}

using Source = const std::optional<MeshSequence>& (*)();

void Codec(benchmark::State& state, Source source, FrameEncoding encoding, bool decode) {
  if (!source()) {
    state.SkipWithError("the captured sequence is not on this machine");
    return;
  }
  const MeshSequence& sequence = *source();
  const int speed = static_cast<int>(state.range(0));
  FrameEncoder encoder = FrameEncoder::Create(sequence.topology(), sequence.frame(0),
                                              {.encoding = encoding, .speed = speed})
                             .value();
  FrameDecoder decoder = FrameDecoder::Create(encoder.header()).value();
  std::vector<std::string> frames;
  std::vector<FrameMark> marks;
  size_t num_bytes = 0;  // of the frames that are no key frames of a stream of differences
  int num_counted = 0;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    frames.push_back(encoder.Encode(sequence.frame(t)).value());
    marks.push_back(encoder.mark());
    if (encoding == FrameEncoding::kDracoDelta && marks.back().keyframe) continue;
    num_bytes += frames.back().size();
    ++num_counted;
  }
  Eigen::Matrix3Xf positions;
  int t = sequence.num_frames() - 1;
  for (auto _ : state) {
    t = (t + 1) % sequence.num_frames();
    if (decode) {
      benchmark::DoNotOptimize(decoder.Decode(frames[t], marks[t], &positions));
    } else {
      benchmark::DoNotOptimize(encoder.Encode(sequence.frame(t)));
    }
  }
  state.counters["bytes_per_frame"] = static_cast<double>(num_bytes) / num_counted;
  state.counters["key_bytes"] = static_cast<double>(frames[0].size());
  state.counters["header_bytes"] = static_cast<double>(encoder.header().topology.size());
}

#define PLEAT_CODEC_BENCH(source, encoding)                                                        \
  BENCHMARK_CAPTURE(Codec, source##_##encoding##_encode, source, FrameEncoding::k##encoding,       \
                    false)                                                                         \
      ->Arg(0)                                                                                     \
      ->Arg(5)                                                                                     \
      ->Arg(10)                                                                                    \
      ->Unit(benchmark::kMillisecond);                                                             \
  BENCHMARK_CAPTURE(Codec, source##_##encoding##_decode, source, FrameEncoding::k##encoding, true) \
      ->Arg(5)                                                                                     \
      ->Unit(benchmark::kMillisecond)

PLEAT_CODEC_BENCH(Performer10k, DracoMesh);
PLEAT_CODEC_BENCH(Performer10k, DracoPointCloud);
PLEAT_CODEC_BENCH(Samba, DracoMesh);
PLEAT_CODEC_BENCH(Samba, DracoPointCloud);
PLEAT_CODEC_BENCH(Crane, DracoPointCloud);
PLEAT_CODEC_BENCH(Performer10k, DracoDelta);
PLEAT_CODEC_BENCH(Samba, DracoDelta);
PLEAT_CODEC_BENCH(Crane, DracoDelta);

}  // namespace
}  // namespace pleat
