#include "cli/show/retarget_report.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/show/text_table.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

nlohmann::ordered_json SlidingJson(const FootSliding& sliding) {
  return {{"contact_frames", sliding.num_frames},
          {"mean_mm_per_frame", sliding.mean_mm},
          {"max_mm_per_frame", sliding.max_mm}};
}

std::string SlidingText(const FootSliding& sliding) {
  return absl::StrFormat("%.2f mm per contact frame (at most %.1f)", sliding.mean_mm,
                         sliding.max_mm);
}

}  // namespace

std::string RetargetText(const RetargetSummary& summary) {
  const RetargetReport& report = summary.report;
  std::string text = absl::StrFormat(
      "%s: %d frames at %.6g fps of %d joints; lengths as of a person in %s (%.4g from tip to "
      "tip), %s up; scaled by %.4g to legs of %.3f m\n",
      EscapeControls(summary.source), summary.num_frames, summary.fps, summary.num_joints,
      report.unit.name, report.unit.size, report.up == ClipUp::kZ ? "Z" : "Y", report.scale,
      report.leg_length_m);
  absl::StrAppend(&text, report.rest_stands
                             ? "its rest is a standing body\n"
                             : "its rest is no standing body: twists are solved from its motion\n");
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> unmapped;
  for (const JointMapEntry& entry : summary.map.joints) {
    if (entry.from.empty()) {
      unmapped.push_back(EscapeControls(entry.joint));
      continue;
    }
    rows.push_back({EscapeControls(entry.joint), EscapeControls(entry.from),
                    EscapeControls(entry.turns_with),
                    std::string(BoneAlignmentName(entry.alignment))});
  }
  absl::StrAppend(&text, FormatTable({"joint", "from", "turns with", "align"}, rows));
  if (!unmapped.empty()) {
    absl::StrAppend(&text, "follow the bone above: ", absl::StrJoin(unmapped, ", "), "\n");
  }
  if (!summary.map.left_out.empty()) {
    absl::StrAppend(&text, "left out: ", EscapeControls(absl::StrJoin(summary.map.left_out, ", ")),
                    "\n");
  }
  absl::StrAppend(&text, "feet slide by ", SlidingText(report.clip_sliding), " in the clip, ",
                  SlidingText(report.sliding), " in the motion");
  if (summary.feet) {
    absl::StrAppend(
        &text, ", ", SlidingText(summary.feet->after),
        absl::StrFormat(" cleaned: ankles move by up to %.0f mm, the root sinks by up "
                        "to %.0f mm, %d frames out of reach",
                        1000 * summary.feet->max_move_m, 1000 * summary.feet->max_lowering_m,
                        summary.feet->num_unreached_frames));
  }
  return text + "\n";
}

nlohmann::ordered_json RetargetJson(const RetargetSummary& summary) {
  const RetargetReport& report = summary.report;
  nlohmann::ordered_json json = {{"clip_frames", summary.num_frames},
                                 {"clip_joints", summary.num_joints},
                                 {"fps", summary.fps},
                                 {"unit", report.unit.name},
                                 {"up", ClipUpName(report.up)},
                                 {"scale", report.scale},
                                 {"leg_length_m", report.leg_length_m},
                                 {"rest_stands", report.rest_stands},
                                 {"mapped", nlohmann::ordered_json::array()},
                                 {"unmapped", nlohmann::ordered_json::array()},
                                 {"left_out", nlohmann::ordered_json::array()}};
  for (const JointMapEntry& entry : summary.map.joints) {
    if (entry.from.empty()) {
      json["unmapped"].push_back(ToValidUtf8(entry.joint));
      continue;
    }
    json["mapped"].push_back({{"joint", ToValidUtf8(entry.joint)},
                              {"from", ToValidUtf8(entry.from)},
                              {"turns_with", ToValidUtf8(entry.turns_with)},
                              {"align", BoneAlignmentName(entry.alignment)}});
  }
  for (const std::string& name : summary.map.left_out) {
    json["left_out"].push_back(ToValidUtf8(name));
  }
  json["sliding"] = {{"clip", SlidingJson(report.clip_sliding)},
                     {"motion", SlidingJson(report.sliding)}};
  if (!summary.feet) return json;
  json["sliding"]["cleaned"] = SlidingJson(summary.feet->after);
  json["cleaning"] = {{"max_move_mm", 1000 * summary.feet->max_move_m},
                      {"max_lowering_mm", 1000 * summary.feet->max_lowering_m},
                      {"unreached_frames", summary.feet->num_unreached_frames}};
  return json;
}

}  // namespace pleat
