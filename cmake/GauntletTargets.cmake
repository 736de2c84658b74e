# The one place where compiler options stand, and the helper every library is made with.

add_library(gauntlet_options INTERFACE)
target_compile_features(gauntlet_options INTERFACE cxx_std_20)
# -ffp-contract=off: the same bytes from every build and every level of optimisation.
target_compile_options(gauntlet_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off)
if(GAUNTLET_SANITIZE)
  target_compile_options(gauntlet_options INTERFACE
                         -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(gauntlet_options INTERFACE -fsanitize=address,undefined)
endif()

# gauntlet_add_library(<folder> SOURCES <file>... [LIBRARIES <target>...])
# Makes the static library gauntlet_<folder>, included from the project's root.
function(gauntlet_add_library folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_library(gauntlet_${folder} STATIC ${ARG_SOURCES})
  target_include_directories(gauntlet_${folder} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(gauntlet_${folder} PUBLIC ${ARG_LIBRARIES} PRIVATE gauntlet_options)
  target_compile_features(gauntlet_${folder} PUBLIC cxx_std_20)
endfunction()

# gauntlet_add_test(<name> SOURCES <file>... LIBRARIES <target>...)
# Makes a GoogleTest program whose cases CTest runs one by one.
function(gauntlet_add_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} gauntlet_test_support GTest::gmock GTest::gtest_main gauntlet_options)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 240)
endfunction()
