#include "pleat/formats/pc2.h"

#include <cassert>
#include <span>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/bytes.h"
#include "pleat/base/file.h"
#include "pleat/base/file_parts.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr std::string_view kPc2Magic("POINTCACHE2\0", 12);

struct Pc2Header {
  int32_t num_vertices = 0, num_frames = 0;
  float start_frame = 0, sample_rate = 1;
};

absl::StatusOr<Pc2Header> ReadPc2Header(ByteReader* reader) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view magic, reader->ReadRaw(kPc2Magic.size(), "magic"));
  if (magic != kPc2Magic) {
    return absl::InvalidArgumentError("not a PointCache2 file: it does not begin with POINTCACHE2");
  }
  Pc2Header header;
  PLEAT_ASSIGN_OR_RETURN(const int32_t version, reader->Read<int32_t>("version"));
  if (version != 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("PointCache2 version ", version, ", only 1 is known"));
  }
  PLEAT_ASSIGN_OR_RETURN(header.num_vertices, reader->Read<int32_t>("vertex count"));
  PLEAT_ASSIGN_OR_RETURN(header.start_frame, reader->Read<float>("start frame"));
  PLEAT_ASSIGN_OR_RETURN(header.sample_rate, reader->Read<float>("sample rate"));
  PLEAT_ASSIGN_OR_RETURN(header.num_frames, reader->Read<int32_t>("frame count"));
  if (header.num_vertices <= 0 || header.num_frames <= 0) {
    return absl::InvalidArgumentError(absl::StrCat("the header declares ", header.num_vertices,
                                                   " vertices and ", header.num_frames,
                                                   " frames; both must be positive"));
  }
  return header;
}

absl::Status CheckSizes(const Pc2Header& header, uint64_t remaining_bytes,
                        const MeshLimits& limits) {
  const MeshCounts counts = {.num_vertices = header.num_vertices, .num_frames = header.num_frames};
  PLEAT_RETURN_IF_ERROR(CheckSequenceCounts(counts, limits));
  const uint64_t total_bytes = counts.position_bytes();
  const uint64_t frame_bytes = total_bytes / static_cast<uint64_t>(header.num_frames);
  if (remaining_bytes != total_bytes) {
    return absl::DataLossError(absl::StrCat(
        "the header declares ", header.num_frames, " frames of ", header.num_vertices,
        " vertices (", total_bytes, " bytes of positions) but ", remaining_bytes,
        " bytes follow, that is ", remaining_bytes / frame_bytes, " whole frames; ",
        remaining_bytes < total_bytes ? "the file is cut off" : "the counts are wrong"));
  }
  return absl::OkStatus();
}

absl::StatusOr<PointCache> DecodePc2(std::string_view bytes, const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError("the file is empty");
  if (const std::string other = DescribeForeignBytes(bytes); !other.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("this is ", other));
  }
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const Pc2Header header, ReadPc2Header(&reader));
  PLEAT_RETURN_IF_ERROR(CheckSizes(header, reader.remaining(), limits));
  PointCache cache;
  cache.start_frame = header.start_frame;
  cache.sample_rate = header.sample_rate;
  cache.frames.reserve(static_cast<size_t>(header.num_frames));
  for (int t = 0; t < header.num_frames; ++t) {
    Eigen::Matrix3Xf& frame = cache.frames.emplace_back(3, header.num_vertices);
    PLEAT_RETURN_IF_ERROR(
        reader.ReadArray(std::span(frame.data(), static_cast<size_t>(frame.size())), "positions"));
  }
  return cache;
}

std::string EncodePc2Header(const PointCache& cache) {
  assert(!cache.frames.empty());
  ByteWriter writer;
  writer.WriteRaw(kPc2Magic);
  writer.Write<int32_t>(1);
  writer.Write(static_cast<int32_t>(cache.frames[0].cols()));
  writer.Write(cache.start_frame);
  writer.Write(cache.sample_rate);
  writer.Write(static_cast<int32_t>(cache.frames.size()));
  return writer.bytes();  // gcc 12 takes a short string that is moved for one without an end
}

// Views of the header and of each frame.
std::vector<std::string_view> PartsOf(const std::string& header, const PointCache& cache) {
  std::vector<std::string_view> parts = {header};
  for (const Eigen::Matrix3Xf& frame : cache.frames) {
    assert(frame.cols() == cache.frames[0].cols());
    parts.emplace_back(reinterpret_cast<const char*>(frame.data()),
                       static_cast<size_t>(frame.size()) * sizeof(float));
  }
  return parts;
}

}  // namespace

absl::StatusOr<PointCache> DecodePointCache(std::string_view bytes, const std::string& file,
                                            const MeshLimits& limits) {
  return WithContext(file, DecodePc2(bytes, limits));
}

absl::StatusOr<PointCache> ReadPointCache(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  return DecodePointCache(bytes, path, limits);
}

std::string EncodePointCache(const PointCache& cache) {
  const std::string header = EncodePc2Header(cache);
  const std::vector<std::string_view> parts = PartsOf(header, cache);
  std::string bytes;
  bytes.reserve(header.size() + (parts.size() - 1) * parts[1].size());
  for (const std::string_view part : parts) bytes.append(part);
  return bytes;
}

absl::Status WritePointCache(const std::string& path, const PointCache& cache) {
  const std::string header = EncodePc2Header(cache);
  return WriteFileParts(path, PartsOf(header, cache));
}

}  // namespace pleat
