#include "pleat/jobs/job_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

using ::testing::ElementsAre;

JobQueue::Job JobNamed(const std::string& id) {
  JobInfo info;
  info.id = id;
  return std::make_shared<JobStateMachine>(info, 0, [] { return 0.; });
}

std::vector<std::string> TakeAll(JobQueue* queue) {
  std::vector<std::string> ids;
  while (!queue->empty()) {
    const JobQueue::Job next = queue->Next();
    ids.push_back(next->id());
    queue->Take(next);
    queue->Take(next);  // what does not wait is left alone
  }
  return ids;
}

TEST(JobQueueTest, OneClientHasAPlainQueue) {
  JobQueue queue;
  for (const char* id : {"a", "b", "c"}) queue.Add(JobNamed(id), "client");
  EXPECT_EQ(queue.size(), 3);
  EXPECT_THAT(TakeAll(&queue), ElementsAre("a", "b", "c"));
}

TEST(JobQueueTest, ClientsTakeTurnsHoweverManyJobsTheyHave) {
  JobQueue queue;
  for (const char* id : {"a1", "a2", "a3", "a4"}) queue.Add(JobNamed(id), "a");
  queue.Add(JobNamed("b1"), "b");
  queue.Add(JobNamed("c1"), "c");
  queue.Add(JobNamed("b2"), "b");
  EXPECT_THAT(TakeAll(&queue), ElementsAre("a1", "b1", "c1", "a2", "b2", "a3", "a4"));
  // The turns before still count.
  queue.Add(JobNamed("a5"), "a");
  queue.Add(JobNamed("c2"), "c");
  EXPECT_THAT(TakeAll(&queue), ElementsAre("c2", "a5"));
}

TEST(JobQueueTest, JobsThatMayNotRunKeepTheirPlaceAndTheirTurn) {
  JobQueue queue;
  for (const char* id : {"a1", "b1", "a2"}) queue.Add(JobNamed(id), std::string(1, id[0]));
  const auto not_a = [](const JobStateMachine& job) { return job.id()[0] != 'a'; };
  const JobQueue::Job next = queue.Next(not_a);
  EXPECT_EQ(next->id(), "b1");
  queue.Take(next);
  EXPECT_EQ(queue.Next(not_a), nullptr);
  EXPECT_THAT(TakeAll(&queue), ElementsAre("a1", "a2"));
  EXPECT_EQ(queue.Next(), nullptr);
}

TEST(JobQueueTest, WhatIsPutBackIsTheFirstOfItsClient) {
  JobQueue queue;
  queue.Add(JobNamed("a1"), "a");
  const JobQueue::Job back = JobNamed("a0");
  queue.AddFirst(back, "a");
  EXPECT_EQ(queue.NumOf("a"), 2);
  EXPECT_TRUE(queue.Remove(back));
  EXPECT_FALSE(queue.Remove(back));
  queue.AddFirst(back, "a");
  EXPECT_EQ(queue.jobs().size(), 2);
  EXPECT_THAT(TakeAll(&queue), ElementsAre("a0", "a1"));
}

}  // namespace
}  // namespace pleat
