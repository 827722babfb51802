#include "mesh_beside.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/mesh/edge_lengths.h"
#include "pleat/mesh/frame_jumps.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxEdges = 16384;

std::vector<std::string> MeshesBeside(const fs::path& cache_path) {
  std::vector<std::string> paths;
  std::error_code error;
  const fs::path folder = cache_path.has_parent_path() ? cache_path.parent_path() : ".";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (IsMeshFile(entry.path())) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

struct FoundMesh {
  std::string path;
  MeshFile mesh;
};

// The mesh of that name, if there is one; an error when it cannot be read or does not fit.
absl::StatusOr<std::optional<FoundMesh>> TryNamedMesh(const std::string& path,
                                                      const fs::path& cache_path,
                                                      Eigen::Index num_vertices,
                                                      const ReadSequenceOptions& options) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::optional<FoundMesh>();
  absl::StatusOr<MeshFile> mesh = ReadMesh(path, options);
  if (!mesh.ok()) {
    return WithContext(absl::StrCat("the mesh of '", cache_path.string(), "' cannot be read"),
                       mesh.status());
  }
  if (mesh->positions.cols() == num_vertices) {
    return std::optional<FoundMesh>(FoundMesh{path, *std::move(mesh)});
  }
  return absl::InvalidArgumentError(absl::StrCat("'", cache_path.string(), "' moves ", num_vertices,
                                                 " vertices but its mesh '", path, "' has ",
                                                 mesh->positions.cols()));
}

// The only mesh beside the cache with its number of vertices.
absl::StatusOr<FoundMesh> FindFittingMesh(const fs::path& cache_path, Eigen::Index num_vertices,
                                          const ReadSequenceOptions& options) {
  std::vector<std::string> fitting, unreadable;
  FoundMesh found;
  for (const std::string& path : MeshesBeside(cache_path)) {
    absl::StatusOr<MeshFile> mesh = ReadMesh(path, options);
    if (!mesh.ok()) unreadable.emplace_back(mesh.status().message());
    if (!mesh.ok() || mesh->positions.cols() != num_vertices) continue;
    fitting.push_back(DisplayName(path));
    found = {path, *std::move(mesh)};
  }
  if (fitting.size() == 1) return found;
  const std::string wanted = DisplayName(fs::path(cache_path).replace_extension(".obj"));
  if (!fitting.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "several meshes beside '", cache_path.string(), "' have its ", num_vertices, " vertices (",
        absl::StrJoin(fitting, ", "), "); name the right one '", wanted, "'"));
  }
  if (!unreadable.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", cache_path.string(), "' has positions only and no mesh with ", num_vertices,
        " vertices is beside it; what cannot be read there: ", absl::StrJoin(unreadable, "; ")));
  }
  return absl::NotFoundError(absl::StrCat(
      "'", cache_path.string(), "' has positions only and no mesh with ", num_vertices,
      " vertices is beside it; put its mesh there as '", wanted, "' or 'template.obj'"));
}

// The mesh whose vertices the cache moves (see ReadSequence).
absl::StatusOr<FoundMesh> FindMesh(const fs::path& cache_path, Eigen::Index num_vertices,
                                   const InputReading& reading) {
  const fs::path folder = cache_path.parent_path();
  for (const std::string& path :
       {fs::path(cache_path).replace_extension(".obj").string(),
        fs::path(cache_path).replace_extension(".ply").string(), (folder / "template.obj").string(),
        (folder / "template.ply").string()}) {
    PLEAT_ASSIGN_OR_RETURN(std::optional<FoundMesh> mesh,
                           TryNamedMesh(path, cache_path, num_vertices, reading.options));
    if (mesh) return *std::move(mesh);
  }
  PLEAT_ASSIGN_OR_RETURN(FoundMesh found,
                         FindFittingMesh(cache_path, num_vertices, reading.options));
  return found;
}

InputNote Warning(const char* kind, std::string text) {
  return {.severity = NoteSeverity::kWarning, .kind = kind, .text = std::move(text)};
}

// Whether the vertices of `mesh` are those of the cache, by the lengths of the edges.
void CompareShapes(const std::string& cache_name, const FoundMesh& found,
                   const Eigen::Matrix3Xf& frame, InputReport* report) {
  const std::vector<Edge> edges = SampleEdges(found.mesh.topology, kMaxEdges);
  if (edges.empty() || !found.mesh.positions.allFinite() || !frame.allFinite()) return;
  const EdgeChange change =
      CompareEdgeLengths(EdgeLengths(edges, found.mesh.positions), EdgeLengths(edges, frame));
  const std::string mesh_name = DisplayName(found.path);
  if (!IsSameShape(change)) {
    report->notes.push_back(Warning(
        "mesh_differs",
        absl::StrFormat(
            "%s: its mesh %s has another shape than frame 0: %.0f %% of the edges have another "
            "length. The vertices are in another order, or it is the mesh of another object; put "
            "the right one beside the cache as '%s'",
            cache_name, mesh_name, 100 * std::max(change.share_moderate, change.share_extreme),
            DisplayName(fs::path(cache_name).replace_extension(".obj")))));
  } else if (change.scale > 1.1 || change.scale < 1 / 1.1) {
    report->notes.push_back(
        {.kind = "mesh_scaled",
         .text = absl::StrFormat("%s: frame 0 is %.3g times as large as the mesh %s; all positions "
                                 "are those of the cache",
                                 cache_name, change.scale, mesh_name)});
  }
}

}  // namespace

absl::StatusOr<MeshSequence> WithMeshBeside(const std::string& path,
                                            std::vector<Eigen::Matrix3Xf> frames,
                                            FrameRate frame_rate, const InputReading& reading) {
  PLEAT_ASSIGN_OR_RETURN(FoundMesh found, FindMesh(path, frames[0].cols(), reading));
  const std::string cache_name = DisplayName(path);
  InputReport* report = reading.report;
  if (fs::path(found.path).stem() != fs::path(path).stem()) {
    report->notes.push_back(
        {.kind = "mesh_taken",
         .text = absl::StrCat(cache_name, ": its mesh is taken from ", DisplayName(found.path))});
  }
  FrameNotes mesh_notes;
  mesh_notes.Add(0, found.mesh.notes);
  for (InputNote& note : mesh_notes.Merge({}, DisplayName(found.path))) {
    note.frame.reset();
    report->notes.push_back(std::move(note));
  }
  MeshSequenceOptions sequence_options;
  sequence_options.name = fs::path(path).stem().string();
  sequence_options.frame_rate = frame_rate;
  CompareShapes(cache_name, found, frames[0], report);
  return CreateSequence(std::move(found.mesh), std::move(frames), std::move(sequence_options),
                        path);
}

}  // namespace pleat
