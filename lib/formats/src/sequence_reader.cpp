#include "pleat/formats/sequence_reader.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/alembic_reader.h"
#include "pleat/formats/sequence_file.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr absl::string_view kKnownExtensions =
    ".obj, .ply, .drc, .glb, .gltf, .pc2, .mdd, .npz, .npy, .abc, .pseq";

// The folder's own name, also for "." and "dir/".
std::string FolderName(const std::string& folder) {
  std::error_code error;
  const fs::path absolute = fs::weakly_canonical(folder.empty() ? "." : folder, error);
  return absolute.has_filename() ? absolute.filename().string()
                                 : absolute.parent_path().filename().string();
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

absl::StatusOr<MeshSequence> ReadAlembicSequence(const std::string& path,
                                                 const InputReading& reading) {
  const ReadSequenceOptions& options = reading.options;
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, options.limits.max_file_bytes));
  return DecodeAlembic(bytes, path,
                       {.name = fs::path(path).stem().string(),
                        .object = options.object,
                        .frame_rate = options.frame_rate,
                        .limits = options.limits},
                       reading.progress, reading.report);
}

// Formats that hold a whole animation in one file.
bool IsAnimationFile(const std::string& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".pc2" || extension == ".mdd" || extension == ".abc" || extension == ".pseq";
}

// ---- Which of them the input is ----

absl::Status UnknownExtension(const std::string& path) {
  PLEAT_RETURN_IF_ERROR(RefuseForeignFile(path));
  return absl::InvalidArgumentError(
      absl::StrCat("'", path, "' has the unknown extension '", fs::path(path).extension().string(),
                   "'; known are ", kKnownExtensions, ", a folder of meshes, or a pattern (*, ?)"));
}

void NoteUnusedChoice(const char* kind, std::string text, const InputReading& reading) {
  reading.report->notes.push_back(
      {.kind = kind, .text = std::move(text), .refused_when_strict = true});
}

// Says that --object counts for archives alone, and --animation for glTF files.
void NoteUnusedChoices(const std::string& path, bool is_archive, bool is_gltf,
                       const InputReading& reading) {
  const ReadSequenceOptions& options = reading.options;
  if (!options.object.empty() && !is_archive) {
    NoteUnusedChoice("object_ignored",
                     absl::StrCat("'", path, "' is no Alembic archive, so it has no object '",
                                  options.object, "' to choose"),
                     reading);
  }
  if (!options.animation.empty() && !is_gltf) {
    NoteUnusedChoice("animation_ignored",
                     absl::StrCat("'", path, "' is no single glTF file, so it has no animation '",
                                  options.animation, "' to choose"),
                     reading);
  }
}

absl::StatusOr<MeshSequence> ReadKnownFile(const std::string& path, const InputReading& reading) {
  const std::string extension = LowerExtension(path);
  if (extension == ".abc") return ReadAlembicSequence(path, reading);
  if (IsGltfFile(path)) return ReadGltfSequence(path, reading);
  if (IsMeshFile(path)) {
    return ReadFrameFiles({path}, fs::path(path).stem().string(), path, reading);
  }
  if (extension == ".pc2") return ReadPointCacheSequence(path, reading);
  if (extension == ".mdd") return ReadMddSequence(path, reading);
  if (IsArrayFile(path)) return ReadArraySequence(path, reading);
  if (extension != ".pseq") return UnknownExtension(path);
  reading.report->has_frame_rate = true;
  return ReadPleatSequence(path, reading.options);
}

absl::StatusOr<MeshSequence> ReadOneFile(const std::string& path, const InputReading& reading) {
  absl::StatusOr<MeshSequence> sequence = ReadKnownFile(path, reading);
  if (sequence.ok()) {
    NoteUnusedChoices(path, LowerExtension(path) == ".abc", IsGltfFile(path), reading);
  }
  return sequence;
}

// Reads one frame from each file of a folder or a pattern, which `input` is.
absl::StatusOr<MeshSequence> ReadEachFile(const std::vector<std::string>& paths,
                                          const std::string& name, const std::string& input,
                                          const InputReading& reading) {
  absl::StatusOr<MeshSequence> sequence = ReadFrameFiles(paths, name, input, reading);
  if (sequence.ok()) NoteUnusedChoices(input, false, false, reading);
  return sequence;
}

absl::StatusOr<MeshSequence> ReadFolder(const std::string& folder, const InputReading& reading) {
  std::vector<std::string> meshes, caches, gltf_files, arrays;
  std::set<std::string> other_extensions;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (entry.is_directory(error) || DisplayName(path).starts_with(".")) continue;
    if (IsMeshFile(path)) {
      meshes.push_back(path);
    } else if (IsAnimationFile(path)) {
      caches.push_back(path);
    } else if (IsGltfFile(path)) {
      gltf_files.push_back(path);
    } else if (IsArrayFile(path)) {
      arrays.push_back(path);
    } else {
      other_extensions.insert(absl::StrCat("'", LowerExtension(path), "'"));
    }
  }
  if (error) return ErrnoStatus(error.value(), absl::StrCat("cannot list '", folder, "'"));
  if (caches.empty() && meshes.empty() && gltf_files.empty()) caches = std::move(arrays);
  if (caches.size() == 1 && meshes.size() <= 1) return ReadOneFile(caches[0], reading);
  if (!caches.empty()) {
    std::sort(caches.begin(), caches.end());
    return absl::InvalidArgumentError(absl::StrCat("'", folder, "' holds ", caches.size(),
                                                   " animation files; give one of them, "
                                                   "such as '",
                                                   caches[0], "', or a pattern for its meshes"));
  }
  if (meshes.empty() && gltf_files.size() == 1) return ReadOneFile(gltf_files[0], reading);
  if (meshes.empty()) meshes = std::move(gltf_files);
  if (meshes.empty()) {
    return absl::NotFoundError(
        absl::StrCat("'", folder, "' holds no frames: known extensions are ", kKnownExtensions,
                     other_extensions.empty()
                         ? "; it is empty"
                         : absl::StrCat("; found only ", absl::StrJoin(other_extensions, ", "))));
  }
  return ReadEachFile(meshes, FolderName(folder), folder, reading);
}

absl::StatusOr<MeshSequence> ReadPattern(const std::string& pattern, const InputReading& reading) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> paths, ExpandPattern(pattern));
  if (paths.size() == 1 && !IsMeshFile(paths[0])) return ReadOneFile(paths[0], reading);
  for (const std::string& path : paths) {
    if (!IsMeshFile(path) && !IsGltfFile(path)) return UnknownExtension(path);
  }
  const std::string name = FolderName(fs::path(pattern).parent_path().string());
  return ReadEachFile(paths, name, pattern, reading);
}

}  // namespace

absl::StatusOr<MeshSequence> ReadSequence(const std::string& input,
                                          const ReadSequenceOptions& options,
                                          const Progress& progress, InputReport* report) {
  PLEAT_RETURN_IF_ERROR(progress.Report(0));
  InputReport unread;
  const InputReading reading = {options, progress, report == nullptr ? &unread : report};
  std::error_code error;
  absl::StatusOr<MeshSequence> sequence = absl::UnknownError("");
  if (fs::is_directory(input, error)) {
    sequence = ReadFolder(input, reading);
  } else if (fs::exists(input, error)) {
    sequence = ReadOneFile(input, reading);
  } else if (input.find_first_of("*?[") != std::string::npos) {
    sequence = ReadPattern(input, reading);
  } else {
    return absl::NotFoundError(absl::StrCat("'", input, "' does not exist"));
  }
  PLEAT_RETURN_IF_ERROR(sequence.status());
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return sequence;
}

}  // namespace pleat
