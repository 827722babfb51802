// What retargeting did, for people and programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "pleat/formats/joint_clip.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/motion/clean_feet.h"
#include "pleat/motion/retarget.h"

namespace pleat {

struct RetargetSummary {
  std::string source;                     // as the user gave it
  size_t num_frames = 0, num_joints = 0;  // of the clip, ends included
  double fps = 30;
  JointMap map;
  RetargetReport report;
  std::optional<CleanFeetSummary> feet{};  // where they were cleaned
};

// Several lines: units, the table of joints, what was left out, how far feet slide.
std::string RetargetText(const RetargetSummary& summary);
nlohmann::ordered_json RetargetJson(const RetargetSummary& summary);

}  // namespace pleat
