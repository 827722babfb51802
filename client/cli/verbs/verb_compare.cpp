// compare A B: measures the error between two animations of one connectivity.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/io/input.h"
#include "cli/show/error_text.h"
#include "cli/show/json_text.h"
#include "cli/show/report_json.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/error_metrics.h"

namespace pleat {
namespace {

struct CompareOptions {
  std::string input, reference;
};

absl::StatusOr<ErrorSummary> Compare(const MeshSequence& input, const MeshSequence& reference,
                                     double diagonal_m) {
  if (input.num_vertices() != reference.num_vertices() ||
      input.num_frames() != reference.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the inputs do not correspond: ", input.num_frames(), " frames of ", input.num_vertices(),
        " vertices against ", reference.num_frames(), " of ", reference.num_vertices()));
  }
  ErrorAccumulator errors(diagonal_m);
  for (int t = 0; t < input.num_frames(); ++t) {
    errors.AddFrame(input.FrameAsDouble(t), reference.FrameAsDouble(t));
  }
  return errors.Summarize();
}

absl::Status RunCompare(const CompareOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence input, ReadInput(session, options.input));
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence reference, ReadInput(session, options.reference));
  const double diagonal_m = BoundsDiagonal(reference.FrameAsDouble(0));
  PLEAT_ASSIGN_OR_RETURN(const ErrorSummary error, Compare(input, reference, diagonal_m));
  if (session.json) {
    nlohmann::ordered_json report;
    report["schema"] = "pleat.compare/1";
    report["diagonal_m"] = diagonal_m;
    report["num_frames"] = input.num_frames();
    report["error"] = ErrorJson(error);
    *session.out << JsonText(report);
    return absl::OkStatus();
  }
  *session.out << FormatTable(ErrorTableHeader("error"),
                              {ErrorTableRow("difference", error, diagonal_m)})
               << absl::StrFormat("%% of the diagonal of frame 0 of %s, %.3f m\n",
                                  options.reference, diagonal_m);
  return absl::OkStatus();
}

}  // namespace

void AddCompareVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* verb =
      AddVerb(app, session, "compare", "distances between corresponding vertices of two animations",
              [options, &session] { return RunCompare(*options, session); });
  AddObjectFlag(verb, session);
  verb->add_option("INPUT", options->input, "the animation to judge")->required();
  verb->add_option("REFERENCE", options->reference, "the truth; percents are of its diagonal")
      ->required();
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
