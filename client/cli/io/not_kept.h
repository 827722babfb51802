// What a file format cannot hold of an animation.
#pragma once

#include <string>
#include <vector>

#include "cli/io/animation_writer.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The parts of `sequence`, in words, that are lost when it is written in this format. Empty when
// all is kept. first_frame: the number of its first frame.
std::vector<std::string> NotKept(AnimationFormat format, const MeshSequence& sequence,
                                 double first_frame);

// Whether files of this format say how many frames a second has.
bool SaysFrameRate(AnimationFormat format);
// Whether files of this format say, or the format defines, what their unit and axes are.
bool SaysSpace(AnimationFormat format);

}  // namespace pleat
