// Motions as JSON values, for files that hold more than one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pleat/formats/motion_file.h"

namespace pleat {

nlohmann::ordered_json MotionToJson(const Skeleton& skeleton, const PoseTrack& track,
                                    const std::vector<double>& bone_scales);
// With everything that the motion has, and with the skeleton.
nlohmann::ordered_json MotionToJson(const Skeleton& skeleton, const Motion& motion);
// The text as all motion files have it.
std::string DumpMotion(const nlohmann::ordered_json& root);

}  // namespace pleat
