// Attributes of functions that are compiled for newer processors than the build's baseline and
// chosen at run time.
#pragma once

// features: a string literal such as "avx512f". GCC and Clang both prefer half of these registers
// unless told, each in its own words.
#if defined(__clang__)
#define PLEAT_TARGET_AVX512(features) __attribute__((target(features), min_vector_width(512)))
#else
#define PLEAT_TARGET_AVX512(features) __attribute__((target(features ",prefer-vector-width=512")))
#endif
