// Every choice of a training run. All of them are written into the model file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "pleat/character/option_choices.h"
#include "pleat/character/placed_joints.h"

namespace pleat {

// The names and help texts of the choices are in option_choices.h.
struct TrainOptions {
  LearnerChoice learner = LearnerChoice::kAuto;  // auto: chosen on held-out training frames
  PoseFitMethod fit = PoseFitMethod::kAllJoints;
  RigRefinement refine = RigRefinement::kFull;
  int influences = 8;  // bones that may move a vertex after full refinement, 1..8
  // What is learned: what the mesh does beyond its skinned rig, or all deformation beyond the
  // motion of the root, with which the paper compares.
  DetailBase deformation = DetailBase::kSkinned;
  DetailAxes detail_axes = DetailAxes::kLocal;
  DetailCoordinates detail_coordinates = DetailCoordinates::kOffsets;
  RotationRepresentation rotations = RotationRepresentation::kExponentialMap;  // pose features
  int history = 2;                                       // poses per feature row, 1..8 (paper: 2)
  HistoryForm history_form = HistoryForm::kDifferences;  // how earlier poses enter the row
  double resolution_percent = 100;  // share of the vertices that learn, 1..100 (paper: 5)
  Upsampling upsampling = Upsampling::kRefined;
  int rest_frame = -1;             // the frame to rig, -1 = found automatically
  double yaw_degrees = -1;         // facing of the character about +y from +z, -1 = automatic
  double bend_stiffness = 0.0001;  // pose fit: pull of a bone to its parent, 0..1
  double smoothness = 0;           // pose fit: pull to the poses before and after, 0..1; 0 = none
  int latent_dimensions = 13;      // q of the SGPLVM, 1..32 (lost in the paper; its preset: 4)
  int iterations = 100;            // SCG iterations of the SGPLVM, 1..10000 (paper: 100)
  double dynamics_weight = 1;      // lambda on the GPDM term, 0..1e6 (paper: 1)
  double detail_energy = 0.99999;  // share of the details' energy that the PCA basis keeps, 0..1
  int max_components = 128;        // upper bound of the PCA basis, 1..1024
  uint64_t seed = 1;               // for everything random
  JumpPolicy jumps = JumpPolicy::kRefuse;  // of clips whose frames jump
  // Joints of the automatic rig that a person placed in the rest frame, in meters.
  std::vector<PlacedJoint> placed_joints = {};

  // The published settings: the SGPLVM on a control mesh of 5 %, the pose fit "walk" and world axes
  // (paper, section IV).
  static TrainOptions Paper();

  friend bool operator==(const TrainOptions&, const TrainOptions&) = default;
};

// Returns the name of every learner except "auto".
const std::vector<std::string>& LearnerNames();

// OK when every option is in the range above. kInvalidArgument names the option, its value and the
// range.
absl::Status ValidateTrainOptions(const TrainOptions& options);

// Returns one line "name=value" per option, in a fixed order. ParseTrainOptions restores exactly
// the same options from it.
// Options that came after version 1 of the model file have no line while they have their default,
// so that the bytes of models stay what they were.
std::string FormatTrainOptions(const TrainOptions& options);

// Parses such lines. Options that are not mentioned keep their defaults. kInvalidArgument names an
// option that is unknown, or a value that does not parse or is not known.
absl::StatusOr<TrainOptions> ParseTrainOptions(absl::string_view text);

// Calls visit(name, member&) for every option. Files, the wire, reports and flags share this one
// list. A member is an enum with ChoicesOf, an int, a double, a uint64_t or a list of placed
// joints.
template <typename Options, typename Visitor>
void VisitTrainOptions(Options& options, Visitor&& visit) {
  visit("learner", options.learner);
  visit("fit", options.fit);
  visit("refine", options.refine);
  visit("influences", options.influences);
  visit("deformation", options.deformation);
  visit("detail_axes", options.detail_axes);
  visit("detail_coordinates", options.detail_coordinates);
  visit("rotations", options.rotations);
  visit("history", options.history);
  visit("history_form", options.history_form);
  visit("resolution_percent", options.resolution_percent);
  visit("upsampling", options.upsampling);
  visit("rest_frame", options.rest_frame);
  visit("yaw_degrees", options.yaw_degrees);
  visit("bend_stiffness", options.bend_stiffness);
  visit("smoothness", options.smoothness);
  visit("latent_dimensions", options.latent_dimensions);
  visit("iterations", options.iterations);
  visit("dynamics_weight", options.dynamics_weight);
  visit("detail_energy", options.detail_energy);
  visit("max_components", options.max_components);
  visit("seed", options.seed);
  visit("jumps", options.jumps);
  visit("placed_joints", options.placed_joints);
}

}  // namespace pleat
