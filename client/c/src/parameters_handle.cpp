// The two halves of a query, for two machines.
#include <algorithm>

#include "error_report.h"
#include "evaluator_handle.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckParameters(const pleat_parameters& parameters, const CharacterModel& character) {
  PLEAT_RETURN_IF_ERROR(
      CheckStructSize("pleat_parameters", parameters.struct_size, sizeof(pleat_parameters)));
  if (parameters.rotations == nullptr) return IsNull("rotations of the parameters");
  if (parameters.num_joints != static_cast<size_t>(character.skeleton().num_joints())) {
    return absl::InvalidArgumentError(absl::StrCat("the parameters have ", parameters.num_joints,
                                                   " joints, the model has ",
                                                   character.skeleton().num_joints()));
  }
  return absl::OkStatus();
}

absl::Status CheckCoefficients(const pleat_parameters& parameters,
                               const CharacterModel& character) {
  const auto count = static_cast<size_t>(character.full_basis().num_coefficients());
  if (parameters.num_coefficients != count) {
    return absl::InvalidArgumentError(absl::StrCat(parameters.num_coefficients,
                                                   " detail coefficients for a model of ", count,
                                                   "; is it another model?"));
  }
  if (count > 0 && parameters.coefficients == nullptr) return IsNull("coefficients");
  return absl::OkStatus();
}

absl::Status PredictOne(pleat_evaluator* evaluator, pleat_query* query,
                        pleat_parameters* parameters) {
  const CharacterModel& character = evaluator->character();
  PLEAT_RETURN_IF_ERROR(CheckFlags(*query));
  PLEAT_RETURN_IF_ERROR(CheckParameters(*parameters, character));
  const bool skinned_only = IsSkinnedOnly(*query);
  if (!skinned_only) PLEAT_RETURN_IF_ERROR(CheckCoefficients(*parameters, character));
  QuerySlot* const slot = evaluator->SlotAt(0);
  PLEAT_RETURN_IF_ERROR(TakePoses(*query, character, slot));
  FrameParameters& found = evaluator->parameters;
  PLEAT_RETURN_IF_ERROR(evaluator->evaluator.Predict(slot->pointers, skinned_only, &found));
  std::copy_n(found.pose.root_position.data(), 3, parameters->root_position);
  for (size_t j = 0; j < parameters->num_joints; ++j) {
    Eigen::Map<Eigen::Vector4f>(parameters->rotations + 4 * j) =
        found.pose.rotations[j].coeffs().cast<float>();
  }
  parameters->num_coefficients = static_cast<size_t>(found.coefficients.size());
  std::copy(found.coefficients.begin(), found.coefficients.end(), parameters->coefficients);
  parameters->confidence = query->confidence = found.confidence;
  return absl::OkStatus();
}

absl::Status ShowOne(pleat_evaluator* evaluator, const pleat_parameters& parameters,
                     pleat_query* query) {
  const CharacterModel& character = evaluator->character();
  PLEAT_RETURN_IF_ERROR(CheckFlags(*query));
  PLEAT_RETURN_IF_ERROR(CheckParameters(parameters, character));
  if (parameters.num_coefficients > 0) {
    PLEAT_RETURN_IF_ERROR(CheckCoefficients(parameters, character));
  }
  PLEAT_ASSIGN_OR_RETURN(const QueryTarget target, TakeTarget(*query, character.num_vertices()));
  QuerySlot* const slot = evaluator->SlotAt(0);
  TakeScales(*query, character.skeleton().num_joints(), slot);
  FrameParameters& given = evaluator->parameters;
  given.pose.root_position = Eigen::Map<const Eigen::Vector3d>(parameters.root_position);
  given.pose.rotations.resize(parameters.num_joints);
  for (size_t j = 0; j < parameters.num_joints; ++j) {
    given.pose.rotations[j].coeffs() =
        Eigen::Map<const Eigen::Vector4f>(parameters.rotations + 4 * j).cast<double>();
  }
  given.coefficients.resize(static_cast<Eigen::Index>(parameters.num_coefficients));
  std::copy_n(parameters.coefficients, parameters.num_coefficients, given.coefficients.data());
  given.confidence = parameters.confidence;
  PLEAT_RETURN_IF_ERROR(
      evaluator->evaluator.Show(given, slot->bone_scales, &slot->frame, target.positions));
  Finish(character, target, slot->frame.confidence, query);
  return absl::OkStatus();
}

// Runs `half` on arguments that are there, and writes the code of the query, whose size is known
// before anything else of it is touched.
template <typename Half>
pleat_code Answer(pleat_evaluator* evaluator, const pleat_parameters* parameters,
                  pleat_query* query, pleat_error* error, Half&& half) noexcept {
  return Guarded(error, [&]() -> absl::Status {
    if (evaluator == nullptr) return IsNull("evaluator");
    if (parameters == nullptr) return IsNull("parameters");
    if (query == nullptr) return IsNull("query");
    PLEAT_RETURN_IF_ERROR(CheckQuerySize(*query));
    query->code = PLEAT_INTERNAL;  // what an exception leaves behind
    absl::Status status = half();
    query->code = static_cast<pleat_code>(status.code());
    return status;
  });
}

}  // namespace
}  // namespace pleat

extern "C" {

pleat_code pleat_predict(pleat_evaluator* evaluator, pleat_query* query,
                         pleat_parameters* parameters, pleat_error* error) {
  return pleat::Answer(evaluator, parameters, query, error,
                       [&] { return pleat::PredictOne(evaluator, query, parameters); });
}

pleat_code pleat_show(pleat_evaluator* evaluator, const pleat_parameters* parameters,
                      pleat_query* query, pleat_error* error) {
  return pleat::Answer(evaluator, parameters, query, error,
                       [&] { return pleat::ShowOne(evaluator, *parameters, query); });
}

}  // extern "C"
