# Compiler settings shared by every target. Warnings are errors: main always builds clean.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()

find_program(PLEAT_CCACHE ccache)
if(PLEAT_CCACHE)
  # With precompiled headers ccache must be told that what they define is known to it.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      ${PLEAT_CCACHE})
endif()

# -ffp-contract=off and no -ffast-math: the same bytes in must give the same model bytes out on
# every build of one source tree (ARCHITECTURE.md, invariants).
add_compile_options(-Wall -Wextra -Werror -Wno-psabi -ffp-contract=off)
# For lib/, proto/ and client/remote: one compilation serves programs and the shared libraries of
# client/c. Without semantic interposition the compiler inlines as it does for programs; sections let
# the linker leave out what a library does not use.
set(PLEAT_SHARED_OPTIONS -fPIC -fno-semantic-interposition -ffunction-sections -fdata-sections)
string(REPLACE "-O2" "-O3" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
string(REPLACE "-g" "-g1" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")

# At -O1 gcc 12 sees uninitialized values in Eigen and dangling references to arguments that are none.
set(PLEAT_O1_WARNINGS $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
                      $<$<CXX_COMPILER_ID:GNU>:-Wno-dangling-pointer>)
# Tests and the command line spend their time in the library: optimizing their own code, and saying
# in the object files where each line of it went, costs more than it gives. Sanitizers name lines.
set(PLEAT_COLD_OPTIONS -O1 ${PLEAT_O1_WARNINGS})
if(NOT PLEAT_SANITIZE AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  list(APPEND PLEAT_COLD_OPTIONS -g0)
endif()

if(PLEAT_SANITIZE)
  # Less optimization: the compiler takes most of the time of these workflows, not the tests.
  string(REPLACE "-O3" "-O1" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
  add_compile_options(-fsanitize=${PLEAT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
                      ${PLEAT_O1_WARNINGS})
  add_link_options(-fsanitize=${PLEAT_SANITIZE})
endif()
if(PLEAT_BUILD_FUZZERS)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
