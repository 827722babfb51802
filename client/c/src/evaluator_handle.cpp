// A batch of a caller goes through three steps: each query's arguments are checked and copied into
// a slot of the evaluator, the queries that passed are answered together straight into the caller's
// rows, and then come normals and confidence. Slots keep their memory from batch to batch.
#include "evaluator_handle.h"

#include "error_report.h"
#include "model_handle.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status TakeQuery(const pleat_query& query, const CharacterModel& character, QuerySlot* slot,
                       PoseQuery* taken) {
  PLEAT_RETURN_IF_ERROR(CheckFlags(query));
  PLEAT_ASSIGN_OR_RETURN(const QueryTarget target, TakeTarget(query, character.num_vertices()));
  TakeScales(query, character.skeleton().num_joints(), slot);
  PLEAT_RETURN_IF_ERROR(TakePoses(query, character, slot));
  *taken = {.poses = &slot->pointers,
            .bone_scales = &slot->bone_scales,
            .skinned_only = IsSkinnedOnly(query),
            .frame = &slot->frame,
            .rows = target.positions};
  return absl::OkStatus();
}

// Answers the queries, which are `query_bytes` apart, and returns the first error.
absl::Status EvaluateAll(pleat_evaluator* evaluator, pleat_query* queries, size_t num_queries) {
  const size_t query_bytes = queries->struct_size;
  PLEAT_RETURN_IF_ERROR(CheckQuerySize(*queries));
  absl::Status first_error;
  const auto fail = [&](size_t number, absl::Status status, pleat_query* query) {
    query->code = static_cast<pleat_code>(status.code());
    if (first_error.ok()) first_error = WithContext(absl::StrCat("query ", number), status);
  };
  evaluator->accepted.clear();
  evaluator->asked.clear();
  for (size_t q = 0; q < num_queries; ++q) {
    auto* query =
        reinterpret_cast<pleat_query*>(reinterpret_cast<char*>(queries) + q * query_bytes);
    PoseQuery taken;
    absl::Status status = TakeQuery(*query, evaluator->character(),
                                    evaluator->SlotAt(evaluator->accepted.size()), &taken);
    if (!status.ok()) {
      fail(q, std::move(status), query);
      continue;
    }
    evaluator->accepted.push_back(taken);
    evaluator->asked.push_back(query);
  }
  evaluator->evaluator.EvaluateBatch(evaluator->accepted);
  for (size_t i = 0; i < evaluator->accepted.size(); ++i) {
    pleat_query* const query = evaluator->asked[i];
    const PoseQuery& answered = evaluator->accepted[i];
    if (answered.status.ok()) {
      PLEAT_ASSIGN_OR_RETURN(const QueryTarget target,  // it was checked before
                             TakeTarget(*query, evaluator->character().num_vertices()));
      Finish(evaluator->character(), target, answered.frame->confidence, query);
      continue;
    }
    const auto number =
        static_cast<size_t>(reinterpret_cast<char*>(query) - reinterpret_cast<char*>(queries)) /
        query_bytes;
    fail(number, answered.status, query);
  }
  return first_error;
}

// Evaluates the rest pose in every slot, which makes all memory that queries need.
absl::Status Reserve(pleat_evaluator* evaluator, size_t max_queries) {
  constexpr size_t kMostQueries = 4096;  // each has memory of its own
  if (max_queries > kMostQueries) {
    return absl::InvalidArgumentError(
        absl::StrCat("max_queries is ", max_queries, ", and ", kMostQueries, " at most"));
  }
  const CharacterModel& character = evaluator->character();
  const Pose rest = Pose::Rest(character.skeleton());
  const auto history = static_cast<size_t>(character.options().history);
  std::vector<float> positions(3 * static_cast<size_t>(character.num_vertices()));
  evaluator->accepted.clear();
  evaluator->accepted.reserve(max_queries);
  evaluator->asked.reserve(max_queries);
  for (size_t q = 0; q < max_queries; ++q) {
    QuerySlot* const slot = evaluator->SlotAt(q);
    slot->poses.assign(history, rest);
    slot->pointers.clear();
    for (const Pose& pose : slot->poses) slot->pointers.push_back(&pose);
    slot->bone_scales.assign(rest.rotations.size(), 1);
    evaluator->accepted.push_back({.poses = &slot->pointers,
                                   .bone_scales = &slot->bone_scales,
                                   .frame = &slot->frame,
                                   .rows = {.data = positions.data()}});
  }
  evaluator->evaluator.EvaluateBatch(evaluator->accepted);
  for (const PoseQuery& query : evaluator->accepted) PLEAT_RETURN_IF_ERROR(query.status);
  if (max_queries == 0) return absl::OkStatus();
  return evaluator->evaluator.Predict(evaluator->slots[0]->pointers, false, &evaluator->parameters);
}

}  // namespace
}  // namespace pleat

using pleat::Guarded;
using pleat::IsNull;

extern "C" {

pleat_code pleat_evaluator_create(const pleat_model* model, pleat_evaluator** evaluator,
                                  pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (evaluator == nullptr) return IsNull("evaluator");
    *evaluator = nullptr;
    if (model == nullptr) return IsNull("model");
    *evaluator = new pleat_evaluator(model->character);
    return absl::OkStatus();
  });
}

void pleat_evaluator_destroy(pleat_evaluator* evaluator) { delete evaluator; }

pleat_code pleat_evaluator_reserve(pleat_evaluator* evaluator, size_t max_queries,
                                   pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (evaluator == nullptr) return IsNull("evaluator");
    return pleat::Reserve(evaluator, max_queries);
  });
}

pleat_code pleat_evaluate(pleat_evaluator* evaluator, pleat_query* queries, size_t num_queries,
                          pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (evaluator == nullptr) return IsNull("evaluator");
    if (num_queries == 0) return absl::OkStatus();
    if (queries == nullptr) return IsNull("queries");
    return pleat::EvaluateAll(evaluator, queries, num_queries);
  });
}

}  // extern "C"
