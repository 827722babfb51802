#include "pleat/simd/dispatch.h"

namespace pleat {

const char* NameOf(InstructionSet set) {
  switch (set) {
    case InstructionSet::kBaseline:
      return "baseline";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
    case InstructionSet::kAvx512Vnni:
      return "avx512vnni";
  }
  return "unknown";
}

#if defined(__x86_64__)
// These also ask whether the operating system keeps the registers.
bool ProcessorHas(InstructionSet set) {
  switch (set) {
    case InstructionSet::kBaseline:
      return true;
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::kAvx512:
      return ProcessorHas(InstructionSet::kAvx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw");
    case InstructionSet::kAvx512Vnni:
      return ProcessorHas(InstructionSet::kAvx512) && __builtin_cpu_supports("avx512vnni");
  }
  return false;
}
#else
bool ProcessorHas(InstructionSet set) { return set == InstructionSet::kBaseline; }
#endif

}  // namespace pleat
