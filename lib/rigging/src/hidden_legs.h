// Legs that no one can see: a robe, a gown or a long coat reaches to the floor.
#pragma once

#include <Eigen/Core>

#include "main_body.h"

namespace pleat {

// Returns true when horizontal sections between ankles and knees are one round outline, seen from
// outside, instead of those of two legs: solid, or a bell with whatever inside of it.
bool AreLegsHidden(const BodyVolume& volume, const MainBody& body,
                   const Eigen::Matrix3d& upright_from_input);

// Lays hips and legs straight down to the floor, by the proportions of the template, where the
// surface says nothing about them. template_joints: 3 x 18, turned by the yaw, of the size of the
// body's longest side; joints: 3 x 18, upright unit box.
void PlaceHiddenLegs(const MainBody& body, const Eigen::Matrix3Xd& template_joints,
                     Eigen::Matrix3Xd* joints);

}  // namespace pleat
