#include "cli/verbs/compress_flags.h"

#include "cli/exit_code.h"

namespace pleat {

void AddCompressFlags(CLI::App* verb, CompressFlags* flags) {
  verb->add_option("--max-error-mm", flags->max_error_mm,
                   "no vertex of any frame is further off than this, mm")
      ->check(CLI::Range(1e-3, 1e6));
  verb->add_option("--kg", flags->kg_percent,
                   "the error of all positions is at most PERCENT of their spread about each "
                   "frame's centroid (Karni and Gotsman)")
      ->check(CLI::Range(1e-4, 50.0));
  verb->add_option(
          "--lossless-at-bits", flags->grid_bits,
          "positions are exact on a grid of 2^B points along the longest side of the bounds")
      ->check(CLI::Range(8, 20));
  verb->add_flag("--any-face-order", flags->any_face_order,
                 "faces may change their order (vertices never do): about 1.5 bytes less per face");
}

absl::StatusOr<CompressOptions> ResolveCompressFlags(const CompressFlags& flags) {
  CompressOptions options;
  options.keep_face_order = !flags.any_face_order;
  const int given = (flags.max_error_mm != 0) + (flags.kg_percent != 0) + (flags.grid_bits != 0);
  if (given != 1) {
    return UsageError("say one of --max-error-mm E, --kg PERCENT and --lossless-at-bits B");
  }
  if (flags.max_error_mm != 0) {
    options.goal = CompressionGoal::kMaxError;
    options.max_error_mm = flags.max_error_mm;
  } else if (flags.kg_percent != 0) {
    options.goal = CompressionGoal::kKg;
    options.kg_percent = flags.kg_percent;
  } else {
    options.goal = CompressionGoal::kGrid;
    options.grid_bits = flags.grid_bits;
  }
  return options;
}

}  // namespace pleat
