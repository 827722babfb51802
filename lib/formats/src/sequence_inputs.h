// The kinds of input behind sequence_reader.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// What every kind of input is read with.
struct InputReading {
  const ReadSequenceOptions& options;
  const Progress& progress;
  InputReport* report;  // never null
};

std::string LowerExtension(const std::filesystem::path& path);
// By its extension: a mesh that may be a frame or the mesh of a point cache.
bool IsMeshFile(const std::filesystem::path& path);
// By its extension. Beside other files a glTF file is most often a rig or a preview, so it is a
// frame only where it is asked for or where nothing else is.
bool IsGltfFile(const std::filesystem::path& path);
// By its extension: arrays, which beside other files most often hold something else.
bool IsArrayFile(const std::filesystem::path& path);
// The name without its folders, fit for messages and for UTF-8 strings.
std::string DisplayName(const std::filesystem::path& path);

absl::StatusOr<MeshFile> ReadMesh(const std::string& path, const ReadSequenceOptions& options);

// Takes topology and appearance of `mesh`. options.name may be any bytes.
absl::StatusOr<MeshSequence> CreateSequence(MeshFile mesh, std::vector<Eigen::Matrix3Xf> frames,
                                            MeshSequenceOptions options, const std::string& input);

// One mesh file per frame. name: of the sequence. input: for messages.
absl::StatusOr<MeshSequence> ReadFrameFiles(const std::vector<std::string>& paths,
                                            const std::string& name, const std::string& input,
                                            const InputReading& reading);

// A glTF file: the frames of its animation, or one where nothing moves.
absl::StatusOr<MeshSequence> ReadGltfSequence(const std::string& path, const InputReading& reading);

// A point cache (.pc2, .mdd) with the mesh beside it.
absl::StatusOr<MeshSequence> ReadPointCacheSequence(const std::string& path,
                                                    const InputReading& reading);
absl::StatusOr<MeshSequence> ReadMddSequence(const std::string& path, const InputReading& reading);

// An archive of arrays (.npz) that holds the faces, or arrays (.npz, .npy) with the mesh beside.
absl::StatusOr<MeshSequence> ReadArraySequence(const std::string& path,
                                               const InputReading& reading);

// The files that a pattern (*, ?, [...]) names. Brackets in the name of a folder or file that is
// there stand for themselves.
absl::StatusOr<std::vector<std::string>> ExpandPattern(const std::string& pattern);

}  // namespace pleat
