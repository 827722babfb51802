// Sequences with one mesh file per frame.
#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "obj_parser.h"
#include "pleat/base/file.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/formats/frame_files.h"
#include "same_faces.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

class FrameFileReader {
 public:
  FrameFileReader(const std::vector<std::string>& paths, const ReadSequenceOptions& options)
      : paths_(paths), options_(options) {}

  // notes receives those of the first frame that has each.
  absl::StatusOr<MeshSequence> Read(const std::string& name, const std::string& input,
                                    const InputReading& reading) {
    PLEAT_RETURN_IF_ERROR(ReadFirst());
    PLEAT_RETURN_IF_ERROR(CheckSizes());
    PLEAT_RETURN_IF_ERROR(ReadOthers(reading.progress));
    for (const std::string& path : paths_) {
      reading.report->frame_names.push_back(DisplayName(path));
    }
    for (InputNote& note : notes_.Merge(reading.report->frame_names, DisplayName(paths_[0]))) {
      reading.report->notes.push_back(std::move(note));
    }
    MeshSequenceOptions sequence_options;
    sequence_options.name = name;
    sequence_options.frame_rate = options_.frame_rate.value_or(FrameRate{});
    sequence_options.frame_names = reading.report->frame_names;
    return CreateSequence(std::move(first_), std::move(frames_), std::move(sequence_options),
                          input);
  }

 private:
  // What one frame gave.
  struct FrameResult {
    absl::Status status;
    std::vector<InputNote> notes;
  };

  bool IsObj(const std::string& path) const { return LowerExtension(path) == ".obj"; }

  absl::Status AboutFrame(int t, absl::Status status) const {
    if (paths_.size() == 1) return status;
    return WithContext(absl::StrCat("frame ", t), std::move(status));
  }

  // `known` and `faces` may be null; see ParseObj.
  absl::StatusOr<ObjFrame> ReadFrameFile(const std::string& path, const ObjFaceText* known,
                                         ObjFaceText* faces) const {
    if (!IsObj(path)) {
      PLEAT_ASSIGN_OR_RETURN(MeshFile mesh, ReadMesh(path, options_));
      return ObjFrame{std::move(mesh), false};
    }
    PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, options_.limits.max_file_bytes));
    return ParseObj(text, path, options_.limits, known, faces);
  }

  absl::Status ReadFirst() {
    absl::StatusOr<ObjFrame> frame =
        ReadFrameFile(paths_[0], nullptr, paths_.size() > 1 ? &faces_ : nullptr);
    if (!frame.ok()) return AboutFrame(0, frame.status());
    first_ = std::move(frame->mesh);
    notes_.Add(0, first_.notes);
    comparison_.emplace(first_.topology, DisplayName(paths_[0]));
    return absl::OkStatus();
  }

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

  absl::Status ReadOthers(const Progress& progress) {
    frames_.resize(paths_.size());
    frames_[0] = first_.positions;
    // In batches: between them progress is told and cancellation noticed.
    constexpr int kBatch = 16;
    const int num_frames = static_cast<int>(paths_.size());
    std::vector<FrameResult> results(kBatch);
    for (int begin = 1; begin < num_frames; begin += kBatch) {
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(begin) / num_frames));
      const int end = std::min(begin + kBatch, num_frames);
      ParallelFor(end - begin, options_.num_threads,
                  [&](int item) { results[item] = ReadFrame(begin + item); });
      for (int t = begin; t < end; ++t) {
        PLEAT_RETURN_IF_ERROR(AboutFrame(t, std::move(results[t - begin].status)));
        notes_.Add(t, results[t - begin].notes);
      }
    }
    return absl::OkStatus();
  }

  FrameResult ReadFrame(int t) {
    absl::StatusOr<ObjFrame> frame =
        ReadFrameFile(paths_[t], faces_.text.empty() ? nullptr : &faces_, nullptr);
    if (!frame.ok()) return {frame.status(), {}};
    FrameResult result{absl::OkStatus(), std::move(frame->mesh.notes)};
    if (!frame->has_known_faces) {
      result.status = WithContext(absl::StrCat("'", paths_[t], "'"),
                                  comparison_->Check(frame->mesh.topology, &result.notes));
    }
    if (result.status.ok()) frames_[t] = std::move(frame->mesh.positions);
    return result;
  }

  const std::vector<std::string>& paths_;
  const ReadSequenceOptions& options_;
  MeshFile first_;
  ObjFaceText faces_;  // of the first frame
  std::optional<FaceComparison> comparison_;
  std::vector<Eigen::Matrix3Xf> frames_;
  FrameNotes notes_;
};

absl::Status CheckOneKind(const std::vector<std::string>& paths, const std::string& input) {
  std::set<std::string> extensions;
  for (const std::string& path : paths) extensions.insert(LowerExtension(path));
  if (extensions.size() < 2) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("'", input, "' holds meshes of several kinds (", absl::StrJoin(extensions, ", "),
                   "); choose one with a pattern such as \"folder/*.obj\""));
}

}  // namespace

absl::StatusOr<MeshSequence> ReadFrameFiles(const std::vector<std::string>& paths,
                                            const std::string& name, const std::string& input,
                                            const InputReading& reading) {
  absl::StatusOr<FrameFiles> files = SortFrameFiles(paths);
  if (!files.ok()) {
    PLEAT_RETURN_IF_ERROR(CheckOneKind(paths, input));
    return WithContext(input, files.status());
  }
  PLEAT_RETURN_IF_ERROR(CheckOneKind(files->paths, input));
  reading.report->notes = std::move(files->notes);
  return FrameFileReader(files->paths, reading.options).Read(name, input, reading);
}

}  // namespace pleat
