#include "cli/batch/batch_work.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/interrupt.h"
#include "cli/io/input.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_options.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr size_t kRequestIdDigits = 32;

std::string OptionsText(const JobOptions& options) {
  if (const auto* train = std::get_if<TrainOptions>(&options)) return FormatTrainOptions(*train);
  const auto& compress = std::get<CompressOptions>(options);
  return absl::StrCat("compress ", static_cast<int>(compress.goal), " ", compress.max_error_mm, " ",
                      compress.kg_percent, " ", compress.grid_bits, " ",
                      compress.keep_face_order ? 1 : 0);
}

void AppendFile(const fs::path& path, std::string* text) {
  std::error_code error;
  const auto changed = fs::last_write_time(path, error).time_since_epoch().count();
  absl::StrAppend(text, path.string(), "\n", fs::file_size(path, error), "\n", changed, "\n");
}

// A folder of frames counts as its files do.
void AppendInput(const std::string& input, std::string* text) {
  std::error_code error;
  if (!fs::is_directory(input, error)) return AppendFile(input, text);
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(input, error)) {
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) AppendFile(file, text);
}

// Reads and uploads the inputs.
absl::StatusOr<std::vector<std::string>> Upload(CharacterService* service, const Session& session,
                                                const BatchJob& job, const BatchTake& take,
                                                BatchRow* row) {
  std::vector<std::string> ids;
  for (const std::string& input : take.inputs) {
    if (Interrupted()) return absl::CancelledError("interrupted");
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence clip, ReadInput(session, input, job.fps));
    if (take.inputs.size() == 1) PLEAT_RETURN_IF_ERROR(CheckIsClip(clip, input));
    if (ids.empty()) {
      row->num_frames = clip.num_frames();
      row->num_vertices = clip.num_vertices();
    }
    PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, service->sequences().Upload(clip, {}, job.ttl));
    ids.push_back(info.id);
  }
  return ids;
}

// The same for the same take and attempt, so that a call whose answer was lost makes no second job.
std::string RequestIdOf(const BatchRow& row, int attempt) {
  const std::string text = absl::StrCat(row.name, "\n", row.fingerprint, "\n", attempt);
  return ToHex(ComputeSha256(text)).substr(0, kRequestIdDigits);
}

absl::StatusOr<JobInfo> CreateJob(CharacterService* service, const BatchJob& job,
                                  const BatchRow& row, int attempt) {
  const std::string request_id = RequestIdOf(row, attempt);
  if (const auto* train = std::get_if<TrainOptions>(&job.options)) {
    return service->jobs().CreateTraining({.sequence_ids = row.sequence_ids,
                                           .options = *train,
                                           .model_name = row.name,
                                           .request_id = request_id,
                                           .model_ttl = job.ttl});
  }
  if (row.sequence_ids.size() != 1) {
    return absl::InvalidArgumentError("a take of several inputs can be trained, not compressed");
  }
  return service->jobs().CreateCompression({.sequence_id = row.sequence_ids.front(),
                                            .options = std::get<CompressOptions>(job.options),
                                            .request_id = request_id,
                                            .result_ttl = job.ttl});
}

// Waits for the end of the job and returns it when it has succeeded.
absl::StatusOr<JobInfo> Finish(JobService& jobs, const std::string& id) {
  JobInfo last;
  PLEAT_RETURN_IF_ERROR(WatchJob(jobs, id, [&last](const JobInfo& info) {
    last = info;
    return !Interrupted();
  }));
  if (last.state == JobState::kSucceeded) return last;
  if (last.state == JobState::kCancelled || !IsFinal(last.state)) {
    return absl::CancelledError(absl::StrCat("job ", id, " was cancelled"));
  }
  return absl::Status(last.error.ok() ? absl::StatusCode::kInternal : last.error.code(),
                      last.error.message());
}

absl::Status Fetch(CharacterService* service, const BatchJob& job, BatchRow* row) {
  const bool trained = std::holds_alternative<TrainOptions>(job.options);
  if (trained) {
    PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, service->models().Get(row->result_id));
    row->mean_error_mm = info.record.reconstruction.mean_mm;
  }
  if (job.output_dir.empty()) return absl::OkStatus();
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes,
                         trained ? service->models().Download(row->result_id, {})
                                 : service->compressed_sequences().Download(row->result_id, {}));
  const std::string name = absl::StrCat(row->name, trained ? ".pleat" : ".plt");
  row->output = (fs::path(job.output_dir) / name).string();
  return WriteFile(row->output, bytes);
}

absl::Status Work(CharacterService* service, const Session& session, const BatchJob& job,
                  const BatchTake& take, int attempt, BatchRow* row) {
  PLEAT_ASSIGN_OR_RETURN(row->sequence_ids, Upload(service, session, job, take, row));
  PLEAT_ASSIGN_OR_RETURN(const JobInfo created, CreateJob(service, job, *row, attempt));
  row->job_id = created.id;
  PLEAT_ASSIGN_OR_RETURN(const JobInfo done, Finish(service->jobs(), created.id));
  row->result_id = done.result_id;
  return Fetch(service, job, row);
}

}  // namespace

std::string FingerprintOf(const BatchTake& take, const BatchJob& job) {
  std::string text = absl::StrCat(OptionsText(job.options), "\n", job.fps, "\n");
  for (const std::string& input : take.inputs) AppendInput(input, &text);
  return ToHex(ComputeSha256(text));
}

void WorkOnTake(CharacterService* service, const Session& session, const BatchJob& job,
                const BatchTake& take, int attempt, BatchRow* row) {
  // Many takes are read at the same time: what each of them says would be mixed.
  std::ostringstream unheard;
  Session quiet = session;
  quiet.out = quiet.err = &unheard;
  quiet.quiet = true;
  row->status = Work(service, quiet, job, take, attempt, row);
}

}  // namespace pleat
