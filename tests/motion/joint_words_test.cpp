#include <gtest/gtest.h>

#include "pleat/motion/landmarks.h"

namespace pleat {
namespace {

void ExpectWord(const char* name, const char* word, int side) {
  const JointWord found = JointWordOf(name);
  EXPECT_EQ(found.word, word) << name;
  EXPECT_EQ(found.side, side) << name;
}

TEST(JointWordsTest, NamesOfAllPackagesBecomeWords) {
  ExpectWord("mixamorig:LeftUpLeg", "upleg", 1);
  ExpectWord("mixamorig1:RightToeBase", "toebase", -1);
  ExpectWord("LHipJoint", "hipjoint", 1);
  ExpectWord("Bip01 L UpperArm", "upperarm", 1);
  ExpectWord("Bip001 R Toe0", "toe", -1);
  ExpectWord("thigh.L.001", "thigh", 1);
  ExpectWord("DEF-upper_arm.R", "upperarm", -1);
  ExpectWord("f_avg_L_Hip", "hip", 1);
  ExpectWord("J_Bip_R_LowerLeg", "lowerleg", -1);
  ExpectWord("clavicle_l", "clavicle", 1);
  ExpectWord("spine_01", "spine", 0);
  ExpectWord("lfemur", "femur", 1);
  ExpectWord("rhand", "hand", -1);
  ExpectWord("lShldrBend", "shldrbend", 1);
  ExpectWord("UpperLeg_L", "upperleg", 1);
  ExpectWord("left_knee", "knee", 1);
  ExpectWord("lowerback", "lowerback", 0);
  ExpectWord("ribs", "ribs", 0);
  ExpectWord("root", "root", 0);
  ExpectWord("leftupleg", "upleg", 1);
}

TEST(JointWordsTest, NamesWithoutLettersAreNoWord) {
  for (const char* name : {"", "0", "::", "___", "\xff\xfe"}) ExpectWord(name, "", 0);
}

}  // namespace
}  // namespace pleat
