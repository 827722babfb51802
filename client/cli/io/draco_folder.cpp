#include "cli/io/draco_folder.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/io/draco_process.h"
#include "cli/verbs/content_flag.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/stream/frame_decoder.h"

namespace pleat {
namespace {

constexpr char kSchema[] = "pleat.drc/1";
constexpr uint64_t kMaxHeaderBytes = uint64_t{1} << 28;
constexpr int kMaxFolderFrames = 1'000'000;

std::string FramePath(const std::string& folder, int t) {
  return absl::StrFormat("%s/frame_%04d.drc", folder, t);
}

nlohmann::ordered_json HeaderJson(const StreamHeader& header, FrameRate frame_rate,
                                  int num_frames) {
  nlohmann::ordered_json json;
  json["schema"] = kSchema;
  json["encoding"] = header.encoding == FrameEncoding::kDracoMesh ? "mesh" : "points";
  json["num_frames"] = num_frames;
  json["fps_numerator"] = frame_rate.numerator;
  json["fps_denominator"] = frame_rate.denominator;
  json["num_vertices"] = header.num_vertices;
  json["num_points"] = header.num_points;
  json["num_triangles"] = header.num_triangles;
  json["box"] = {
      {"origin_m", {header.box.origin_m.x(), header.box.origin_m.y(), header.box.origin_m.z()}},
      {"range_m", header.box.range_m},
      {"bits", header.box.bits},
      {"step_m", header.box.step_m()}};
  json["vertex_order"] = header.vertex_order;
  if (header.content != StreamContent::kMesh) {
    json["content"] = StreamContentName(header.content);
    json["control_vertices"] = header.control_vertices;
  }
  return json;
}

bool RemoveIfThere(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::remove(path, ignored);
}

struct DracoFolder {
  StreamHeader header;
  FrameRate frame_rate;
  int num_frames = 0;
};

// Reads stream.json. A folder may come from anywhere, so its header is as hostile as one from a
// server.
absl::StatusOr<DracoFolder> ParseHeader(const std::string& text, const std::string& path) {
  DracoFolder folder;
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.at("schema") != kSchema) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": the schema is not ", kSchema));
    }
    const std::string encoding = json.at("encoding");
    if (encoding != "mesh" && encoding != "points") {
      return absl::InvalidArgumentError(absl::StrCat(path, ": unknown encoding '", encoding, "'"));
    }
    StreamHeader& header = folder.header;
    header.encoding =
        encoding == "mesh" ? FrameEncoding::kDracoMesh : FrameEncoding::kDracoPointCloud;
    folder.num_frames = json.at("num_frames");
    folder.frame_rate = {json.at("fps_numerator"), json.at("fps_denominator")};
    header.num_vertices = json.at("num_vertices");
    header.num_points = json.at("num_points");
    header.num_triangles = json.at("num_triangles");
    const nlohmann::json& box = json.at("box");
    for (int axis = 0; axis < 3; ++axis) header.box.origin_m[axis] = box.at("origin_m").at(axis);
    header.box.range_m = box.at("range_m");
    header.box.bits = box.at("bits");
    header.vertex_order = json.at("vertex_order").get<std::vector<int32_t>>();
  } catch (const nlohmann::json::exception&) {
    return absl::InvalidArgumentError(absl::StrCat(
        path,
        ": not what 'pleat pose' writes: it is no JSON, or a field is missing or of another "
        "kind"));
  }
  if (folder.num_frames < 1 || folder.num_frames > kMaxFolderFrames) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": num_frames ", folder.num_frames,
                                                   " is outside 1 to ", kMaxFolderFrames));
  }
  return folder;
}

// Decodes one file of the stream, which must have `num_positions` positions.
absl::StatusOr<DracoGeometry> ReadGeometry(const StreamHeader& header, int num_positions,
                                           const std::string& path, const Progress& progress) {
  DracoProcessOptions options;
  options.limits.max_vertices = header.num_points;
  options.limits.max_faces = header.num_triangles;
  PLEAT_ASSIGN_OR_RETURN(DracoGeometry geometry, DecodeDracoInChild(path, progress, options));
  if (geometry.positions.cols() == num_positions) return geometry;
  return absl::DataLossError(absl::StrCat(path, ": ", geometry.positions.cols(),
                                          " positions, the stream declared ", num_positions));
}

// Checks that all vertex numbers exist and that every vertex is there at least once.
absl::Status CheckNumbers(const DracoGeometry& geometry, int num_vertices,
                          const std::string& path) {
  std::vector<bool> seen(num_vertices, false);
  for (const int32_t v : geometry.vertex_numbers) {
    if (v < 0 || v >= num_vertices) {
      return absl::DataLossError(absl::StrCat(path, ": a vertex number out of range: ", v));
    }
    seen[v] = true;
  }
  if (std::find(seen.begin(), seen.end(), false) == seen.end()) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(path, ": not every vertex is there"));
}

absl::StatusOr<DracoGeometry> ReadStreamMesh(const DracoFolder& stream, const std::string& path,
                                             const Progress& progress) {
  const StreamHeader& header = stream.header;
  PLEAT_ASSIGN_OR_RETURN(DracoGeometry geometry,
                         ReadGeometry(header, header.num_points, path, progress));
  if (geometry.triangles.cols() != header.num_triangles) {
    return absl::DataLossError(absl::StrCat(path, ": ", geometry.triangles.cols(),
                                            " triangles, the stream declared ",
                                            header.num_triangles));
  }
  PLEAT_RETURN_IF_ERROR(CheckNumbers(geometry, header.num_vertices, path));
  return geometry;
}

absl::StatusOr<Topology> ReadTopology(const DracoFolder& stream, const std::string& path,
                                      const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(DracoGeometry geometry, ReadStreamMesh(stream, path, progress));
  for (int& corner : geometry.triangles.reshaped()) corner = geometry.vertex_numbers[corner];
  return Topology::FromTriangles(stream.header.num_vertices, geometry.triangles);
}

// Returns one frame: 3 x V, meters, in the character's vertex order.
absl::StatusOr<Eigen::Matrix3Xf> ReadFrame(const DracoFolder& stream, const std::string& path,
                                           const Progress& progress) {
  const StreamHeader& header = stream.header;
  Eigen::Matrix3Xf positions(3, header.num_vertices);
  const bool is_mesh = header.encoding == FrameEncoding::kDracoMesh;
  PLEAT_ASSIGN_OR_RETURN(const DracoGeometry geometry,
                         is_mesh ? ReadStreamMesh(stream, path, progress)
                                 : ReadGeometry(header, header.num_vertices, path, progress));
  const std::vector<int32_t>& vertices = is_mesh ? geometry.vertex_numbers : header.vertex_order;
  for (size_t i = 0; i < vertices.size(); ++i) {
    positions.col(vertices[i]) = geometry.positions.col(static_cast<Eigen::Index>(i));
  }
  return positions;
}

}  // namespace

absl::Status DracoFolderWriter::AddFrame(std::string_view draco_bytes) {
  // An earlier animation in this folder must not look complete while its frames are replaced.
  if (num_frames_ == 0) RemoveIfThere(folder_ + "/stream.json");
  return WriteFile(FramePath(folder_, num_frames_++), draco_bytes);
}

absl::Status DracoFolderWriter::Finish(const StreamHeader& header) {
  for (int t = num_frames_; RemoveIfThere(FramePath(folder_, t)); ++t) {
  }
  PLEAT_RETURN_IF_ERROR(WriteFile(folder_ + "/topology.drc", header.topology));
  return WriteFile(folder_ + "/stream.json",
                   HeaderJson(header, frame_rate_, num_frames_).dump() + "\n");
}

bool IsDracoFolder(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path + "/stream.json", error);
}

absl::StatusOr<MeshSequence> ReadDracoFolder(const std::string& folder, const Progress& progress) {
  const std::string header_path = folder + "/stream.json";
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(header_path, kMaxHeaderBytes));
  PLEAT_ASSIGN_OR_RETURN(const DracoFolder stream, ParseHeader(text, header_path));
  if (absl::Status status = CheckStreamHeader(stream.header); !status.ok()) {
    return absl::Status(status.code(), absl::StrCat(header_path, ": ", status.message()));
  }
  PLEAT_ASSIGN_OR_RETURN(const Topology topology,
                         ReadTopology(stream, folder + "/topology.drc", progress));
  MeshSequenceOptions options;
  options.name = std::filesystem::path(folder).lexically_normal().filename().string();
  options.frame_rate = stream.frame_rate;
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < stream.num_frames; ++t) {
    PLEAT_ASSIGN_OR_RETURN(Eigen::Matrix3Xf positions,
                           ReadFrame(stream, FramePath(folder, t), progress));
    frames.push_back(std::move(positions));
    PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.0) / stream.num_frames));
  }
  return MeshSequence::Create(topology, std::move(frames), std::move(options));
}

}  // namespace pleat
