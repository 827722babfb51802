// Kernels for several instruction sets, and which of them this processor can run. Nothing else asks
// the processor. README.md shows how a kernel is added.
#pragma once

#include <initializer_list>
#include <type_traits>
#include <vector>

namespace pleat {

enum class InstructionSet {
  kBaseline,    // what the whole build may use
  kAvx2,        // AVX2 and FMA (Intel Haswell, AMD Zen)
  kAvx512,      // AVX-512 F and BW (Intel Skylake-SP, AMD Zen 4)
  kAvx512Vnni,  // the same and VNNI (Intel Cascade Lake, AMD Zen 4)
};

// "baseline", "avx2", "avx512", "avx512vnni".
const char* NameOf(InstructionSet set);

// False for every set but kBaseline where the build is not for x86-64.
bool ProcessorHas(InstructionSet set);

// Attributes of functions that are compiled for such processors: only a kernel that ProcessorHas
// allows may call them. FMA is left out of the first, so that the compiler cannot fuse what the
// other kernels round twice. GCC and Clang both prefer half of the registers of AVX-512 unless
// told otherwise, each in its own words.
#if !defined(__x86_64__)
#define PLEAT_TARGET_AVX2
#define PLEAT_TARGET_AVX512
#define PLEAT_TARGET_AVX512_VNNI
#elif defined(__clang__)
#define PLEAT_TARGET_AVX2 __attribute__((target("avx2")))
#define PLEAT_TARGET_AVX512 __attribute__((target("avx512f,avx512bw"), min_vector_width(512)))
#define PLEAT_TARGET_AVX512_VNNI \
  __attribute__((target("avx512f,avx512bw,avx512vnni"), min_vector_width(512)))
#else
#define PLEAT_TARGET_AVX2 __attribute__((target("avx2")))
#define PLEAT_TARGET_AVX512 __attribute__((target("avx512f,avx512bw,prefer-vector-width=512")))
#define PLEAT_TARGET_AVX512_VNNI \
  __attribute__((target("avx512f,avx512bw,avx512vnni,prefer-vector-width=512")))
#endif

// The body of a kernel and all that it calls in a loop: inlined, it is compiled for the instruction
// set of the function it ends up in.
#define PLEAT_ALWAYS_INLINE inline __attribute__((always_inline))

// Kernel: a pointer to a function or to a table of functions, or such a table itself.
template <typename Kernel>
struct KernelVariant {
  InstructionSet set = InstructionSet::kBaseline;
  Kernel kernel{};
};

// Variants of one kernel that this processor can run, the fastest first: users take the front, and
// tests compare all. The baseline is always among them.
template <typename Kernel>
using KernelVariants = std::vector<KernelVariant<Kernel>>;

// all: the fastest first. A null pointer is a variant that the build does not have.
template <typename Kernel>
KernelVariants<Kernel> RunnableVariants(std::initializer_list<KernelVariant<Kernel>> all) {
  KernelVariants<Kernel> runnable;
  for (const KernelVariant<Kernel>& variant : all) {
    if constexpr (std::is_pointer_v<Kernel>) {
      if (variant.kernel == nullptr) continue;
    }
    if (ProcessorHas(variant.set)) runnable.push_back(variant);
  }
  return runnable;
}

namespace dispatch_internal {

template <typename Body, typename Function>
struct Compiled;

template <typename Body, typename Result, typename... Arguments>
struct Compiled<Body, Result (*)(Arguments...)> {
  static Result ForBaseline(Arguments... arguments) { return Body::Run(arguments...); }
  PLEAT_TARGET_AVX2 static Result ForAvx2(Arguments... arguments) {
    return Body::Run(arguments...);
  }
  PLEAT_TARGET_AVX512 static Result ForAvx512(Arguments... arguments) {
    return Body::Run(arguments...);
  }
};

}  // namespace dispatch_internal

// Body::Run, a static PLEAT_ALWAYS_INLINE function, compiled for one instruction set. Its arguments
// are passed on by value.
template <typename Body, InstructionSet kSet>
constexpr auto CompileFor() {
  using Compiled = dispatch_internal::Compiled<Body, decltype(&Body::Run)>;
  static_assert(kSet != InstructionSet::kAvx512Vnni, "the compiler never chooses VNNI by itself");
  if constexpr (kSet == InstructionSet::kAvx512) {
    return &Compiled::ForAvx512;
  } else if constexpr (kSet == InstructionSet::kAvx2) {
    return &Compiled::ForAvx2;
  } else {
    return &Compiled::ForBaseline;
  }
}

// One body for every instruction set.
template <typename Body>
KernelVariants<decltype(&Body::Run)> CompiledVariants() {
  using enum InstructionSet;
  return RunnableVariants<decltype(&Body::Run)>({{kAvx512, CompileFor<Body, kAvx512>()},
                                                 {kAvx2, CompileFor<Body, kAvx2>()},
                                                 {kBaseline, CompileFor<Body, kBaseline>()}});
}

}  // namespace pleat
