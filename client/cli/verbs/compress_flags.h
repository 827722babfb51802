// The promise of a compression on the command line.
#pragma once

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "pleat/sequence_codec/compress_sequence.h"

namespace pleat {

struct CompressFlags {
  double max_error_mm = 0, kg_percent = 0;  // 0: not given
  int grid_bits = 0;
  bool any_face_order = false;

  bool any_goal() const { return max_error_mm != 0 || kg_percent != 0 || grid_bits != 0; }
};

// Adds --max-error-mm, --kg, --lossless-at-bits and --any-face-order.
void AddCompressFlags(CLI::App* verb, CompressFlags* flags);

// A usage error unless exactly one goal was given.
absl::StatusOr<CompressOptions> ResolveCompressFlags(const CompressFlags& flags);

}  // namespace pleat
