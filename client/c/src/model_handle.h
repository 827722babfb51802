// What a pleat_model is on this side of the boundary.
#pragma once

#include <memory>

#include "pleat.h"
#include "pleat/character/character_model.h"

struct pleat_model {
  std::shared_ptr<const pleat::CharacterModel> character;
};
