// The frame rates of video as fractions.
#pragma once

#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Returns the fraction that people mean by `fps`: 29.97003 is 30000/1001, anything else is in
// thousandths. fps: above 0, at most 10000.
FrameRate FrameRateFromFps(double fps);

}  // namespace pleat
