// Meredith and Maddock, Motion Capture File Formats Explained, University of Sheffield, 2001; and
// what the files of CMU, Bandai Namco, MotionBuilder and Blender make of it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "bvh_hierarchy.h"
#include "frame_times.h"
#include "pleat/base/status.h"
#include "pleat/formats/bvh.h"

namespace pleat {
namespace {

constexpr double kMaxFps = 1000, kAssumedFps = 30;
// Values are checked against this, so that sums of squares stay finite.
constexpr double kMaxValue = 1e12;

class BvhParser {
 public:
  BvhParser(std::string_view text, const MeshLimits& limits) : words_(text), limits_(limits) {}

  absl::StatusOr<BvhFile> Parse() {
    PLEAT_ASSIGN_OR_RETURN(hierarchy_, ReadBvhHierarchy(&words_));
    PLEAT_RETURN_IF_ERROR(ParseHeader());
    PLEAT_RETURN_IF_ERROR(ParseFrames());
    file_.clip.joints = hierarchy_.joints;
    PLEAT_RETURN_IF_ERROR(MakeClip());
    return std::move(file_);
  }

 private:
  absl::Status Fault(const std::string& what) const {
    return absl::InvalidArgumentError(absl::StrCat("line ", words_.line(), ": ", what));
  }

  // Returns the text of a line "NAME: text".
  absl::StatusOr<std::string_view> ParseField(const char* name) {
    const std::string_view line = words_.NextLine();
    const size_t colon = line.find(':');
    std::string found;
    TextWords words(line.substr(0, colon));
    for (std::string_view word = words.Next(); !word.empty(); word = words.Next()) {
      absl::StrAppend(&found, found.empty() ? "" : " ", std::string(word));
    }
    if (colon == std::string_view::npos || !absl::EqualsIgnoreCase(found, name)) {
      return Fault(absl::StrCat("found ", QuotedWord(line), " where '", name, ":' must stand"));
    }
    return TextWords(line.substr(colon + 1)).Next();
  }

  absl::Status ParseHeader() {
    PLEAT_ASSIGN_OR_RETURN(const std::string_view frames, ParseField("Frames"));
    if (!ParseNumber(frames, &said_frames_)) {
      return Fault(absl::StrCat("the number of frames is ", QuotedWord(frames)));
    }
    PLEAT_ASSIGN_OR_RETURN(const std::string_view time, ParseField("Frame Time"));
    double seconds = 0;
    if (!ParseNumber(time, &seconds) || !(seconds * kMaxFps >= 1) || !(seconds <= 1e4)) {
      file_.clip.fps = kAssumedFps;
      file_.warnings.push_back(absl::StrCat("the frame time is ", QuotedWord(time), ": ",
                                            kAssumedFps, " frames per second are taken"));
      return absl::OkStatus();
    }
    // Written with few digits most often: .0083333, .033.
    const size_t point = time.find('.');
    const double digits =
        point == std::string_view::npos || time.find_first_of("eE") != std::string_view::npos
            ? 9
            : static_cast<double>(time.size() - point - 1);
    const std::optional<FrameRate> rate =
        RateOfInterval(seconds, std::max(2e-4 * seconds, .5 * std::pow(10., -digits)));
    file_.clip.fps = rate ? rate->fps() : 1 / seconds;
    return absl::OkStatus();
  }

  absl::Status ParseFrames() {
    const size_t num_channels = hierarchy_.channels.size();
    const size_t num_joints = hierarchy_.joints.size();
    size_t in_frame = 0;
    for (std::string_view line = words_.NextLine(); !line.empty(); line = words_.NextLine()) {
      PLEAT_RETURN_IF_ERROR(ParseLine(line, &in_frame));
      if (in_frame < num_channels) continue;  // the frame goes on in the next line
      in_frame = 0;
      ++num_frames_;
      if (static_cast<int64_t>(num_frames_) > limits_.max_frames ||
          static_cast<int64_t>(num_frames_ * num_joints) > kMaxJointFrames) {
        return absl::ResourceExhaustedError(absl::StrCat(
            num_frames_, " frames of ", num_joints, " joints and more: the limits are ",
            limits_.max_frames, " frames and ", kMaxJointFrames, " frames times joints"));
      }
    }
    if (num_frames_ == 0) return Fault("the file has no whole frame");
    values_.resize(num_frames_ * num_channels);
    if (in_frame > 0) {
      file_.warnings.push_back(absl::StrCat("the file is cut off: the last frame has ", in_frame,
                                            " of ", num_channels, " values and is left out"));
    }
    if (said_frames_ != static_cast<double>(num_frames_)) {
      file_.warnings.push_back(absl::StrFormat(
          "the file says that it has %.15g frames, and holds %d: all that it holds are taken",
          said_frames_, num_frames_));
    }
    return absl::OkStatus();
  }

  absl::Status ParseLine(std::string_view line, size_t* in_frame) {
    TextWords words(line);
    const size_t num_channels = hierarchy_.channels.size();
    for (std::string_view word = words.Next(); !word.empty(); word = words.Next()) {
      double value = 0;
      if (!ParseNumber(word, &value) || std::abs(value) > kMaxValue) {
        const size_t channel = std::min(*in_frame, num_channels - 1);
        const auto joint = static_cast<size_t>(hierarchy_.channels[channel].joint);
        return Fault(absl::StrCat("frame ", num_frames_, ", joint ",
                                  QuotedWord(hierarchy_.joints[joint].name), ": ", QuotedWord(word),
                                  " is not a finite number"));
      }
      if (++*in_frame > num_channels) {
        return Fault(absl::StrCat("frame ", num_frames_, " has more than ", num_channels,
                                  " values, the channels of all joints"));
      }
      values_.push_back(value);
    }
    return absl::OkStatus();
  }

  double ValueOf(size_t frame, size_t channel) const {
    return values_[frame * hierarchy_.channels.size() + channel];
  }

  // Whether positions take the place of the offset, as most programs write them, or are added to
  // it. The root's take it always. Of other joints the smaller movement decides.
  std::vector<bool> FindAdded() {
    std::vector<double> replacing(hierarchy_.joints.size(), 0), adding(replacing);
    for (size_t c = 0; c < hierarchy_.channels.size(); ++c) {
      const BvhChannel& channel = hierarchy_.channels[c];
      if (channel.is_rotation) continue;
      const auto joint = static_cast<size_t>(channel.joint);
      const double offset = hierarchy_.joints[joint].offset[channel.axis];
      for (size_t t = 0; t < num_frames_; ++t) {
        replacing[joint] += std::abs(ValueOf(t, c) - offset);
        adding[joint] += std::abs(ValueOf(t, c));
      }
    }
    std::vector<bool> added(hierarchy_.joints.size(), false);
    std::vector<std::string> names;
    for (size_t j = 0; j < added.size(); ++j) {
      added[j] = hierarchy_.joints[j].parent >= 0 && adding[j] < replacing[j];
      if (added[j]) names.push_back(QuotedWord(hierarchy_.joints[j].name));
    }
    if (!names.empty()) {
      file_.warnings.push_back(absl::StrCat("positions of ", names.size(),
                                            " joints are taken as additions to their offsets, "
                                            "since they are nearer to 0 than to them: ",
                                            names[0], names.size() > 1 ? ", ..." : ""));
    }
    return added;
  }

  absl::Status MakeClip() {
    constexpr double kRadians = std::numbers::pi / 180;
    const std::vector<bool> added = FindAdded();
    const size_t num_joints = hierarchy_.joints.size();
    JointClip& clip = file_.clip;
    clip.rotations.assign(num_frames_ * num_joints, Eigen::Quaterniond::Identity());
    clip.translations.reserve(num_frames_ * num_joints);
    for (size_t t = 0; t < num_frames_; ++t) {
      for (const ClipJoint& joint : clip.joints) clip.translations.push_back(joint.offset);
      for (size_t c = 0; c < hierarchy_.channels.size(); ++c) {
        const BvhChannel& channel = hierarchy_.channels[c];
        const auto joint = static_cast<size_t>(channel.joint);
        const double value = ValueOf(t, c);
        if (!channel.is_rotation) {
          double& place = clip.translations[t * num_joints + joint][channel.axis];
          place = added[joint] ? place + value : value;
          continue;
        }
        // The first channel is the outermost turn.
        Eigen::Quaterniond& rotation = clip.rotations[t * num_joints + joint];
        rotation = rotation * Eigen::AngleAxisd(std::remainder(value, 360.) * kRadians,
                                                Eigen::Vector3d::Unit(channel.axis));
      }
    }
    return absl::OkStatus();
  }

  TextWords words_;
  const MeshLimits& limits_;
  BvhHierarchy hierarchy_;
  double said_frames_ = 0;
  size_t num_frames_ = 0;
  std::vector<double> values_;  // of all channels, frame by frame
  BvhFile file_;
};

}  // namespace

bool IsBvhText(std::string_view bytes) {
  const std::string_view word = TextWords(bytes.substr(0, 1000)).Next();
  return absl::EqualsIgnoreCase(absl::string_view(word.data(), word.size()), "HIERARCHY");
}

absl::StatusOr<BvhFile> DecodeBvh(std::string_view text, const MeshLimits& limits) {
  if (text.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the file has ", text.size(), " bytes, the limit is ", limits.max_document_bytes));
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  return BvhParser(text, limits).Parse();
}

}  // namespace pleat
