// A character for the shader of a page: what it takes to turn the parameters of a frame into the
// mesh (docs/formats/page_character.md).
#pragma once

#include <cstdint>
#include <string>

#include "pleat/character/character_model.h"

namespace pleat {

// How many bytes EncodePageCharacter returns, nearly; never less.
uint64_t PageCharacterBytes(const CharacterModel& model);

std::string EncodePageCharacter(const CharacterModel& model);

}  // namespace pleat
