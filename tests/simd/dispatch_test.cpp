#include "pleat/simd/dispatch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace pleat {
namespace {

using enum InstructionSet;

// The kernel of README.md: y += factor x.
struct AddScaled {
  static PLEAT_ALWAYS_INLINE void Run(float factor, const float* x, ptrdiff_t count, float* y) {
    for (ptrdiff_t i = 0; i < count; ++i) y[i] += factor * x[i];
  }
};

const auto& AddScaledVariants() {
  static const auto variants = CompiledVariants<AddScaled>();
  return variants;
}

template <typename Kernel>
std::vector<InstructionSet> SetsOf(const KernelVariants<Kernel>& variants) {
  std::vector<InstructionSet> sets;
  for (const auto& variant : variants) sets.push_back(variant.set);
  return sets;
}

TEST(DispatchTest, ANewerSetComesWithTheOlderOnes) {
  EXPECT_TRUE(ProcessorHas(kBaseline));
  EXPECT_GE(ProcessorHas(kAvx2), ProcessorHas(kAvx512));
  EXPECT_GE(ProcessorHas(kAvx512), ProcessorHas(kAvx512Vnni));
}

TEST(DispatchTest, EverySetHasAName) {
  EXPECT_STREQ(NameOf(kBaseline), "baseline");
  EXPECT_STREQ(NameOf(kAvx2), "avx2");
  EXPECT_STREQ(NameOf(kAvx512), "avx512");
  EXPECT_STREQ(NameOf(kAvx512Vnni), "avx512vnni");
}

TEST(DispatchTest, VariantsAreThoseTheProcessorRunsTheFastestFirst) {
  std::vector<InstructionSet> expected;
  for (const InstructionSet set : {kAvx512, kAvx2, kBaseline}) {
    if (ProcessorHas(set)) expected.push_back(set);
  }
  EXPECT_EQ(SetsOf(AddScaledVariants()), expected);
}

TEST(DispatchTest, OneBodyGivesTheSameBitsOnEverySet) {
  std::vector<float> x(1003), start(x.size());
  for (size_t i = 0; i < x.size(); ++i) {
    x[i] = 1.f / static_cast<float>(i + 3);
    start[i] = 1.f / static_cast<float>(i + 7);
  }
  std::vector<float> expected = start;
  AddScaled::Run(.3f, x.data(), std::ssize(x), expected.data());
  for (const auto& [set, add_scaled] : AddScaledVariants()) {
    std::vector<float> y = start;
    add_scaled(.3f, x.data(), std::ssize(x), y.data());
    EXPECT_EQ(y, expected) << NameOf(set);
  }
}

TEST(DispatchTest, EverySetHasAFunctionOfItsOwn) {
  EXPECT_NE((CompileFor<AddScaled, kBaseline>()), (CompileFor<AddScaled, kAvx2>()));
  EXPECT_NE((CompileFor<AddScaled, kAvx2>()), (CompileFor<AddScaled, kAvx512>()));
}

TEST(DispatchTest, AVariantThatTheBuildLacksIsLeftOut) {
  const int baseline = 1;
  const auto variants = RunnableVariants<const int*>(
      {{kAvx2, nullptr}, {kBaseline, nullptr}, {kBaseline, &baseline}});
  ASSERT_EQ(variants.size(), 1u);
  EXPECT_EQ(variants.front().kernel, &baseline);
}

// A table of functions is a kernel too; a variant by hand stands before those of the compiler.
TEST(DispatchTest, TablesKeepTheOrderGiven) {
  struct Table {
    int value = 0;
  };
  const auto variants = RunnableVariants<Table>({{kBaseline, {2}}, {kBaseline, {1}}});
  ASSERT_EQ(variants.size(), 2u);
  EXPECT_EQ(variants[0].kernel.value, 2);
  EXPECT_EQ(variants[1].kernel.value, 1);
}

}  // namespace
}  // namespace pleat
