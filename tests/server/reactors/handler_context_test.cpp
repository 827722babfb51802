#include "pleat/reactors/handler_context.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(StreamSlot, OneTooManyIsRefusedUntilAnotherHasEnded) {
  HandlerContext context;
  context.calls->max_open_streams = 2;
  std::vector<std::unique_ptr<StreamSlot>> slots;
  for (int i = 0; i < 2; ++i) {
    slots.push_back(std::make_unique<StreamSlot>(&context));
    EXPECT_THAT(slots.back()->status(), IsOk());
  }
  {
    const StreamSlot refused(&context);
    EXPECT_THAT(refused.status(),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more than 2 streams")));
    slots.pop_back();
    EXPECT_FALSE(refused.status().ok()) << "what was refused stays refused";
  }
  EXPECT_THAT(StreamSlot(&context).status(), IsOk());
}

TEST(StreamSlot, NothingBeginsWhileTheServerDrains) {
  HandlerContext context;
  context.calls->max_open_streams = 2;
  const StreamSlot slot(&context);
  context.calls->draining = true;
  EXPECT_THAT(slot.status(), HasStatus(absl::StatusCode::kUnavailable, HasSubstr("shutting down")));
}

}  // namespace
}  // namespace pleat
