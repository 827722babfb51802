// compress INPUT -o x.plt: writes a mesh sequence as a small file with a promised error.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "cli/io/input.h"
#include "cli/io/output_path.h"
#include "cli/service.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/report_json.h"
#include "cli/show/text_table.h"
#include "cli/verbs/compress_flags.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/service/compression.h"

namespace pleat {
namespace {

struct CompressVerbOptions {
  std::string input, output, report, fps;
  CompressFlags goal;
  int num_threads = 0;
};

struct Compressed {
  std::string bytes;
  CompressionRecord record;
};

absl::StatusOr<Compressed> CompressHere(const MeshSequence& sequence,
                                        const CompressOptions& options, const Session& session) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(MeasuredCompression result,
                         CompressMeasured(sequence, options, InterruptibleProgress(&display)));
  return Compressed{std::move(result.bytes), std::move(result.record)};
}

absl::StatusOr<Compressed> CompressOnService(const MeshSequence& sequence,
                                             const CompressOptions& options,
                                             const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const SequenceInfo uploaded,
                         UploadWithProgress(service->sequences(), sequence, session));
  PLEAT_ASSIGN_OR_RETURN(const JobInfo job, service->jobs().CreateCompression(
                                                {.sequence_id = uploaded.id, .options = options}));
  PLEAT_ASSIGN_OR_RETURN(const JobInfo done,
                         WatchJobToEnd(service->jobs(), job.id, session, true, nullptr));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(
      std::string bytes,
      service->compressed_sequences().Download(
          done.result_id, InterruptibleProgress(&display).Stage("download", 0, 1)));
  PLEAT_ASSIGN_OR_RETURN(CompressedSequenceInfo info,
                         service->compressed_sequences().Get(done.result_id));
  if (!info.record) return absl::InternalError("the service kept no report of the compression");
  return Compressed{std::move(bytes), *std::move(info.record)};
}

void PrintText(const CompressVerbOptions& flags, const MeshSequence& sequence,
               const CompressionRecord& record, std::ostream& out) {
  const CompressSummary& summary = record.summary;
  const double raw_bytes = 12.0 * sequence.num_vertices() * sequence.num_frames();
  out << absl::StrFormat(
      "%s: %s, 1/%.0f of its positions as float32; %.3f bits per vertex and frame\n"
      "error: KG %.4g %%, largest %.4g mm; encoded in %.1f s, decodes at %.0f frames/s\n",
      flags.output, FormatBytes(static_cast<double>(summary.num_bytes)),
      raw_bytes / static_cast<double>(summary.num_bytes), summary.bpvf, summary.kg_percent,
      summary.max_error_mm, record.encode_seconds, sequence.num_frames() / record.decode_seconds);
}

absl::Status RunCompress(const CompressVerbOptions& flags, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(CompressOptions options, ResolveCompressFlags(flags.goal));
  options.num_threads = flags.num_threads;
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(
      session, {{"-o", flags.output, {".plt"}}, {"--report", flags.report, {".json"}}}));
  std::vector<InputNote> notes;
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         ReadInput(session, flags.input, flags.fps, &notes));
  PLEAT_ASSIGN_OR_RETURN(const Compressed compressed,
                         RunsOnService(session) ? CompressOnService(sequence, options, session)
                                                : CompressHere(sequence, options, session));
  PLEAT_RETURN_IF_ERROR(WriteFile(flags.output, compressed.bytes));
  nlohmann::ordered_json json =
      CompressReportJson(compressed.record, sequence.num_frames(), sequence.num_vertices());
  json["input_notes"] = InputNotesJson(notes);
  if (!flags.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(flags.report, JsonText(json)));
  }
  if (session.json) {
    *session.out << JsonText(json);
  } else {
    PrintText(flags, sequence, compressed.record, *session.out);
  }
  return absl::OkStatus();
}

}  // namespace

void AddCompressVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompressVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "compress", "make an animation small, with a promised error",
              [options, &session] { return RunCompress(*options, session); });
  verb->add_option("INPUT", options->input, "any animation that pleat reads")->required();
  verb->add_option("-o,--output", options->output, "the compressed sequence, OUT.plt")->required();
  AddCompressFlags(verb, &options->goal);
  verb->add_option("--report", options->report, "JSON report (pleat.compress/1)");
  verb->add_option("--fps", options->fps, "frames per second, where the input does not say");
  AddObjectFlag(verb, session);
  verb->add_option("--threads", options->num_threads,
                   "in this process: 0 = one per core; the result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddForceFlag(verb, session);
  AddOptionalServerFlags(verb, session);
}

}  // namespace pleat
