#include "pleat/metrics/project_labels.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace pleat {
namespace {

TEST(ProjectLabelsTest, TheFirstProjectsHaveLabelsAndAllOthersShareOne) {
  ProjectLabels labels(2);
  EXPECT_EQ(labels.LabelOf("robots"), "robots");
  EXPECT_EQ(labels.LabelOf("ghosts"), "ghosts");
  EXPECT_EQ(labels.LabelOf("late"), "other");
  EXPECT_EQ(labels.LabelOf("robots"), "robots");
  EXPECT_EQ(labels.LabelOf(""), "none");
}

TEST(ProjectLabelsTest, HoweverManyProjectsThereAreLabelsAreFew) {
  ProjectLabels labels;
  std::set<std::string> seen;
  for (int i = 0; i < 10'000; ++i) seen.insert(labels.LabelOf("p" + std::to_string(i)));
  EXPECT_EQ(seen.size(), ProjectLabels::kMaxLabels + 1);
}

}  // namespace
}  // namespace pleat
