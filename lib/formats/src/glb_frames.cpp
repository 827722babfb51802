#include "glb_frames.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "frame_times.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

void AddFramesNote(NoteSeverity severity, const char* kind, std::string text, InputReport* report) {
  report->notes.push_back({.severity = severity, .kind = kind, .text = std::move(text)});
}

std::vector<float> TimesOfFrames(float begin, float end, FrameRate rate, int64_t max_frames) {
  const double num_steps = std::floor((double{end} - begin) * rate.fps() + 1e-3);
  const auto count = static_cast<int64_t>(std::min(num_steps, static_cast<double>(max_frames)));
  std::vector<float> times;
  for (int64_t i = 0; i <= count; ++i) {
    times.push_back(static_cast<float>(begin + static_cast<double>(i) / rate.fps()));
  }
  return times;
}

std::string AnimationName(const GlbContainer& glb, size_t index) {
  const json& entry = glb.Entry("animations", index);
  const auto name = entry.is_object() ? entry.find("name") : entry.end();
  return entry.is_object() && name != entry.end() && name->is_string() ? name->get<std::string>()
                                                                       : std::string();
}

// The number of the animation of that name, or the number that `wanted` is.
absl::StatusOr<size_t> NumberOfAnimation(const GlbContainer& glb, std::string_view wanted) {
  constexpr size_t kMaxListedAnimations = 12;
  const size_t count = glb.List("animations").size();
  std::string names;
  for (size_t i = 0; i < count; ++i) {
    const std::string name = AnimationName(glb, i);
    if (name == wanted) return i;
    if (i >= kMaxListedAnimations) continue;
    absl::StrAppend(&names, i > 0 ? ", " : "", i, " '", EscapeControls(name), "'");
  }
  size_t number = 0;
  if (absl::SimpleAtoi(absl::string_view(wanted.data(), wanted.size()), &number) &&
      number < count) {
    return number;
  }
  if (count > kMaxListedAnimations) absl::StrAppend(&names, ", ...");
  return absl::NotFoundError(absl::StrCat("GLB: no animation '",
                                          EscapeControls(std::string(wanted)), "' in ", count,
                                          count > 0 ? ": " : " animations", names));
}

}  // namespace

GlbFrames ChooseGlbFrames(const GlbAnimation& animation, const GlbFrameOptions& options,
                          InputReport* report) {
  const std::vector<float> keys = animation.KeyTimes();
  const std::optional<FrameRate>& wanted = options.frame_rate;
  std::optional<FrameRate> even = RateOfFloatTimes(keys);
  const std::optional<FrameRate> said = animation.frame_rate();
  if (even && said && std::abs(even->fps() / said->fps() - 1) < 1e-3) even = said;
  report->has_frame_rate = even.has_value();
  if ((even && wanted.value_or(*even) == *even) || keys.size() == 1) {
    return {keys, wanted.value_or(even.value_or(FrameRate{}))};
  }
  const std::optional<FrameRate> between = RateOfKeys(keys);
  report->has_frame_rate = even || between;
  const FrameRate rate = wanted.value_or(even ? *even : between.value_or(FrameRate{}));
  if (!wanted && !between) {
    AddFramesNote(
        NoteSeverity::kWarning, "frame_rate_assumed",
        absl::StrFormat("the keys lie at the frames of no usual rate; %g frames per second "
                        "are taken, say --fps for another rate",
                        rate.fps()),
        report);
  } else {
    AddFramesNote(NoteSeverity::kNote, "animation_sampled",
                  absl::StrFormat("its %d keys are sampled at %g frames per second%s", keys.size(),
                                  rate.fps(), wanted ? "" : ", at whose frames they lie"),
                  report);
  }
  return {TimesOfFrames(keys.front(), keys.back(), rate, options.max_frames), rate};
}

absl::StatusOr<std::optional<GlbAnimation>> ChooseGlbAnimation(const GlbContainer& glb,
                                                               const GlbNodes& nodes,
                                                               std::string_view wanted,
                                                               InputReport* report) {
  if (!wanted.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const size_t number, NumberOfAnimation(glb, wanted));
    PLEAT_ASSIGN_OR_RETURN(GlbAnimation animation, GlbAnimation::Read(glb, nodes, number));
    if (animation.num_channels() > 0) return std::optional(std::move(animation));
    return GlbFault(
        absl::StrCat("animation '", EscapeControls(std::string(wanted)), "' moves nothing"));
  }
  const size_t count = glb.List("animations").size();
  for (size_t i = 0; i < count; ++i) {
    PLEAT_ASSIGN_OR_RETURN(GlbAnimation animation, GlbAnimation::Read(glb, nodes, i));
    if (animation.num_channels() == 0) continue;
    if (count > 1) {
      AddFramesNote(
          NoteSeverity::kWarning, "animations_left_out",
          absl::StrCat("the file holds ", count, " animations; number ", i, " '",
                       EscapeControls(AnimationName(glb, i)),
                       "' is read; --animation, with a name or a number, reads another one"),
          report);
    }
    return std::optional(std::move(animation));
  }
  return std::optional<GlbAnimation>();
}

}  // namespace pleat
