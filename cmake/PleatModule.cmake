# One module = one folder = one target.
#
#   pleat_add_module(gp DEPENDS base math optimize PACKAGES Eigen3::Eigen)
#
# compiles src/*.cpp into the target pleat_gp, exports include/ alone, and registers the module.
# DEPENDS are modules whose headers the module's own public headers or sources may include; the
# call fails when one of them has not been declared before it, so the declaration order in
# lib/CMakeLists.txt is the only include order and cycles cannot exist.
# PRIVATE_PACKAGES stay out of the include path of dependants (Draco, protobuf, ...). PRECOMPILED names
# the layer whose precompiled headers it uses (PleatPrecompiled.cmake); a module that depends on math
# uses those of math.
set_property(GLOBAL PROPERTY PLEAT_MODULES "")

function(pleat_add_module name)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "DEPENDS;PACKAGES;PRIVATE_PACKAGES" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "pleat_add_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  get_property(declared GLOBAL PROPERTY PLEAT_MODULES)
  foreach(dependency IN LISTS ARG_DEPENDS)
    if(NOT dependency IN_LIST declared)
      message(FATAL_ERROR "module ${name} depends on ${dependency}, which is not declared before "
                          "it: see the include order in ARCHITECTURE.md")
    endif()
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/pleat/*/*.h)
  set(target pleat_${name})
  if(NOT sources OR NOT headers)
    message(FATAL_ERROR "module ${name} has no sources or no public headers")
  endif()
  add_library(${target} STATIC ${sources})
  target_sources(${target} PUBLIC FILE_SET HEADERS
                 BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${headers})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  if(NOT name MATCHES "^server_")  # those stand in programs alone
    target_compile_options(${target} PRIVATE ${PLEAT_SHARED_OPTIONS})
  endif()
  list(TRANSFORM ARG_DEPENDS PREPEND pleat_)
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} ${ARG_PACKAGES}
                        PRIVATE ${ARG_PRIVATE_PACKAGES})
  if(ARG_PRECOMPILED)
    pleat_use_precompiled(${target} ${ARG_PRECOMPILED})
  elseif("pleat_math" IN_LIST ARG_DEPENDS)
    pleat_use_precompiled(${target} math)
  endif()
  if(PLEAT_BATCH_ALL AND NOT name STREQUAL "simd")  # whose files are compiled for processors of their own
    pleat_compile_in_batches(${target})
  endif()
  set_property(GLOBAL APPEND PROPERTY PLEAT_MODULES ${name})
endfunction()

# pleat_add_tests(gp) builds the *_test.cpp of this folder (of its subfolder gp, where there is one)
# into gp_test and registers every case with CTest. Subfolders with a CMakeLists.txt of their own are
# other tests. LIBRARIES adds what the tests use beyond the module itself and tests/support.
function(pleat_add_tests name)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "LIBRARIES" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR})
  if(IS_DIRECTORY ${folder}/${name})
    string(APPEND folder /${name})
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*_test.cpp ${folder}/*/*_test.cpp)
  file(GLOB others ${folder}/*/CMakeLists.txt)
  foreach(other IN LISTS others)
    cmake_path(GET other PARENT_PATH other)
    list(FILTER sources EXCLUDE REGEX "^${other}/")
  endforeach()
  if(NOT sources)
    message(FATAL_ERROR "${folder} has no *_test.cpp")
  endif()
  add_executable(${name}_test ${sources})
  set(module "")
  if(TARGET pleat_${name})
    set(module pleat_${name})
  endif()
  target_link_libraries(${name}_test PRIVATE ${module} ${ARG_LIBRARIES} pleat_test_support
                        GTest::gmock_main)
  target_compile_options(${name}_test PRIVATE ${PLEAT_COLD_OPTIONS})
  if(ARG_PRECOMPILED)
    pleat_use_precompiled(${name}_test ${ARG_PRECOMPILED})
  else()
    pleat_use_precompiled(${name}_test test)
  endif()
  pleat_compile_in_batches(${name}_test)
  if(NOT name IN_LIST PLEAT_TESTS_WITH_GRPC)
    add_dependencies(tests_below_server ${name}_test)
  endif()
  gtest_discover_tests(${name}_test TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT 600 LABELS ${name})
endfunction()
