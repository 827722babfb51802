// Khronos, glTF 2.0 specification, section 3.11 and appendix C (interpolation).
#include "glb_animation.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

// Times that are read and sorted. The longest captures have some million.
constexpr size_t kMaxKeys = 50'000'000;
constexpr size_t kMaxChannels = 1'000'000;

absl::Status AnimationFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: ", what));
}

std::string TextOf(const json& object, const char* key, const char* otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

Eigen::Quaterniond QuaternionOf(const double* values) {
  return {values[3], values[0], values[1], values[2]};
}

}  // namespace

absl::StatusOr<GlbAnimation> GlbAnimation::Read(const GlbContainer& glb, const GlbNodes& nodes,
                                                size_t index) {
  GlbAnimation animation;
  const json& entry = glb.Entry("animations", index);
  const auto channels = entry.is_object() ? entry.find("channels") : entry.end();
  const auto samplers = entry.is_object() ? entry.find("samplers") : entry.end();
  if (!entry.is_object() || channels == entry.end() || samplers == entry.end()) return animation;
  if (!channels->is_array() || !samplers->is_array() || channels->size() > kMaxChannels) {
    return AnimationFault(absl::StrCat("animation ", index, " has no list of channels"));
  }
  for (size_t c = 0; c < channels->size(); ++c) {
    absl::Status status = animation.ReadChannel(glb, nodes, (*channels)[c], *samplers);
    if (!status.ok()) {
      return WithContext(absl::StrCat("animation ", index, ", channel ", c), status);
    }
  }
  const json extras = entry.value("extras", json());
  const json rate = extras.is_object() ? extras.value("frame_rate", json()) : json();
  const auto is_count = [](const json& number) {
    return number.is_number_integer() && number > 0 && number <= 2147483647;
  };
  if (rate.is_array() && rate.size() == 2 && is_count(rate[0]) && is_count(rate[1])) {
    animation.frame_rate_ = FrameRate{rate[0].get<int32_t>(), rate[1].get<int32_t>()};
  }
  return animation;
}

absl::Status GlbAnimation::ReadChannel(const GlbContainer& glb, const GlbNodes& nodes,
                                       const json& channel, const json& samplers) {
  const json target = channel.is_object() ? channel.value("target", json()) : json();
  if (!target.is_object()) return AnimationFault("it has no target");
  const json node = target.value("node", json());
  const std::string path = TextOf(target, "path", "");
  constexpr std::string_view kPaths[] = {"translation", "rotation", "scale", "weights"};
  const auto known = std::ranges::find(kPaths, std::string_view(path));
  // Extensions drive other things; a channel without a node drives nothing.
  if (node.is_null() || known == std::end(kPaths)) return absl::OkStatus();
  if (!node.is_number_integer() || node < 0 || node >= nodes.count()) {
    return AnimationFault("its node is missing");
  }
  Channel result{.node = node.get<int>(), .path = static_cast<Path>(known - kPaths)};
  const json index = channel.value("sampler", json());
  if (!index.is_number_integer() || index < 0 || index >= samplers.size() ||
      !samplers[index.get<size_t>()].is_object()) {
    return AnimationFault("its sampler is missing");
  }
  PLEAT_RETURN_IF_ERROR(ReadSampler(glb, samplers[index.get<size_t>()], &result));
  channels_.push_back(std::move(result));
  return absl::OkStatus();
}

absl::Status GlbAnimation::ReadSampler(const GlbContainer& glb, const json& sampler,
                                       Channel* channel) {
  const std::string interpolation = TextOf(sampler, "interpolation", "LINEAR");
  channel->interpolation = interpolation == "STEP"          ? Interpolation::kStep
                           : interpolation == "CUBICSPLINE" ? Interpolation::kCubic
                                                            : Interpolation::kLinear;
  PLEAT_ASSIGN_OR_RETURN(channel->times, ReadTimes(glb, sampler.value("input", json())));
  const bool is_weights = channel->path == Path::kWeights;
  channel->components = is_weights ? 1 : channel->path == Path::kRotation ? 4 : 3;
  const char* type = is_weights ? "SCALAR" : channel->components == 4 ? "VEC4" : "VEC3";
  PLEAT_ASSIGN_OR_RETURN(channel->values, glb.Access(sampler.value("output", json()), type));
  const size_t per_time = channel->interpolation == Interpolation::kCubic ? 3 : 1;
  const size_t num_elements = channel->times->size() * per_time;
  const size_t targets = is_weights ? channel->values.count() / num_elements : 1;
  if (targets == 0 || channel->values.count() != num_elements * targets) {
    return AnimationFault(absl::StrCat("it has ", channel->times->size(), " times and ",
                                       channel->values.count(), " values, which do not fit"));
  }
  channel->num_values = is_weights ? targets : static_cast<size_t>(channel->components);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const std::vector<float>>> GlbAnimation::ReadTimes(
    const GlbContainer& glb, const json& index) {
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor accessor, glb.Access(index, "SCALAR"));
  const auto number = index.get<size_t>();
  for (const auto& [known, times] : times_) {
    if (known == number) return times;
  }
  num_keys_ += accessor.count();
  if (num_keys_ > kMaxKeys) {
    return absl::ResourceExhaustedError(
        absl::StrCat("GLB: more than ", kMaxKeys, " keys of an animation"));
  }
  auto times = std::make_shared<const std::vector<float>>(accessor.CopyFloats());
  for (size_t i = 0; i < times->size(); ++i) {
    if (!std::isfinite((*times)[i]) || (i > 0 && !((*times)[i] > (*times)[i - 1]))) {
      return AnimationFault(
          absl::StrCat("its times do not ascend: time ", i, " is ", (*times)[i], " s"));
    }
  }
  times_.emplace_back(number, times);
  return times;
}

std::vector<float> GlbAnimation::KeyTimes() const {
  std::vector<float> all;
  for (const auto& [number, times] : times_) all.insert(all.end(), times->begin(), times->end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<double> GlbAnimation::ValueAt(const Channel& channel, float seconds) {
  const std::vector<float>& times = *channel.times;
  const bool is_cubic = channel.interpolation == Interpolation::kCubic;
  const auto value = [&](size_t key, size_t part, size_t k) {
    const size_t number = ((is_cubic ? 3 * key + part : key) * channel.num_values + k);
    const auto components = static_cast<size_t>(channel.components);
    return channel.values.At(number / components, static_cast<int>(number % components));
  };
  const size_t middle = is_cubic ? 1 : 0;  // of the in-tangent, the value and the out-tangent
  const auto later = std::ranges::upper_bound(times, seconds);
  const size_t after = static_cast<size_t>(later - times.begin());
  const size_t before = after == 0 ? 0 : after - 1;
  std::vector<double> result(channel.num_values);
  const bool is_at_key = after == 0 || after == times.size() || times[before] == seconds ||
                         channel.interpolation == Interpolation::kStep;
  const double step = is_at_key ? 1 : double{times[after]} - times[before];
  const double u = is_at_key ? 0 : (double{seconds} - times[before]) / step;
  for (size_t k = 0; k < result.size(); ++k) {
    result[k] = value(before, middle, k);
    if (is_at_key) continue;
    const double end = value(after, middle, k);
    if (!is_cubic) {
      result[k] += u * (end - result[k]);
      continue;
    }
    const double u2 = u * u, u3 = u2 * u;
    result[k] = (2 * u3 - 3 * u2 + 1) * result[k] + step * (u3 - 2 * u2 + u) * value(before, 2, k) +
                (3 * u2 - 2 * u3) * end + step * (u3 - u2) * value(after, 0, k);
  }
  if (channel.path == Path::kRotation && !is_at_key && !is_cubic) {
    double from[4], to[4];
    for (size_t k = 0; k < 4; ++k) {
      from[k] = value(before, 0, k);
      to[k] = value(after, 0, k);
    }
    const Eigen::Quaterniond turned =
        QuaternionOf(from).normalized().slerp(u, QuaternionOf(to).normalized());
    result = {turned.x(), turned.y(), turned.z(), turned.w()};
  }
  return result;
}

void GlbAnimation::Sample(float seconds, std::vector<GlbTransform>* transforms,
                          std::vector<std::vector<float>>* weights) const {
  for (const Channel& channel : channels_) {
    const std::vector<double> value = ValueAt(channel, seconds);
    if (channel.path == Path::kWeights) {
      (*weights)[static_cast<size_t>(channel.node)].assign(value.begin(), value.end());
      continue;
    }
    GlbTransform& transform = (*transforms)[static_cast<size_t>(channel.node)];
    // The specification forbids a matrix on an animated node; its parts take its place.
    transform.matrix.reset();
    if (channel.path == Path::kTranslation) transform.translation = {value[0], value[1], value[2]};
    if (channel.path == Path::kScale) transform.scale = {value[0], value[1], value[2]};
    if (channel.path != Path::kRotation) continue;
    const Eigen::Quaterniond rotation = QuaternionOf(value.data());
    if (rotation.norm() > 0) transform.rotation = rotation.normalized();
  }
}

}  // namespace pleat
