// The allocator of the host, in the shared library: what passes through it, and that it is set
// once. A process of its own, because the first call of the library decides where its memory comes
// from.
#include <gmock/gmock.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>

#include "c/c_character.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A heap that knows the size of every block, and can run out.
class Heap {
 public:
  pleat_allocator allocator() {
    return {.struct_size = sizeof(pleat_allocator),
            .user = this,
            .allocate = [](void* user, size_t size, size_t alignment) -> void* {
              return static_cast<Heap*>(user)->Allocate(size, alignment);
            },
            .deallocate = [](void* user,
                             void* memory) { static_cast<Heap*>(user)->Deallocate(memory); }};
  }

  size_t num_bytes() {
    std::lock_guard lock(mutex_);
    size_t sum = 0;
    for (const auto& [memory, size] : blocks_) sum += size;
    return sum;
  }
  size_t num_allocations() const { return num_allocations_; }
  bool all_known() const { return all_known_; }
  // From now on only so many allocations succeed.
  void FailAfter(long count) { left_ = count; }

 private:
  void* Allocate(size_t size, size_t alignment) {
    std::lock_guard lock(mutex_);
    if (left_ == 0) return nullptr;
    --left_;
    ++num_allocations_;
    void* const memory =
        std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    blocks_[memory] = size;
    return memory;
  }
  void Deallocate(void* memory) {
    std::lock_guard lock(mutex_);
    all_known_ &= blocks_.erase(memory) == 1;
    std::free(memory);
  }

  std::mutex mutex_;
  std::map<void*, size_t> blocks_;
  std::atomic<size_t> num_allocations_{0};
  bool all_known_ = true;
  long left_ = -1;
};

// One test, since the steps need each other.
TEST(AllocatorTest, TheHostGivesTheMemoryOfModelsAndEvaluators) {
  static Heap heap;
  pleat_error error;
  const pleat_allocator allocator = heap.allocator();
  pleat_allocator bad = allocator;
  bad.allocate = nullptr;
  EXPECT_EQ(pleat_set_allocator(&bad, &error), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_set_allocator(nullptr, &error), PLEAT_INVALID_ARGUMENT);
  bad = allocator;
  bad.struct_size = 4;
  EXPECT_EQ(pleat_set_allocator(&bad, &error), PLEAT_INVALID_ARGUMENT);
  ASSERT_EQ(pleat_set_allocator(&allocator, &error), PLEAT_OK) << error.message;
  EXPECT_EQ(pleat_set_allocator(&allocator, &error), PLEAT_FAILED_PRECONDITION);
  EXPECT_THAT(error.message, HasSubstr("before anything else"));

  const auto character =
      MakeFakeModel(MakeSwayingTube(2, "tube", /*rings=*/100, /*sides=*/60), {.history = 2});
  const std::string bytes = EncodeModel(*character);
  pleat_model* model = nullptr;
  ASSERT_EQ(pleat_model_create(bytes.data(), bytes.size(), nullptr, &model, &error), PLEAT_OK)
      << error.message;
  pleat_model_info info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(pleat_model_get_info(model, &info, &error), PLEAT_OK);
  RecordProperty("model_bytes", static_cast<int>(info.memory_bytes));
  RecordProperty("host_bytes", static_cast<int>(heap.num_bytes()));
  EXPECT_GT(static_cast<double>(heap.num_bytes()), .5 * static_cast<double>(info.memory_bytes));

  // Whenever memory ends, a call fails with words and leaves nothing behind.
  const size_t before = heap.num_bytes();
  const size_t used = heap.num_allocations();
  pleat_evaluator* evaluator = nullptr;
  for (long left = 0;; ++left) {
    heap.FailAfter(left);
    pleat_model* other = nullptr;
    const pleat_code code = pleat_model_create(bytes.data(), bytes.size(), nullptr, &other, &error);
    heap.FailAfter(-1);
    if (code == PLEAT_OK) {
      EXPECT_GT(left, 0);
      pleat_model_destroy(other);
      break;
    }
    ASSERT_EQ(code, PLEAT_RESOURCE_EXHAUSTED) << error.message;
    ASSERT_EQ(other, nullptr);
    ASSERT_EQ(heap.num_bytes(), before);
    ASSERT_LT(left, static_cast<long>(used) + 10) << "it needs more than the first time";
  }
  ASSERT_EQ(pleat_evaluator_create(model, &evaluator, &error), PLEAT_OK);
  pleat_model_destroy(model);
  ASSERT_EQ(pleat_evaluator_reserve(evaluator, 4, &error), PLEAT_OK);
  pleat_evaluator_destroy(evaluator);
  EXPECT_EQ(heap.num_bytes(), 0u) << "a leak";
  EXPECT_TRUE(heap.all_known()) << "memory came back that was never given";
}

}  // namespace
}  // namespace pleat
