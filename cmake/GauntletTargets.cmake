# The one place where compiler options stand, and the helper every library is made with.

set(GAUNTLET_SOURCE_DIR ${CMAKE_CURRENT_LIST_DIR}/..)
cmake_path(NORMAL_PATH GAUNTLET_SOURCE_DIR)

add_library(gauntlet_options INTERFACE)
target_compile_features(gauntlet_options INTERFACE cxx_std_20)
# -ffp-contract=off: the same bytes from every build and every level of optimisation.
target_compile_options(gauntlet_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off)
# Else Eigen asks the processor how large its caches are, and sums the terms of products in an order that depends on them.
target_compile_definitions(gauntlet_options INTERFACE EIGEN_NO_CPUID)
include(${CMAKE_CURRENT_LIST_DIR}/GauntletSanitizers.cmake)
target_compile_options(gauntlet_options INTERFACE ${GAUNTLET_SANITIZER_FLAGS})
target_link_options(gauntlet_options INTERFACE ${GAUNTLET_SANITIZER_FLAGS})
# Promises of callers are checked (controller/assert.h), but neither in a release of what robots link, the
# targets with GAUNTLET_FOR_ROBOTS, nor where that is all that is built. Those of the standard library would
# cost a release 2 to 10 % more instructions.
if(GAUNTLET_BUILD_SIM)
  set(release_for_robots $<AND:$<CONFIG:Release>,$<BOOL:$<TARGET_PROPERTY:GAUNTLET_FOR_ROBOTS>>>)
  target_compile_definitions(gauntlet_options INTERFACE $<$<NOT:${release_for_robots}>:GAUNTLET_ASSERTIONS>
                                                        $<$<NOT:$<CONFIG:Release>>:_GLIBCXX_ASSERTIONS>)
endif()
# A file is named as it is seen from the root, so that objects do not depend on where that is.
target_compile_options(gauntlet_options INTERFACE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
option(GAUNTLET_UNITY_BUILD "Compile ten sources of a library or a test as one: a whole build takes a third less time" OFF)
if(GAUNTLET_UNITY_BUILD)
  # Types of unnamed namespaces are in files that are included then, which is no mistake here.
  target_compile_options(gauntlet_options INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
endif()

# Rooms that compute have -O3 in a release. What runs for milliseconds at a time has -Og, which compiles in nearly half the
# time, with the same bytes of results. docs/evidence/benchmarks.md has what each level costs.
set(GAUNTLET_COMPUTING_ROOMS base controller glove hand link loop score trial)
# g++ frees what it no longer needs from 128 MB on, which takes a tenth of the time of a source that needs 400.
target_compile_options(gauntlet_options INTERFACE "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:SHELL:--param ggc-min-heapsize=524288>")

# gauntlet_optimise(<target> <folder>)
# Compiles a target as a room of this folder: its level, and the headers that all rooms include, compiled once for each
# level where sources are united (elsewhere a missing include is an error).
function(gauntlet_optimise target folder)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR NOT (GAUNTLET_BUILD_SIM OR GAUNTLET_BUILD_PYTHON))
    return()
  endif()
  set(level -Og)
  if(target MATCHES "_computing$" OR (folder IN_LIST GAUNTLET_COMPUTING_ROOMS AND NOT target MATCHES "_setup$"))
    set(level -O3)
  endif()
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
  if(NOT GAUNTLET_UNITY_BUILD OR NOT CMAKE_BUILD_TYPE STREQUAL "Release")
    return()
  endif()
  set(headers gauntlet_headers${level})
  if(NOT TARGET ${headers})
    set(place ${PROJECT_BINARY_DIR}/cmake/headers${level}.cc)
    file(CONFIGURE OUTPUT ${place} CONTENT "")
    add_library(${headers} OBJECT ${place})
    set_target_properties(${headers} PROPERTIES GAUNTLET_FOR_ROBOTS ON  # no definition that a room lacks
      POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_link_libraries(${headers} PRIVATE Eigen3::Eigen gauntlet_options)
    target_compile_options(${headers} PRIVATE $<$<CONFIG:Release>:${level}>)
    target_precompile_headers(${headers} PRIVATE
      <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional> <map> <memory> <numeric> <optional>
      <ranges> <set> <span> <sstream> <string> <string_view> <unordered_map> <utility> <variant> <vector> <Eigen/Core>)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
  # g++ 12 forgets that a type of a precompiled header is one of the system's, and warns of its visibility.
  target_compile_options(${target} PRIVATE -Wno-attributes)
endfunction()

# gauntlet_unite(<target> <file>...)
# Compiles each ten sources of the target as one, if such builds are wanted. The files named here are one by themselves;
# AND begins another one.
function(gauntlet_unite target)
  if(NOT GAUNTLET_UNITY_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(REMOVE_ITEM sources ${ARGN})
  set(number 0)
  foreach(source IN LISTS sources)
    math(EXPR group "${number} / 10")
    math(EXPR number "${number} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set(group apart)
  foreach(source IN LISTS ARGN)
    if(source STREQUAL "AND")
      string(APPEND group _too)
    else()
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()

# gauntlet_add_library(<folder> SOURCES <file>... [LIBRARIES <target>...] [COMPUTING <file>...] [SETUP <file>...]
#                      [APART <file>... [AND <file>...]...] [EITHER])
# Makes the static library gauntlet_<folder>, included from the project's root.
# COMPUTING: more sources, which are optimised in a release, of a room that is not. SETUP: more sources, which are not, of
# a room that is: they run once, when a part is made.
# APART: sources whose own names are those of another one, so that they cannot be compiled as one, or that take too long
# and too much memory with nine others: see gauntlet_unite().
# EITHER: static or shared, as BUILD_SHARED_LIBS says, where the simulation, which uses more than a shared
# library shows, is not built.
function(gauntlet_add_library folder)
  cmake_parse_arguments(ARG "EITHER" "" "SOURCES;LIBRARIES;COMPUTING;SETUP;APART" ${ARGN})
  set(parts gauntlet_${folder})
  if(ARG_EITHER AND BUILD_SHARED_LIBS AND NOT GAUNTLET_BUILD_SIM)
    add_library(gauntlet_${folder} SHARED ${ARG_SOURCES})
  else()
    add_library(gauntlet_${folder} STATIC ${ARG_SOURCES})
  endif()
  foreach(kind COMPUTING SETUP)
    if(ARG_${kind})
      string(TOLOWER gauntlet_${folder}_${kind} part)
      list(APPEND parts ${part})
      add_library(${part} OBJECT ${ARG_${kind}})
      target_sources(gauntlet_${folder} PRIVATE $<TARGET_OBJECTS:${part}>)
    endif()
  endforeach()
  foreach(part IN LISTS parts)
    # A part of programs and of the Python module.
    set_target_properties(${part} PROPERTIES
      POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    gauntlet_unite(${part} ${ARG_APART})
    gauntlet_optimise(${part} ${folder})
    gauntlet_sanitize_library(${part} ${folder})
    target_include_directories(${part} PUBLIC ${GAUNTLET_SOURCE_DIR})
    target_link_libraries(${part} PUBLIC ${ARG_LIBRARIES} PRIVATE gauntlet_options)
    target_compile_features(${part} PUBLIC cxx_std_20)
  endforeach()
endfunction()

# Optimising what runs for milliseconds takes longer than it saves. g++ 12 then warns of paths that
# it has not seen to be impossible.
set(GAUNTLET_TEST_OPTIONS $<$<CONFIG:Release>:-O1>
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds>
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-use-after-free>)

# With sanitizers the tests of most folders are not optimised, which halves the time of building them. Those
# of these folders are, and without the precompiled header, which is not: they compute for longer than they
# compile, also because templates that they share with a library are linked from the test.
set(GAUNTLET_COMPUTING_TESTS calibrate comparison controller glove hand loop paper robust score search statistics
    study sweep trial trial_table)

# gauntlet_add_test(<name> SOURCES <file>... LIBRARIES <target>... [APART <file>... [AND <file>...]...] [REST <file>...])
# Makes a GoogleTest program whose cases CTest runs one by one. APART: as of gauntlet_add_library().
# REST: more sources, which sanitizers run with GAUNTLET_ALL_ROOMS only: they hold values of long trials, or have no threads.
function(gauntlet_add_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES;APART;REST" ${ARGN})
  if(NOT GAUNTLET_SHORT)
    list(APPEND ARG_SOURCES ${ARG_REST})
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_compile_definitions(${name} PRIVATE $<$<BOOL:${GAUNTLET_SHORT}>:GAUNTLET_SHORT>)
  gauntlet_unite(${name} ${ARG_APART})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} gauntlet_test_support GTest::gmock GTest::gtest_main gauntlet_options)
  target_compile_options(${name} PRIVATE ${GAUNTLET_TEST_OPTIONS})
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  if(NOT GAUNTLET_SANITIZE OR NOT folder IN_LIST GAUNTLET_COMPUTING_TESTS)
    target_compile_options(${name} PRIVATE $<$<BOOL:${GAUNTLET_SANITIZE}>:-O0>)
    target_precompile_headers(${name} REUSE_FROM gauntlet_test_support)
  else()
    target_compile_options(${name} PRIVATE -O2)
  endif()
  set(longest_s 240)
  if(GAUNTLET_SANITIZE)  # which makes everything several times slower
    set(longest_s 900)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${longest_s})
endfunction()

# gauntlet_add_fuzzer(<name> MAX_BYTES <n> SOURCES <file>... LIBRARIES <target>...)
# Makes fuzz_<name>, one of the target fuzzers, of a source with LLVMFuzzerTestOneInput(). As a test it
# runs for half a minute, from the inputs in corpus/<name> and those that it found before.
function(gauntlet_add_fuzzer name)
  cmake_parse_arguments(ARG "" "MAX_BYTES" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(fuzz_${name} ${ARG_SOURCES})
  gauntlet_unite(fuzz_${name})
  add_dependencies(fuzzers fuzz_${name})
  target_include_directories(fuzz_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(fuzz_${name} PRIVATE ${GAUNTLET_COVERAGE_FLAGS})
  target_link_libraries(fuzz_${name} PRIVATE ${ARG_LIBRARIES} gauntlet_options -fsanitize=fuzzer)
  set(found ${CMAKE_CURRENT_BINARY_DIR}/found/${name})
  file(MAKE_DIRECTORY ${found})
  add_test(NAME fuzz_${name}
    COMMAND fuzz_${name} -seed=1 -max_total_time=15 -max_len=${ARG_MAX_BYTES} -timeout=20
            -close_fd_mask=3 -print_final_stats=1 -artifact_prefix=${found}/ ${found}
            ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
  # COST: they start first, so that none of them is left alone at the end.
  set_tests_properties(fuzz_${name} PROPERTIES TIMEOUT 240 COST 30)
endfunction()
