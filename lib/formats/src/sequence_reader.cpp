#include "pleat/formats/sequence_reader.h"

#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/formats/frame_files.h"
#include "pleat/formats/obj_reader.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/ply_reader.h"
#include "pleat/formats/sequence_file.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr absl::string_view kKnownExtensions = ".obj, .ply, .drc, .pc2, .pseq";

std::string Extension(const fs::path& path) {
  return absl::AsciiStrToLower(path.extension().string());
}
bool IsMesh(const fs::path& path) {
  const std::string extension = Extension(path);
  return extension == ".obj" || extension == ".ply" || extension == ".drc";
}
std::string FileName(const std::string& path) { return fs::path(path).filename().string(); }

absl::StatusOr<MeshFile> ReadMesh(const std::string& path, const ReadSequenceOptions& options) {
  if (Extension(path) != ".drc") {
    return Extension(path) == ".ply" ? ReadPly(path, options.limits)
                                     : ReadObj(path, options.limits);
  }
  if (options.read_draco) return options.read_draco(path);
  return absl::InvalidArgumentError(
      absl::StrCat("'", path, "' is a Draco file, which is not read here"));
}

absl::StatusOr<MeshSequence> CreateSequence(MeshFile mesh, std::vector<Eigen::Matrix3Xf> frames,
                                            MeshSequenceOptions options, const std::string& input) {
  options.appearance = std::move(mesh.appearance);
  return WithContext(
      input, MeshSequence::Create(std::move(mesh.topology), std::move(frames), std::move(options)));
}

// Returns the folder's own name, also for "." and "dir/".
std::string FolderName(const std::string& folder) {
  std::error_code error;
  const fs::path absolute = fs::weakly_canonical(folder.empty() ? "." : folder, error);
  return absolute.has_filename() ? absolute.filename().string()
                                 : absolute.parent_path().filename().string();
}

// ---- One mesh file per frame ----

absl::Status CheckSameTopology(const Topology& first, const std::string& first_path,
                               const Topology& other, const std::string& other_path, int t) {
  if (first == other) return absl::OkStatus();
  const std::string where = absl::StrCat(
      "frame ", t, " ('", other_path, "') differs from the first ('", FileName(first_path), "'): ");
  if (other.num_vertices() != first.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat(
        where, other.num_vertices(), " vertices, the first frame has ", first.num_vertices()));
  }
  const int num_common = std::min(first.num_faces(), other.num_faces());
  for (int f = 0; f < num_common; ++f) {
    const std::span<const int32_t> a = first.face(f), b = other.face(f);
    if (std::equal(a.begin(), a.end(), b.begin(), b.end())) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        where, "face ", f, " joins vertices ", absl::StrJoin(b, " "), ", in the first frame ",
        absl::StrJoin(a, " "), " (all counted from 0); all frames need one connectivity"));
  }
  return absl::InvalidArgumentError(absl::StrCat(where, other.num_faces(),
                                                 " faces, the first frame has ", first.num_faces(),
                                                 "; face ", num_common,
                                                 " is the first without a "
                                                 "counterpart; all frames need one connectivity"));
}

class FrameFileReader {
 public:
  FrameFileReader(const std::vector<std::string>& paths, const ReadSequenceOptions& options)
      : paths_(paths), options_(options) {}

  absl::StatusOr<MeshSequence> Read(const std::string& name, const std::string& input,
                                    const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(first_, ReadMesh(paths_[0], options_));
    PLEAT_RETURN_IF_ERROR(CheckSizes());
    frames_.resize(paths_.size());
    faults_.resize(paths_.size());
    frames_[0] = first_.positions;
    // Frames are read in batches. Between them progress is reported and a cancellation is noticed.
    constexpr int kBatch = 16;
    const int num_frames = static_cast<int>(paths_.size());
    for (int begin = 1; begin < num_frames; begin += kBatch) {
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(begin) / num_frames));
      const int end = std::min(begin + kBatch, num_frames);
      ParallelFor(end - begin, options_.num_threads, [&](int item) { ReadFrame(begin + item); });
      for (int t = begin; t < end; ++t) PLEAT_RETURN_IF_ERROR(faults_[t]);
    }
    MeshSequenceOptions sequence_options;
    sequence_options.name = name;
    sequence_options.frame_rate = options_.frame_rate.value_or(FrameRate{});
    for (const std::string& path : paths_) {
      sequence_options.frame_names.push_back(FileName(path));
    }
    return CreateSequence(std::move(first_), std::move(frames_), std::move(sequence_options),
                          input);
  }

 private:
  absl::Status CheckSizes() const {
    const uint64_t bytes = paths_.size() * static_cast<uint64_t>(first_.positions.cols()) * 12;
    if (static_cast<int64_t>(paths_.size()) <= options_.limits.max_frames &&
        bytes <= options_.limits.max_sequence_bytes) {
      return absl::OkStatus();
    }
    return absl::ResourceExhaustedError(
        absl::StrCat(paths_.size(), " frames of ", first_.positions.cols(), " vertices (", bytes,
                     " bytes) are over the limit of ", options_.limits.max_frames, " frames, ",
                     options_.limits.max_sequence_bytes, " bytes"));
  }

  // Runs on several threads. Each call writes only to the entries of its own frame, so the first
  // fault by frame number is reported, whichever thread finished first.
  void ReadFrame(int t) {
    absl::StatusOr<MeshFile> mesh = ReadMesh(paths_[t], options_);
    faults_[t] = mesh.ok()
                     ? CheckSameTopology(first_.topology, paths_[0], mesh->topology, paths_[t], t)
                     : mesh.status();
    if (faults_[t].ok()) frames_[t] = std::move(mesh->positions);
  }

  const std::vector<std::string>& paths_;
  const ReadSequenceOptions& options_;
  MeshFile first_;
  std::vector<Eigen::Matrix3Xf> frames_;
  std::vector<absl::Status> faults_;
};

absl::StatusOr<MeshSequence> ReadFrameFiles(std::vector<std::string> paths, const std::string& name,
                                            const std::string& input,
                                            const ReadSequenceOptions& options,
                                            const Progress& progress) {
  std::set<std::string> extensions;
  for (const std::string& path : paths) extensions.insert(Extension(path));
  if (extensions.size() > 1) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", input, "' holds meshes of several kinds (", absl::StrJoin(extensions, ", "),
        "); choose one with a pattern such as \"folder/*.obj\""));
  }
  PLEAT_RETURN_IF_ERROR(WithContext(input, SortFrameFiles(&paths)));
  return FrameFileReader(paths, options).Read(name, input, progress);
}

// ---- A point cache and its mesh ----

std::vector<std::string> MeshesBeside(const fs::path& cache_path) {
  std::vector<std::string> paths;
  std::error_code error;
  const fs::path folder = cache_path.has_parent_path() ? cache_path.parent_path() : ".";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (IsMesh(entry.path())) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Finds the mesh whose vertices the cache moves (see ReadSequence).
absl::StatusOr<MeshFile> FindMesh(const fs::path& cache_path, Eigen::Index num_vertices,
                                  const ReadSequenceOptions& options) {
  const fs::path folder = cache_path.parent_path();
  for (const std::string& name :
       {fs::path(cache_path).replace_extension(".obj").string(),
        fs::path(cache_path).replace_extension(".ply").string(), (folder / "template.obj").string(),
        (folder / "template.ply").string()}) {
    std::error_code error;
    if (!fs::exists(name, error)) continue;
    PLEAT_ASSIGN_OR_RETURN(MeshFile mesh, ReadMesh(name, options));
    if (mesh.positions.cols() == num_vertices) return mesh;
    return absl::InvalidArgumentError(absl::StrCat("'", cache_path.string(), "' moves ",
                                                   num_vertices, " vertices but its mesh '", name,
                                                   "' has ", mesh.positions.cols()));
  }
  std::vector<std::string> fitting;
  absl::StatusOr<MeshFile> found = MeshFile{};
  for (const std::string& path : MeshesBeside(cache_path)) {
    absl::StatusOr<MeshFile> mesh = ReadMesh(path, options);
    if (!mesh.ok() || mesh->positions.cols() != num_vertices) continue;
    fitting.push_back(FileName(path));
    found = std::move(mesh);
  }
  if (fitting.size() == 1) return found;
  const std::string wanted = fs::path(cache_path).replace_extension(".obj").filename().string();
  if (fitting.empty()) {
    return absl::NotFoundError(absl::StrCat(
        "'", cache_path.string(), "' has positions only and no mesh with ", num_vertices,
        " vertices is beside it; put its mesh there as '", wanted, "' or 'template.obj'"));
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "several meshes beside '", cache_path.string(), "' have its ", num_vertices, " vertices (",
      absl::StrJoin(fitting, ", "), "); name the right one '", wanted, "'"));
}

absl::StatusOr<MeshSequence> ReadPointCacheSequence(const std::string& path,
                                                    const ReadSequenceOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(PointCache cache, ReadPointCache(path, options.limits));
  PLEAT_ASSIGN_OR_RETURN(MeshFile mesh, FindMesh(path, cache.frames[0].cols(), options));
  MeshSequenceOptions sequence_options;
  sequence_options.name = fs::path(path).stem().string();
  sequence_options.frame_rate = options.frame_rate.value_or(FrameRate{});
  return CreateSequence(std::move(mesh), std::move(cache.frames), std::move(sequence_options),
                        path);
}

absl::StatusOr<MeshSequence> ReadPleatSequence(const std::string& path,
                                               const ReadSequenceOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, ReadSequenceFile(path, options.limits));
  if (!options.frame_rate) return sequence;
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return MeshSequence::Create(sequence.topology(), std::move(frames),
                              {sequence.name(), *options.frame_rate, sequence.appearance(), {}});
}

// ---- Which of them the input is ----

absl::Status UnknownExtension(const std::string& path) {
  return absl::InvalidArgumentError(absl::StrCat(
      "'", path, "' has the unknown extension '", fs::path(path).extension().string(),
      "'; known are ", kKnownExtensions, ", a folder of .obj, .ply or .drc, or a pattern (*, ?)"));
}

absl::StatusOr<MeshSequence> ReadOneFile(const std::string& path,
                                         const ReadSequenceOptions& options,
                                         const Progress& progress) {
  if (IsMesh(path)) {
    return ReadFrameFiles({path}, fs::path(path).stem().string(), path, options, progress);
  }
  if (Extension(path) == ".pc2") return ReadPointCacheSequence(path, options);
  if (Extension(path) == ".pseq") return ReadPleatSequence(path, options);
  return UnknownExtension(path);
}

absl::StatusOr<MeshSequence> ReadFolder(const std::string& folder,
                                        const ReadSequenceOptions& options,
                                        const Progress& progress) {
  std::vector<std::string> meshes, caches;
  std::set<std::string> other_extensions;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (entry.is_directory(error) || FileName(path).starts_with(".")) continue;
    if (IsMesh(path)) {
      meshes.push_back(path);
    } else if (Extension(path) == ".pc2" || Extension(path) == ".pseq") {
      caches.push_back(path);
    } else {
      other_extensions.insert(absl::StrCat("'", Extension(path), "'"));
    }
  }
  if (error) return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot list '", folder, "'"));
  if (caches.size() == 1 && meshes.size() <= 1) return ReadOneFile(caches[0], options, progress);
  if (!caches.empty()) {
    std::sort(caches.begin(), caches.end());
    return absl::InvalidArgumentError(absl::StrCat("'", folder, "' holds ", caches.size(),
                                                   " animation files; give one of them, "
                                                   "such as '",
                                                   caches[0], "', or a pattern for its meshes"));
  }
  if (meshes.empty()) {
    return absl::NotFoundError(
        absl::StrCat("'", folder, "' holds no frames: known extensions are ", kKnownExtensions,
                     other_extensions.empty()
                         ? "; it is empty"
                         : absl::StrCat("; found only ", absl::StrJoin(other_extensions, ", "))));
  }
  return ReadFrameFiles(std::move(meshes), FolderName(folder), folder, options, progress);
}

absl::StatusOr<MeshSequence> ReadPattern(const std::string& pattern,
                                         const ReadSequenceOptions& options,
                                         const Progress& progress) {
  glob_t matches{};
  const int result = glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches);
  std::vector<std::string> paths(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  globfree(&matches);
  if (result == GLOB_NOMATCH || paths.empty()) {
    return absl::NotFoundError(absl::StrCat("no file matches the pattern '", pattern, "'"));
  }
  if (result != 0) return absl::InternalError(absl::StrCat("cannot expand '", pattern, "'"));
  if (paths.size() == 1 && !IsMesh(paths[0])) return ReadOneFile(paths[0], options, progress);
  for (const std::string& path : paths) {
    if (!IsMesh(path)) return UnknownExtension(path);
  }
  return ReadFrameFiles(std::move(paths), FolderName(fs::path(pattern).parent_path().string()),
                        pattern, options, progress);
}

}  // namespace

absl::StatusOr<MeshSequence> ReadSequence(const std::string& input,
                                          const ReadSequenceOptions& options,
                                          const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(progress.Report(0));
  std::error_code error;
  absl::StatusOr<MeshSequence> sequence = absl::UnknownError("");
  if (fs::is_directory(input, error)) {
    sequence = ReadFolder(input, options, progress);
  } else if (fs::exists(input, error)) {
    sequence = ReadOneFile(input, options, progress);
  } else if (input.find_first_of("*?[") != std::string::npos) {
    sequence = ReadPattern(input, options, progress);
  } else {
    return absl::NotFoundError(absl::StrCat("'", input, "' does not exist"));
  }
  PLEAT_RETURN_IF_ERROR(sequence.status());
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return sequence;
}

}  // namespace pleat
