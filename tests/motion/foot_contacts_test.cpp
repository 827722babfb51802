#include "pleat/motion/foot_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pleat {
namespace {

// Stands for 20 frames and swings for 20, again and again, at 60 frames per second.
FootPath Walk(double slide_per_frame_m) {
  FootPath path;
  path.ankle.resize(3, 200);
  double x = 0;
  for (Eigen::Index t = 0; t < 200; ++t) {
    const bool stands = t / 20 % 2 == 0;
    x += stands ? slide_per_frame_m : .04;
    const double lift =
        stands ? 0 : .15 * std::sin(3.14159265 * (static_cast<double>(t % 20) + .5) / 20);
    path.ankle.col(t) << x, .09 + lift, .1;
  }
  path.toes = path.ankle;
  path.toes.row(1).array() -= .07;
  path.toes.row(2).array() += .15;
  return path;
}

TEST(FootContactsTest, StandingFramesAreFound) {
  const FootContacts contacts = DetectContacts(Walk(0), 60);
  for (size_t t = 0; t < 200; ++t) {
    const size_t phase = t % 40;
    if (phase >= 2 && phase < 17) {
      EXPECT_TRUE(contacts.ball[t] && contacts.heel[t]) << t;
    }
    if (phase >= 22 && phase < 38) {
      EXPECT_FALSE(contacts.AnyAt(t)) << t;
    }
  }
}

TEST(FootContactsTest, SlidingIsTheWayPerContactFrame) {
  for (const double slide : {0., .001, .003}) {
    const FootPath path = Walk(slide);
    const FootContacts truth = DetectContacts(Walk(0), 60);
    const FootSliding sliding = MeasureSliding({path, path}, {truth, truth});
    EXPECT_GT(sliding.num_frames, 130);
    EXPECT_NEAR(sliding.mean_mm, 1000 * slide, 3);  // the first frame of a step still moves
    EXPECT_GE(sliding.max_mm, 1000 * slide);
  }
}

TEST(FootContactsTest, OneFrameAndNoFrameAreNoTrouble) {
  FootPath path{Eigen::Matrix3Xd::Zero(3, 1), Eigen::Matrix3Xd::Zero(3, 1)};
  EXPECT_EQ(DetectContacts(path, 30).heel.size(), 1u);
  path = {Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0)};
  const FootContacts none = DetectContacts(path, 30);
  EXPECT_EQ(MeasureSliding({path, path}, {none, none}).num_frames, 0);
}

}  // namespace
}  // namespace pleat
