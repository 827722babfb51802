// Which frame rate is meant by the times of frames, in files whose times are float32 seconds.
#pragma once

#include <optional>
#include <vector>

#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The frame rate of times that are evenly spaced but for their rounding to float32: the plainest
// rate that fits (24, 30000/1001, 23.976, ...). None for fewer than two times, and for times that
// are not finite, do not ascend or are uneven.
std::optional<FrameRate> RateOfFloatTimes(const std::vector<float>& times_s);

// The rate, of those that people work with, at whose frames all times lie, counted from the first.
// Fewer times than frames are enough: keys of an animation. None when no rate fits.
std::optional<FrameRate> RateOfKeys(const std::vector<float>& times_s);

// The usual rate whose frames last `seconds`, within `tolerance_s`: the nearest whole number where
// one fits, else the nearest fraction.
std::optional<FrameRate> RateOfInterval(double seconds, double tolerance_s);

// The number of the frame at `seconds`, rounded to a whole number where it is one but for the
// rounding of the seconds to float32.
double FrameNumberAt(float seconds, FrameRate rate);

}  // namespace pleat
