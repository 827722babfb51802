// The names of joints as packages write them.
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "pleat/motion/landmarks.h"

namespace pleat {
namespace {

// What stands before the names of a package: mixamorig:, Bip01, J_Bip_L, DEF-, f_avg, ValveBiped.
constexpr std::array<std::string_view, 18> kPrefixes = {
    "mixamorig", "bip",  "biped",     "valvebiped", "j", "joint", "jnt", "def",  "org",
    "mch",       "ctrl", "character", "skel",       "m", "f",     "avg", "bone", "b"};
// Words that stand right after the letter of a side in old files: lfemur, rhand.
constexpr std::array<std::string_view, 18> kSidedWords = {
    "hipjoint", "femur", "tibia", "foot", "toes",   "toe",   "clavicle", "humerus",  "radius",
    "wrist",    "hand",  "thigh", "shin", "collar", "shldr", "forearm",  "upperarm", "calf"};

bool IsUpper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool IsLower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// Splits at everything that is no letter, and where the case shows that a word begins.
std::vector<std::string> SplitWords(std::string_view name) {
  std::vector<std::string> words;
  bool in_word = false;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!IsLetter(c)) {
      in_word = false;
      continue;
    }
    const bool after_lower = i > 0 && IsLower(name[i - 1]);
    const bool before_lower = i + 1 < name.size() && IsLower(name[i + 1]);
    const bool after_upper = i > 0 && IsUpper(name[i - 1]);
    const bool begins = IsUpper(c) && (after_lower || (after_upper && before_lower));
    if (!in_word || begins) words.emplace_back();
    in_word = true;
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

int SideOf(std::string_view word) {
  if (word == "left" || word == "l" || word == "lft" || word == "lt") return 1;
  if (word == "right" || word == "r" || word == "rgt" || word == "rt") return -1;
  return 0;
}

template <size_t N>
bool Contains(const std::array<std::string_view, N>& list, std::string_view word) {
  for (const std::string_view entry : list) {
    if (entry == word) return true;
  }
  return false;
}

}  // namespace

JointWord JointWordOf(std::string_view name) {
  const size_t space = name.find_last_of(":|");
  if (space != std::string_view::npos) name.remove_prefix(space + 1);
  JointWord result;
  bool at_front = true;
  for (const std::string& word : SplitWords(name)) {
    if (at_front && Contains(kPrefixes, word)) continue;
    const int side = SideOf(word);
    if (side != 0 && result.side == 0) {
      result.side = side;
      continue;  // prefixes may follow: J_Bip_L_UpperArm
    }
    at_front = false;
    result.word += word;
  }
  if (result.side != 0 || result.word.empty()) return result;
  for (const auto& [start, side] : {std::pair("left", 1), std::pair("right", -1)}) {
    const std::string_view prefix = start;
    if (result.word.size() <= prefix.size() || !result.word.starts_with(prefix)) continue;
    return {.word = result.word.substr(prefix.size()), .side = side};
  }
  const char first = result.word[0];
  if ((first == 'l' || first == 'r') && Contains(kSidedWords, result.word.substr(1))) {
    return {.word = result.word.substr(1), .side = first == 'l' ? 1 : -1};
  }
  return result;
}

}  // namespace pleat
