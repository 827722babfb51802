// inspect INPUT: shows what a sequence holds, before anything is computed.
#include <Eigen/Geometry>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "cli/io/frame_rate.h"
#include "cli/io/input.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/json_text.h"
#include "cli/show/mesh_report_json.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/mesh_report.h"

namespace pleat {
namespace {

struct InspectOptions {
  std::string input, fps;
};

Eigen::AlignedBox3d BoundsOfAllFrames(const MeshSequence& sequence) {
  Eigen::AlignedBox3d bounds;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    bounds.extend(ComputeBounds(sequence.FrameAsDouble(t)));
  }
  return bounds;
}

nlohmann::ordered_json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// What the verb finds out, for both forms of output.
struct Findings {
  Eigen::AlignedBox3d bounds;  // the bounds of all frames, meters
  double diagonal_m = 0;       // the diagonal of frame 0
  MeshReport report;           // the report on frame 0
  std::vector<InputNote> notes;
};

void PrintJson(const MeshSequence& sequence, const Findings& findings, std::ostream& out) {
  nlohmann::ordered_json json;
  json["schema"] = "pleat.inspect/1";
  json["name"] = sequence.name();
  json["num_frames"] = sequence.num_frames();
  json["num_vertices"] = sequence.num_vertices();
  json["num_faces"] = sequence.topology().num_faces();
  json["num_triangles"] = sequence.topology().num_triangles();
  json["fps"] = sequence.frame_rate().fps();
  json["frame_rate"] = FormatFrameRate(sequence.frame_rate());
  json["diagonal_m"] = findings.diagonal_m;
  json["bounds"] = {{"min_m", VectorJson(findings.bounds.min())},
                    {"max_m", VectorJson(findings.bounds.max())}};
  json["sequence_id"] = SequenceId(EncodeSequence(sequence));
  json["mesh_report"] = MeshReportJson(findings.report);
  json["input_notes"] = InputNotesJson(findings.notes);
  out << JsonText(json);
}

void PrintText(const MeshSequence& sequence, const Findings& findings, std::ostream& out) {
  const Eigen::Vector3d size = findings.bounds.sizes(), low = findings.bounds.min();
  out << absl::StrFormat("name        %s\n", EscapeControls(sequence.name()))
      << absl::StrFormat("frames      %d at %s per second, %.2f s\n", sequence.num_frames(),
                         FormatFrameRate(sequence.frame_rate()),
                         sequence.num_frames() / sequence.frame_rate().fps())
      << absl::StrFormat("mesh        %d vertices, %d faces (%d triangles), %s\n",
                         sequence.num_vertices(), sequence.topology().num_faces(),
                         sequence.topology().num_triangles(),
                         findings.report.closed() ? "closed" : "open")
      << absl::StrFormat("components  %d\n", findings.report.num_components)
      << absl::StrFormat("materials   %d, texture coordinates %d\n",
                         sequence.appearance().material_names.size(),
                         sequence.appearance().texcoords.size())
      << absl::StrFormat("frame 0     diagonal %.3f m (errors in %% are of this)\n",
                         findings.diagonal_m)
      << absl::StrFormat("all frames  %.3f x %.3f x %.3f m from (%.3f, %.3f, %.3f)\n", size.x(),
                         size.y(), size.z(), low.x(), low.y(), low.z());
  for (const std::string& fault : DescribeFaults(findings.report)) {
    out << absl::StrFormat("unclean     %s\n", fault);
  }
}

absl::Status RunInspect(const InspectOptions& options, const Session& session) {
  std::vector<InputNote> notes;
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         ReadInput(session, options.input, options.fps, &notes));
  const Findings findings = {BoundsOfAllFrames(sequence), BoundsDiagonal(sequence.FrameAsDouble(0)),
                             InspectMesh(sequence.topology(), sequence.FrameAsDouble(0)),
                             std::move(notes)};
  if (session.json) {
    PrintJson(sequence, findings, *session.out);
  } else {
    PrintText(sequence, findings, *session.out);
  }
  return absl::OkStatus();
}

}  // namespace

void AddInspectVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* verb = AddVerb(app, session, "inspect", "read a sequence and say what it holds",
                           [options, &session] { return RunInspect(*options, session); });
  verb->add_option("INPUT", options->input, "any animation that pleat reads")->required();
  verb->add_option("--fps", options->fps, "frames per second, where the input does not say");
  AddObjectFlag(verb, session);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
