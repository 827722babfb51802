#include "pleat/simd/dispatch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "pleat/simd/dense.h"
#include "pleat/simd/expand_planes.h"
#include "pleat/simd/weighted_rows.h"

namespace pleat {
namespace {

using enum InstructionSet;

// A set that no processor has.
constexpr auto kFuture = static_cast<InstructionSet>(99);

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

TEST(DispatchTest, TheBaselineIsChosenWhereTheProcessorLacksTheRest) {
  EXPECT_FALSE(ProcessorHas(kFuture));
  const auto variants = RunnableVariants<int>({{kFuture, 1}, {kBaseline, 2}, {kFuture, 3}});
  ASSERT_EQ(variants.size(), 1u);
  EXPECT_EQ(variants.front().set, kBaseline);
  EXPECT_EQ(variants.front().kernel, 2);
  EXPECT_TRUE(RunnableVariants<int>({{kFuture, 1}}).empty());
}

TEST(DispatchTest, WhatCannotRunLeavesTheOrderOfTheRest) {
  const auto variants =
      RunnableVariants<int>({{kBaseline, 4}, {kFuture, 3}, {kBaseline, 2}, {kBaseline, 1}});
  std::vector<int> kernels;
  for (const auto& variant : variants) kernels.push_back(variant.kernel);
  EXPECT_THAT(kernels, testing::ElementsAre(4, 2, 1));
}

TEST(DispatchTest, NamesDifferAndAnUnknownSetHasNone) {
  std::set<std::string> names;
  for (const InstructionSet set : {kBaseline, kAvx2, kAvx512, kAvx512Vnni, kFuture}) {
    names.insert(NameOf(set));
  }
  EXPECT_EQ(names.size(), 5u);
  EXPECT_STREQ(NameOf(kFuture), "unknown");
}

// Results, references and many arguments pass through the function that is compiled for a set.
struct MixArguments {
  static PLEAT_ALWAYS_INLINE double Run(const double& a, int8_t b, double* c, long d, float e) {
    *c = a - b;
    return *c * static_cast<double>(d) + e;
  }
};

TEST(DispatchTest, ArgumentsAndResultsArePassedOn) {
  for (const auto& [set, mix] : CompiledVariants<MixArguments>()) {
    double difference = 0;
    EXPECT_EQ(mix(10, -3, &difference, 1L << 40, .5f), 13. * (1L << 40) + .5) << NameOf(set);
    EXPECT_EQ(difference, 13) << NameOf(set);
  }
}

// The rule that makes all variants one: the multiplication is rounded before the addition.
struct SquareMinus {
  static PLEAT_ALWAYS_INLINE double Run(double x, double y) { return x * x - y; }
};

TEST(DispatchTest, NoSetFusesAMultiplicationWithAnAddition) {
  const double x = 1 + 0x1p-30;  // x * x needs 61 bits
  volatile double square = x * x;
  for (const auto& [set, square_minus] : CompiledVariants<SquareMinus>()) {
    EXPECT_EQ(square_minus(x, square), 0) << NameOf(set);
  }
}

// The lists of this module: what every user of a front and every test of all relies on.
template <typename Kernel>
void CheckList(const KernelVariants<Kernel>& variants, const std::vector<InstructionSet>& built) {
  std::vector<InstructionSet> expected;
  for (const InstructionSet set : built) {
    if (ProcessorHas(set)) expected.push_back(set);
  }
  EXPECT_EQ(SetsOf(variants), expected);
  EXPECT_EQ(variants.back().set, kBaseline);
}

TEST(DispatchTest, EveryListHoldsAllThatTheProcessorRunsTheFastestFirst) {
  std::vector<InstructionSet> dense;
  if (Avx512DenseOps() != nullptr) dense.push_back(kAvx512);
  if (Avx2DenseOps() != nullptr) dense.push_back(kAvx2);
  dense.push_back(kBaseline);
  CheckList(DenseVariants(), dense);
  CheckList(PlaneVariants(), {kAvx512Vnni, kAvx512, kAvx2, kBaseline});
  CheckList(WeightedRowsVariants<float>(), {kAvx512, kAvx2, kBaseline});
  CheckList(WeightedRowsVariants<double>(), {kAvx512, kAvx2, kBaseline});
}

TEST(DispatchTest, ListsAreMadeOnceAndNoVariantIsThereTwice) {
  EXPECT_EQ(&DenseVariants(), &DenseVariants());
  EXPECT_EQ(&PlaneVariants(), &PlaneVariants());
  std::set<const DenseOps*> dense;
  for (const auto& variant : DenseVariants()) dense.insert(variant.kernel);
  EXPECT_EQ(dense.size(), DenseVariants().size());
  for (int k = 0; k < kMaxTogether; ++k) {
    std::set<const void*> functions;
    for (const auto& [set, kernel] : PlaneVariants()) {
      functions.insert(reinterpret_cast<const void*>(kernel.expand[k]));
    }
    EXPECT_EQ(functions.size(), PlaneVariants().size()) << k;
  }
}

TEST(DispatchTest, TheProcessUsesTheFront) {
  EXPECT_EQ(&ChosenDenseOps(), DenseVariants().front().kernel);
  EXPECT_EQ(&DenseSolver().ops(), &ChosenDenseOps());
  EXPECT_EQ(&DenseSolver(*BaselineDenseOps()).ops(), BaselineDenseOps());
}

}  // namespace
}  // namespace pleat
