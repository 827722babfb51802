// Corrects the feet of a placed skeleton, which the search puts wherever the last sphere of a leg
// lies.
#pragma once

#include <Eigen/Core>
#include <array>

#include "main_body.h"

namespace pleat {

// Moves ankles and toes to their places in the foot that the shell shows: with the length L of a
// foot from the heel to the tip, the ankle lies .33 L above the sole and .22 L before the heel, the
// toes (the balls, where the foot bends) .74 L before the heel and .10 L above the sole. A foot
// whose length is not one of a foot (under long clothes, in the air, cut off) stays, and so does
// one whose tip is nearer to the line of the lower leg than its heel is. joints: 3 x 18, template
// order, of `body`. Returns which of the two feet, left and right, were moved.
std::array<bool, 2> PlaceFeet(const MainBody& body, Eigen::Matrix3Xd* joints);

}  // namespace pleat
