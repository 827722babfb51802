// Sequences of NumPy's arrays, alone or in an archive.
#include <utility>

#include "absl/strings/str_cat.h"
#include "mesh_beside.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/npz.h"

namespace pleat {

absl::StatusOr<MeshSequence> ReadArraySequence(const std::string& path,
                                               const InputReading& reading) {
  const ReadSequenceOptions& options = reading.options;
  InputReport* report = reading.report;
  NpzContents contents;
  {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, options.limits.max_file_bytes));
    PLEAT_ASSIGN_OR_RETURN(contents, DecodeNpz(bytes, path, options.npz_keys, options.limits));
  }
  for (InputNote& note : contents.notes) {
    note.text = absl::StrCat(DisplayName(path), ": ", note.text);
    report->notes.push_back(std::move(note));
  }
  report->has_frame_rate = contents.frame_rate.has_value();
  report->first_frame = contents.first_frame;
  const FrameRate rate = options.frame_rate.value_or(contents.frame_rate.value_or(FrameRate{}));
  if (!contents.topology) return WithMeshBeside(path, std::move(contents.frames), rate, reading);
  MeshFile mesh{.topology = *std::move(contents.topology),
                .positions = {},
                .appearance = std::move(contents.appearance)};
  MeshSequenceOptions sequence_options;
  sequence_options.name =
      contents.name.empty() ? std::filesystem::path(path).stem().string() : contents.name;
  sequence_options.frame_rate = rate;
  return CreateSequence(std::move(mesh), std::move(contents.frames), std::move(sequence_options),
                        path);
}

}  // namespace pleat
