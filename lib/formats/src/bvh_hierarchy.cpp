#include "bvh_hierarchy.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr double kMaxLength = 1e9;  // of an offset, in any unit
constexpr size_t kMaxBvhNameBytes = 4096;

bool Is(std::string_view word, const char* keyword) {
  return absl::EqualsIgnoreCase(absl::string_view(word.data(), word.size()), keyword);
}

class HierarchyParser {
 public:
  explicit HierarchyParser(TextWords* words) : words_(*words) {}

  absl::StatusOr<BvhHierarchy> Parse() {
    if (const std::string_view word = words_.Next(); !Is(word, "HIERARCHY")) {
      return Fault(
          absl::StrCat("the file begins with ", QuotedWord(word), ", a BVH file with HIERARCHY"));
    }
    for (;;) {
      const std::string_view word = words_.Next();
      if (word.empty()) return Fault("the file ends inside its hierarchy: MOTION is missing");
      if (Is(word, "MOTION")) break;
      PLEAT_RETURN_IF_ERROR(ParseEntry(word));
    }
    if (current_ >= 0) {
      return Fault(absl::StrCat("the block of ", NameOf(current_), " is not closed before MOTION"));
    }
    if (result_.joints.empty()) return Fault("the hierarchy has no ROOT");
    if (result_.channels.empty()) return Fault("no joint has CHANNELS, so nothing moves");
    return std::move(result_);
  }

 private:
  absl::Status Fault(const std::string& what) const {
    return absl::InvalidArgumentError(absl::StrCat("line ", words_.line(), ": ", what));
  }
  std::string NameOf(int joint) const {
    return QuotedWord(result_.joints[static_cast<size_t>(joint)].name);
  }
  ClipJoint& current() { return result_.joints[static_cast<size_t>(current_)]; }

  absl::Status ParseEntry(std::string_view word) {
    if (Is(word, "ROOT") || Is(word, "JOINT")) return ParseJoint(Is(word, "ROOT"));
    if (current_ < 0) {
      return Fault(absl::StrCat("found ", QuotedWord(word), " where ROOT or MOTION must stand"));
    }
    if (Is(word, "End")) return ParseEnd();
    if (Is(word, "OFFSET")) return ParseOffset();
    if (Is(word, "CHANNELS")) return ParseChannels();
    if (word == "}") {
      current_ = current().parent;
      return absl::OkStatus();
    }
    return Fault(absl::StrCat("found ", QuotedWord(word), " in the block of ", NameOf(current_)));
  }

  absl::Status Open(ClipJoint joint) {
    if (result_.joints.size() >= kMaxClipJoints) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the hierarchy has more than ", kMaxClipJoints, " joints"));
    }
    if (current_ >= 0 && current().is_end) return Fault("an End Site has a joint below it");
    if (words_.Next() != "{") {
      return Fault(absl::StrCat("'{' is missing after ", QuotedWord(joint.name)));
    }
    joint.parent = current_;
    current_ = static_cast<int>(result_.joints.size());
    result_.joints.push_back(std::move(joint));
    return absl::OkStatus();
  }

  absl::Status ParseJoint(bool is_root) {
    const std::string_view name = words_.RestOfName();
    if (name.size() > kMaxBvhNameBytes) return Fault("the name of a joint is too long");
    if (is_root != (current_ < 0)) {
      return Fault(is_root ? "a ROOT stands inside another joint" : "a JOINT stands outside ROOT");
    }
    ClipJoint joint{.name = NameToUtf8(name)};
    if (joint.name.empty()) joint.name = absl::StrCat("joint_", result_.joints.size());
    return Open(std::move(joint));
  }

  absl::Status ParseEnd() {
    if (const std::string_view word = words_.Next(); !Is(word, "Site")) {
      return Fault(absl::StrCat("found ", QuotedWord(word), " after End, expected End Site"));
    }
    return Open({.name = absl::StrCat(current().name, "_end"), .is_end = true});
  }

  absl::Status ParseOffset() {
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words_.Next();
      if (!ParseNumber(word, &current().offset[k]) || std::abs(current().offset[k]) > kMaxLength) {
        return Fault(absl::StrCat("OFFSET of ", NameOf(current_), " has ", QuotedWord(word),
                                  " where a number must stand"));
      }
    }
    return absl::OkStatus();
  }

  absl::Status ParseChannels() {
    const std::string_view word = words_.Next();
    double count = -1;
    if (!ParseNumber(word, &count) || !(count >= 0 && count <= 6) || count != std::floor(count)) {
      return Fault(absl::StrCat("CHANNELS of ", NameOf(current_), " begins with ", QuotedWord(word),
                                "; it must be their number, at most 6"));
    }
    for (int k = 0; k < static_cast<int>(count); ++k) PLEAT_RETURN_IF_ERROR(ParseChannel());
    return absl::OkStatus();
  }

  absl::Status ParseChannel() {
    const std::string_view word = words_.Next();
    constexpr const char* kNames[] = {"Xposition", "Yposition", "Zposition",
                                      "Xrotation", "Yrotation", "Zrotation"};
    const auto known =
        std::ranges::find_if(kNames, [&](const char* name) { return Is(word, name); });
    if (known == std::end(kNames)) {
      return Fault(absl::StrCat("joint ", NameOf(current_), " has the channel ", QuotedWord(word),
                                "; there are Xposition to Zposition and Xrotation to Zrotation"));
    }
    const auto number = static_cast<int>(known - kNames);
    const BvhChannel channel{current_, number >= 3, number % 3};
    for (const BvhChannel& other : result_.channels) {
      if (other.joint != current_ || other.is_rotation != channel.is_rotation ||
          other.axis != channel.axis) {
        continue;
      }
      return Fault(absl::StrCat("joint ", NameOf(current_), " has the channel ", *known, " twice"));
    }
    if (current().is_end) return Fault("an End Site has channels");
    result_.channels.push_back(channel);
    return absl::OkStatus();
  }

  TextWords& words_;
  BvhHierarchy result_;
  int current_ = -1;
};

}  // namespace

absl::StatusOr<BvhHierarchy> ReadBvhHierarchy(TextWords* words) {
  return HierarchyParser(words).Parse();
}

}  // namespace pleat
