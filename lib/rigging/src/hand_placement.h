// Corrects the hands of a placed skeleton, which the search puts wherever a limb's last sphere
// lies.
#pragma once

#include <Eigen/Core>

#include "main_body.h"

namespace pleat {

// Moves each hand back along its forearm to four fifths of the way from the shoulder to the tip of
// the arm, and the elbow with it: between a wrist with an open hand (.755 of the arm's length by
// Drillis and Contini 1966) and one with a fist (.85). A hand that lies before that stays, and so
// does one whose tip cannot be told from what it touches. `joints` (3 x 18, template order) are
// those of `body`; body_size is its longest side.
void PlaceHands(const MainBody& body, double body_size, Eigen::Matrix3Xd* joints);

}  // namespace pleat
