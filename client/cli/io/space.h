// Units and axes of animations: what an input is in, what an output shall be in, and what packages
// expect.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

enum class UpAxis { kY, kZ };

// Meters with Y up unless something else is said, as everywhere in Pleat.
struct Space {
  double unit_m = 1;
  UpAxis up = UpAxis::kY;
  friend bool operator==(const Space&, const Space&) = default;
};

// "m", "cm", "mm", "km", "in", "ft", "yd", or meters as a number ("0.0254"). A usage error
// otherwise.
absl::StatusOr<double> ParseUnit(const std::string& flag, const std::string& text);
// "y" or "z".
absl::StatusOr<UpAxis> ParseUp(const std::string& flag, const std::string& text);
// "meters, Y up".
std::string DescribeSpace(const Space& space);

// What a package takes files to be in, and the endings that it reads by itself.
struct PackagePreset {
  std::string name;
  Space space;
  std::vector<std::string> endings;
};
const std::vector<PackagePreset>& PackagePresets();
// A usage error names the known packages.
absl::StatusOr<PackagePreset> FindPackage(const std::string& name);

// The sequence in another space: each position is computed in double precision and rounded once.
// The same sequence, bit by bit, where the spaces are equal.
absl::StatusOr<MeshSequence> InSpace(const MeshSequence& sequence, const Space& from,
                                     const Space& to);

}  // namespace pleat
