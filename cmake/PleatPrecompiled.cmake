# Headers that most sources of a layer include, compiled once per layer: parsing Eigen, GoogleMock,
# gRPC or CLI11 takes longer than compiling most of our own files (docs/performance.md, "Build").
#
#   pleat_use_precompiled(TARGET LAYER)     LAYER: math | remote | grpc | cli | test | server_test
#
# A layer is compiled with the options of its targets: math and remote stand in shared libraries too.
# Sources still include what they use. Public headers are checked without any of this, one by one,
# by the target all_verify_interface_header_sets.
option(PLEAT_PRECOMPILED_HEADERS "Compile common headers once" ON)

set(PLEAT_PRECOMPILED_math <algorithm> <functional> <map> <memory> <string> <vector> <Eigen/Dense>
    <absl/status/statusor.h> <absl/strings/str_cat.h>)
set(PLEAT_PRECOMPILED_test ${PLEAT_PRECOMPILED_math} <gmock/gmock.h> <gtest/gtest.h>)
set(PLEAT_PRECOMPILED_grpc ${PLEAT_PRECOMPILED_math} <grpcpp/grpcpp.h>)
set(PLEAT_PRECOMPILED_remote ${PLEAT_PRECOMPILED_grpc})
set(PLEAT_PRECOMPILED_server_test ${PLEAT_PRECOMPILED_test} <grpcpp/grpcpp.h>)
set(PLEAT_PRECOMPILED_cli ${PLEAT_PRECOMPILED_math} <CLI/CLI.hpp> <nlohmann/json.hpp>
    <absl/strings/str_format.h>)
set(PLEAT_PRECOMPILED_PACKAGES_test GTest::gmock)
set(PLEAT_PRECOMPILED_PACKAGES_grpc gRPC::grpc++)
set(PLEAT_PRECOMPILED_PACKAGES_remote gRPC::grpc++)
set(PLEAT_PRECOMPILED_PACKAGES_server_test GTest::gmock gRPC::grpc++)
set(PLEAT_PRECOMPILED_PACKAGES_cli CLI11::CLI11 nlohmann_json::nlohmann_json)

# pleat_compile_in_batches(TARGET) compiles several sources of a target as one: what they all
# instantiate (gMock's matchers, CLI11, JSON, the stubs of gRPC) is compiled once for each batch and
# not once for each file, which is most of the time of such files. Names in anonymous namespaces must
# then differ within the target; the compiler says so when they do not.
option(PLEAT_BATCHES "Compile sources with large headers in batches" ON)
option(PLEAT_BATCH_ALL "Compile the sources of every module in batches: faster from nothing, slower after a change" OFF)
set(PLEAT_BATCH_SIZE 7)

function(pleat_compile_in_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PLEAT_BATCHES}
                        UNITY_BUILD_BATCH_SIZE ${PLEAT_BATCH_SIZE})
  if(PLEAT_BATCHES)
    # gcc takes a source that a batch includes for a header, which should have no anonymous namespace.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

function(pleat_use_precompiled target layer)
  if(NOT PLEAT_PRECOMPILED_HEADERS)
    return()
  endif()
  if(NOT TARGET pleat_precompiled_${layer})
    set(source ${CMAKE_BINARY_DIR}/precompiled/${layer}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "")
    add_library(pleat_precompiled_${layer} OBJECT ${source})
    target_link_libraries(pleat_precompiled_${layer} PRIVATE Eigen3::Eigen absl::statusor
                          absl::strings Threads::Threads ${PLEAT_PRECOMPILED_PACKAGES_${layer}})
    target_precompile_headers(pleat_precompiled_${layer} PRIVATE ${PLEAT_PRECOMPILED_${layer}})
    if(layer MATCHES "math|remote")
      target_compile_options(pleat_precompiled_${layer} PRIVATE ${PLEAT_SHARED_OPTIONS})
    endif()
    if(layer MATCHES "grpc|remote|server")
      target_compile_options(pleat_precompiled_${layer} PRIVATE -pthread)
    endif()
    if(layer MATCHES "test|cli")
      target_compile_options(pleat_precompiled_${layer} PRIVATE ${PLEAT_COLD_OPTIONS})
    endif()
  endif()
  if(layer MATCHES "grpc|remote|server")  # spdlog asks for it; compiler and user of the headers must agree
    target_compile_options(${target} PRIVATE -pthread)
  endif()
  target_precompile_headers(${target} REUSE_FROM pleat_precompiled_${layer})
endfunction()
