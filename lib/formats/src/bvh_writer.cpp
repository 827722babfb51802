#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"

namespace pleat {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

// Angles (z, x, y) in radians with R = Rz(z) Rx(x) Ry(y) and x in [-pi/2, pi/2].
Eigen::Vector3d EulerZxy(const Eigen::Matrix3d& r) {
  // The columns of R are those of Rz Rx Ry: r(2, 1) = sin x, r(2, 0) = -cos x sin y,
  // r(0, 1) = -sin z cos x.
  const double cosine = std::hypot(r(2, 0), r(2, 2));
  const double x = std::atan2(r(2, 1), cosine);
  if (cosine < 1e-9) return {std::atan2(r(1, 0), r(0, 0)), x, 0};  // z and y turn about one axis
  return {std::atan2(-r(0, 1), r(1, 1)), x, std::atan2(-r(2, 0), r(2, 2))};
}

// A number with a fixed number of digits, without the sign of a zero.
void AppendValue(double value, int digits, std::string* text) {
  const double rounding = .5 * std::pow(10., -digits);
  absl::StrAppendFormat(text, "%.*f", digits, std::abs(value) < rounding ? 0. : value);
}

class BvhText {
 public:
  BvhText(const JointClip& clip, const BvhOptions& options)
      : clip_(clip), scale_(1 / options.unit_m), children_(clip.num_joints()) {
    for (size_t j = 1; j < clip.num_joints(); ++j) {
      assert(clip.joints[j].parent >= 0);
      children_[static_cast<size_t>(clip.joints[j].parent)].push_back(j);
    }
  }

  std::string Encode() {
    text_ = "HIERARCHY\n";
    AddJoints();
    absl::StrAppendFormat(&text_, "MOTION\nFrames: %d\nFrame Time: %.10f\n", clip_.num_frames(),
                          1 / clip_.fps);
    for (size_t t = 0; t < clip_.num_frames(); ++t) AddFrame(t);
    return std::move(text_);
  }

 private:
  void Line(int depth, const std::string& line) {
    text_.append(static_cast<size_t>(depth), '\t');
    absl::StrAppend(&text_, line, "\n");
  }

  void AddOffset(int depth, const Eigen::Vector3d& offset) {
    text_.append(static_cast<size_t>(depth), '\t');
    text_.append("OFFSET");
    for (int k = 0; k < 3; ++k) {
      text_.push_back(' ');
      AppendValue(scale_ * offset[k], kDigits, &text_);
    }
    text_.push_back('\n');
  }

  // Joints in the order of the hierarchy, which is that of the values of a frame: a joint, then all
  // below it.
  void AddJoints() {
    struct Open {
      size_t joint;
      size_t next_child = 0;
    };
    std::vector<Open> path;
    const auto enter = [&](size_t joint) {
      const auto depth = static_cast<int>(path.size());
      const ClipJoint& entry = clip_.joints[joint];
      const std::string name = absl::StrReplaceAll(
          entry.name, {{"\n", " "}, {"\r", " "}, {"{", "("}, {"}", ")"}, {std::string(1, 0), " "}});
      Line(depth, entry.is_end ? "End Site" : absl::StrCat(depth == 0 ? "ROOT " : "JOINT ", name));
      Line(depth, "{");
      AddOffset(depth + 1, depth == 0 ? Eigen::Vector3d::Zero() : entry.offset);
      if (!entry.is_end) {
        order_.push_back(joint);
        Line(depth + 1, depth == 0 ? "CHANNELS 6 Xposition Yposition Zposition Zrotation "
                                     "Xrotation Yrotation"
                                   : "CHANNELS 3 Zrotation Xrotation Yrotation");
        if (children_[joint].empty()) AddTip(depth + 1);
      }
      path.push_back({joint});
    };
    enter(0);
    while (!path.empty()) {
      Open& open = path.back();
      if (open.next_child < children_[open.joint].size()) {
        enter(children_[open.joint][open.next_child++]);
        continue;
      }
      path.pop_back();
      Line(static_cast<int>(path.size()), "}");
    }
  }

  // The format wants an end below every joint without others.
  void AddTip(int depth) {
    Line(depth, "End Site");
    Line(depth, "{");
    AddOffset(depth + 1, Eigen::Vector3d::Zero());
    Line(depth, "}");
  }

  void AddFrame(size_t t) {
    for (const size_t joint : order_) {
      const size_t place = t * clip_.num_joints() + joint;
      if (joint == 0) {
        for (int k = 0; k < 3; ++k) {
          if (k > 0) text_.push_back(' ');
          AppendValue(scale_ * clip_.translations[place][k], kDigits, &text_);
        }
      }
      const Eigen::Vector3d angles = EulerZxy(clip_.rotations[place].toRotationMatrix());
      for (int k = 0; k < 3; ++k) {
        text_.push_back(' ');
        AppendValue(kDegrees * angles[k], kDigits, &text_);
      }
    }
    text_.push_back('\n');
  }

  static constexpr int kDigits = 7;
  const JointClip& clip_;
  const double scale_;
  std::vector<std::vector<size_t>> children_;
  std::vector<size_t> order_;
  std::string text_;
};

}  // namespace

std::string EncodeBvh(const JointClip& clip, const BvhOptions& options) {
  return BvhText(clip, options).Encode();
}

absl::Status WriteBvh(const std::string& path, const JointClip& clip, const BvhOptions& options) {
  return WriteFile(path, EncodeBvh(clip, options));
}

}  // namespace pleat
