// What a pleat_evaluator is on this side of the boundary.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pleat.h"
#include "pleat/character/pose_evaluator.h"
#include "query_argument.h"

struct pleat_evaluator {
  explicit pleat_evaluator(std::shared_ptr<const pleat::CharacterModel> character)
      : evaluator(std::move(character)) {}

  const pleat::CharacterModel& character() const { return evaluator.model(); }

  pleat::QuerySlot* SlotAt(size_t number) {
    while (slots.size() <= number) slots.push_back(std::make_unique<pleat::QuerySlot>());
    return slots[number].get();
  }

  pleat::PoseEvaluator evaluator;
  std::vector<std::unique_ptr<pleat::QuerySlot>> slots;
  std::vector<pleat::PoseQuery> accepted;  // the queries of a batch that passed their checks
  std::vector<pleat_query*> asked;         // accepted[i] answers asked[i]
  pleat::FrameParameters parameters;
};
