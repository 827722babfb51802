#include "pleat/cache/byte_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <thread>
#include <vector>

#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using Cache = ByteCache<std::string>;

// Loads "value of KEY" charged with `bytes` and counts the loads.
struct CountingLoader {
  uint64_t bytes = 10;
  std::atomic<int> num_loads = 0;
  Cache::Loader loader() {
    return [this](const std::string& key) -> absl::StatusOr<Cache::Loaded> {
      ++num_loads;
      return Cache::Loaded{std::make_shared<const std::string>("value of " + key), bytes};
    };
  }
};

TEST(ByteCacheTest, LoadsOnceAndKeeps) {
  Cache cache(100);
  CountingLoader counting;
  EXPECT_EQ(**cache.Get("a", counting.loader()), "value of a");
  EXPECT_EQ(**cache.Get("a", counting.loader()), "value of a");
  EXPECT_EQ(counting.num_loads, 1);
  EXPECT_EQ(cache.stats().used_bytes, 10u);
  EXPECT_EQ(cache.stats().hits, 1u);
}

TEST(ByteCacheTest, DropsTheLeastRecentlyUsed) {
  Cache cache(30);
  CountingLoader counting;
  for (const char* key : {"a", "b", "c"}) ASSERT_TRUE(cache.Get(key, counting.loader()).ok());
  ASSERT_TRUE(cache.Get("a", counting.loader()).ok());  // now b is the oldest
  ASSERT_TRUE(cache.Get("d", counting.loader()).ok());
  EXPECT_EQ(counting.num_loads, 4);
  for (const char* key : {"a", "c", "d"}) ASSERT_TRUE(cache.Get(key, counting.loader()).ok());
  EXPECT_EQ(counting.num_loads, 4);
  ASSERT_TRUE(cache.Get("b", counting.loader()).ok());
  EXPECT_EQ(counting.num_loads, 5);
  EXPECT_LE(cache.stats().used_bytes, 30u);
}

TEST(ByteCacheTest, WhatIsHeldStaysAndIsNotLoadedTwice) {
  Cache cache(30);
  CountingLoader counting;
  const Cache::Handle held = cache.Get("a", counting.loader()).value();
  for (const char* key : {"b", "c", "d", "e", "f"}) {
    ASSERT_TRUE(cache.Get(key, counting.loader()).ok());
  }
  EXPECT_EQ(cache.stats().num_pinned, 1);
  EXPECT_EQ(cache.Get("a", counting.loader()).value(), held);  // the same object
  EXPECT_EQ(counting.num_loads, 6);
}

TEST(ByteCacheTest, RefusesWhatDoesNotFit) {
  Cache cache(30);
  CountingLoader counting;
  const Cache::Handle a = cache.Get("a", counting.loader()).value();
  const Cache::Handle b = cache.Get("b", counting.loader()).value();
  CountingLoader large{.bytes = 20};
  EXPECT_THAT(cache.Get("large", large.loader()),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("in use")));
  CountingLoader huge{.bytes = 31};
  EXPECT_THAT(
      cache.Get("huge", huge.loader()),
      HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("the operator must allow more")));
  EXPECT_EQ(cache.stats().used_bytes, 20u);
}

TEST(ByteCacheTest, GivesMemoryBack) {
  Cache cache(1000);
  CountingLoader counting;
  std::weak_ptr<const std::string> watched;
  {
    const Cache::Handle handle = cache.Get("a", counting.loader()).value();
    watched = handle;
    cache.Erase("a");
    EXPECT_EQ(cache.stats().used_bytes, 10u);  // the memory is in use, so it is counted
    EXPECT_EQ(*handle, "value of a");          // still ours
  }
  EXPECT_EQ(cache.stats().used_bytes, 0u);
  EXPECT_TRUE(watched.expired());
  for (int round = 0; round < 1000; ++round) {
    ASSERT_TRUE(cache.Get(std::to_string(round), counting.loader()).ok());
  }
  EXPECT_EQ(cache.stats().num_entries, 100);
  EXPECT_EQ(cache.stats().evictions, 900u);
}

TEST(ByteCacheTest, GivesWhatNobodyUsesToOthersWhoNeedMemory) {
  MemoryBudget all(100, "--memory-bytes");
  Cache cache(100, &all);
  all.AddReclaimer([&cache](uint64_t bytes) { cache.Reclaim(bytes); });
  CountingLoader counting;
  const Cache::Handle held = cache.Get("held", counting.loader()).value();
  for (int i = 0; i < 9; ++i) {
    ASSERT_TRUE(cache.Get(std::to_string(i), counting.loader()).ok());
  }
  EXPECT_EQ(all.used_bytes(), 100u);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation job, all.Reserve(45, "a job"));
    EXPECT_EQ(cache.stats().num_entries, 5);  // the least recently used have gone
    EXPECT_THAT(all.Reserve(60, "another"), HasStatus(absl::StatusCode::kResourceExhausted, _));
    EXPECT_EQ(cache.stats().num_entries, 1);  // the one that is in use
    // The cache makes its own room first and is refused when that does not suffice.
    ASSERT_TRUE(cache.Get("new", counting.loader()).ok());
    CountingLoader large{.bytes = 50};
    EXPECT_THAT(cache.Get("large", large.loader()),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("--memory-bytes")));
  }
  EXPECT_EQ(all.used_bytes(), cache.stats().used_bytes);
}

TEST(ByteCacheTest, AHandleMayOutliveTheCache) {
  MemoryBudget all(100, "--memory-bytes");
  Cache::Handle handle;
  {
    Cache cache(100, &all);
    CountingLoader counting;
    handle = cache.Get("a", counting.loader()).value();
  }
  EXPECT_EQ(*handle, "value of a");
  EXPECT_EQ(all.used_bytes(), 10u);
  handle.reset();
  EXPECT_EQ(all.used_bytes(), 0u);
}

TEST(ByteCacheTest, ErrorsAreNotKept) {
  Cache cache(100);
  EXPECT_THAT(cache.Get("a",
                        [](const std::string&) -> absl::StatusOr<Cache::Loaded> {
                          return absl::DataLossError("broken file");
                        }),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("broken")));
  CountingLoader counting;
  EXPECT_TRUE(cache.Get("a", counting.loader()).ok());
}

TEST(ByteCacheTest, ManyAskersShareOneLoad) {
  Cache cache(100);
  std::atomic<int> num_loads = 0;
  std::latch asking(8);
  std::vector<Cache::Handle> handles(8);
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      asking.count_down();
      handles[i] = cache
                       .Get("a",
                            [&](const std::string&) -> absl::StatusOr<Cache::Loaded> {
                              ++num_loads;
                              asking.wait();  // the load lasts until everybody asks
                              return Cache::Loaded{std::make_shared<const std::string>("x"), 1};
                            })
                       .value();
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(num_loads, 1);
  for (const Cache::Handle& handle : handles) EXPECT_EQ(handle, handles[0]);
}

TEST(ByteCacheTest, ALoadOfAnErasedKeyIsHandedOutButNotKept) {
  Cache cache(100);
  const auto handle = cache.Get("a", [&](const std::string&) -> absl::StatusOr<Cache::Loaded> {
    cache.Erase("a");
    return Cache::Loaded{std::make_shared<const std::string>("x"), 1};
  });
  EXPECT_EQ(**handle, "x");
  EXPECT_EQ(cache.stats().num_entries, 0);
  EXPECT_EQ(cache.stats().used_bytes, 1u);  // it is in use
}

TEST(ByteCacheTest, StaysWithinCapacityUnderConcurrentUse) {
  Cache cache(200);
  std::atomic<bool> exceeded = false;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      Random random(i + 1);
      for (int round = 0; round < 3000; ++round) {
        const std::string key = std::to_string(random.UniformInt(40));
        const auto handle = cache.Get(key, [](const std::string& k) {
          return absl::StatusOr<Cache::Loaded>(
              Cache::Loaded{std::make_shared<const std::string>(k), 1 + k.size() * 10});
        });
        if (!handle.ok() || **handle != key) exceeded = true;
        if (random.UniformInt(10) == 0) cache.Erase(key);
        if (cache.stats().used_bytes > 200) exceeded = true;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(exceeded);
}

}  // namespace
}  // namespace pleat
