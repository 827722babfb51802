// The layout is that of LightWave's Motion Designer, as Blender, Maya and Houdini read and write it
// (docs/formats/mdd.md).
#include "pleat/formats/mdd.h"

#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr size_t kMddHeaderBytes = 8;

uint32_t ReverseBytes(uint32_t value) {
  return value >> 24 | (value >> 8 & 0xff00) | (value << 8 & 0xff0000) | value << 24;
}

// Copies 32-bit numbers and turns the bytes of each around. The two may not overlap.
void CopyReversed(const char* from, char* to, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    uint32_t value;
    std::memcpy(&value, from + 4 * i, 4);
    value = ReverseBytes(value);
    std::memcpy(to + 4 * i, &value, 4);
  }
}

struct MddCounts {
  int32_t num_frames = 0, num_vertices = 0;

  uint64_t frame_bytes() const { return uint64_t{12} * static_cast<uint32_t>(num_vertices); }
  // Times and positions: all that follows the header.
  uint64_t body_bytes() const { return static_cast<uint64_t>(num_frames) * (4 + frame_bytes()); }
};

// The counts of the first 8 bytes, in either order of bytes.
MddCounts CountsOf(std::string_view bytes, bool is_little_endian) {
  uint32_t values[2];
  std::memcpy(values, bytes.data(), sizeof(values));
  for (uint32_t& value : values) {
    if (!is_little_endian) value = ReverseBytes(value);
  }
  return {static_cast<int32_t>(values[0]), static_cast<int32_t>(values[1])};
}

bool IsWholeFile(const MddCounts& counts, size_t file_bytes) {
  return counts.num_frames > 0 && counts.num_vertices > 0 &&
         counts.body_bytes() == file_bytes - kMddHeaderBytes;
}

absl::StatusOr<MddCounts> ReadMddHeader(std::string_view bytes, const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError("the file is empty");
  if (const std::string other = DescribeForeignBytes(bytes); !other.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("this is ", other));
  }
  if (bytes.size() < kMddHeaderBytes) {
    return absl::DataLossError(absl::StrCat("the file ends inside its header of ", kMddHeaderBytes,
                                            " bytes, at byte ", bytes.size()));
  }
  const MddCounts counts = CountsOf(bytes, false);
  if (IsWholeFile(counts, bytes.size())) {
    PLEAT_RETURN_IF_ERROR(CheckSequenceCounts(
        {.num_vertices = counts.num_vertices, .num_frames = counts.num_frames}, limits));
    return counts;
  }
  if (IsWholeFile(CountsOf(bytes, true), bytes.size())) {
    return absl::InvalidArgumentError(
        "the bytes of its numbers are in the wrong order (little-endian); MDD is big-endian, so no "
        "program reads this: write it again with another exporter");
  }
  if (counts.num_frames <= 0 || counts.num_vertices <= 0) {
    return absl::InvalidArgumentError(absl::StrCat("the header declares ", counts.num_frames,
                                                   " frames and ", counts.num_vertices,
                                                   " vertices; both must be positive"));
  }
  PLEAT_RETURN_IF_ERROR(CheckSequenceCounts(
      {.num_vertices = counts.num_vertices, .num_frames = counts.num_frames}, limits));
  const uint64_t follow = bytes.size() - kMddHeaderBytes;
  const uint64_t times = uint64_t{4} * static_cast<uint32_t>(counts.num_frames);
  return absl::DataLossError(absl::StrCat(
      "the header declares ", counts.num_frames, " frames of ", counts.num_vertices, " vertices (",
      counts.body_bytes(), " bytes of times and positions) but ", follow, " bytes follow, that is ",
      follow < times ? 0 : (follow - times) / counts.frame_bytes(), " whole frames; ",
      follow < counts.body_bytes() ? "the file is cut off" : "the counts are wrong"));
}

absl::StatusOr<MddCache> DecodeBytes(std::string_view bytes, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const MddCounts counts, ReadMddHeader(bytes, limits));
  const auto num_frames = static_cast<size_t>(counts.num_frames);
  const char* at = bytes.data() + kMddHeaderBytes;
  MddCache cache;
  cache.times_s.resize(num_frames);
  CopyReversed(at, reinterpret_cast<char*>(cache.times_s.data()), num_frames);
  at += 4 * num_frames;
  cache.frames.reserve(num_frames);
  for (size_t t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf& frame = cache.frames.emplace_back(3, counts.num_vertices);
    CopyReversed(at, reinterpret_cast<char*>(frame.data()), static_cast<size_t>(frame.size()));
    at += counts.frame_bytes();
  }
  return cache;
}

}  // namespace

absl::StatusOr<MddCache> DecodeMdd(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits) {
  return WithContext(file, DecodeBytes(bytes, limits));
}

absl::StatusOr<MddCache> ReadMdd(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  return DecodeMdd(bytes, path, limits);
}

std::string EncodeMdd(const MddCache& cache) {
  assert(!cache.frames.empty() && cache.times_s.size() == cache.frames.size());
  const MddCounts counts = {static_cast<int32_t>(cache.frames.size()),
                            static_cast<int32_t>(cache.frames[0].cols())};
  std::string bytes(kMddHeaderBytes + counts.body_bytes(), '\0');
  char* at = bytes.data();
  CopyReversed(reinterpret_cast<const char*>(&counts), at, 2);
  at += kMddHeaderBytes;
  CopyReversed(reinterpret_cast<const char*>(cache.times_s.data()), at, cache.times_s.size());
  at += 4 * cache.times_s.size();
  for (const Eigen::Matrix3Xf& frame : cache.frames) {
    assert(frame.cols() == counts.num_vertices);
    CopyReversed(reinterpret_cast<const char*>(frame.data()), at,
                 static_cast<size_t>(frame.size()));
    at += counts.frame_bytes();
  }
  return bytes;
}

absl::Status WriteMdd(const std::string& path, const MddCache& cache) {
  return WriteFile(path, EncodeMdd(cache));
}

}  // namespace pleat
