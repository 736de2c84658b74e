# Builds controller/ by itself, shared, with Eigen alone, installs it, and builds a program of somebody else
# against it, and against the static library of BUILD_DIR: by all compilers that there are, in C++20 and 23,
# with warnings as errors. So do the examples in C and Python. Called with -DSOURCE_DIR, -DBUILD_DIR,
# -DWORK_DIR, -DCXX, -DRELEASE (BUILD_DIR is one), and -DLAUNCHER and -DPYTHON, which may be empty.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(strict -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror)
set(main ${SOURCE_DIR}/tests/controller/outside_project/main.cc)
set(compilers ${CXX})
find_program(another_compiler NAMES clang++ clang++-14)
if(another_compiler)
  list(APPEND compilers ${another_compiler})
else()
  message("not tried: there is no clang++")
endif()

# As controller/examples/README.md tells it, in a folder that has no more of Gauntlet than it needs.
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR}/source)
foreach(name controller cmake CMakeLists.txt LICENSE)
  file(CREATE_LINK ${SOURCE_DIR}/${name} ${WORK_DIR}/source/${name} SYMBOLIC)
endforeach()
file(READ ${SOURCE_DIR}/controller/examples/README.md readme)
foreach(line "cmake -S controller -B build/controller" "cmake --build build/controller"
             "cmake --install build/controller --prefix /usr/local")
  string(FIND "${readme}" "\n    ${line}\n" found)
  if(found EQUAL -1)
    message(FATAL_ERROR "controller/examples/README.md does not say \"${line}\"")
  endif()
endforeach()

# What the examples in C and Python read: where the motors are, and samples of two sensors.
set(examples ${SOURCE_DIR}/controller/examples)
string(REPEAT "512 " 18 samples)
foreach(k RANGE 300)
  math(EXPR counts "400 + ${k} / 3")
  string(APPEND samples "\n${counts} ${counts}")
endforeach()
file(WRITE ${WORK_DIR}/samples.txt "${samples}\n")
find_program(c_compiler NAMES gcc cc REQUIRED)
# commands(<variable> <command>...): what an example prints.
function(commands variable)
  execute_process(COMMAND ${ARGN} INPUT_FILE ${WORK_DIR}/samples.txt OUTPUT_VARIABLE output
                  COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output MATCHES "\n300( [0-9]+)+\n$")
    message(FATAL_ERROR "${ARGN}: no command at the last event:\n${output}")
  endif()
  set(${variable} "${output}" PARENT_SCOPE)
endfunction()

# As its README says, but ten sources as one. (.ci/run all builds everything source by source, too.)
run(${CMAKE_COMMAND} -E chdir ${WORK_DIR}/source ${CMAKE_COMMAND} -S controller -B ${WORK_DIR}/build -G Ninja
    -DBUILD_SHARED_LIBS=ON -DGAUNTLET_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${CMAKE_COMMAND} --install ${WORK_DIR}/build --prefix ${WORK_DIR}/shared)
run(${CMAKE_COMMAND} --install ${BUILD_DIR}/controller --prefix ${WORK_DIR}/static --component controller)

foreach(kind static shared)
  set(prefix ${WORK_DIR}/${kind})
  foreach(file include/gauntlet/controller/controller.h share/doc/gauntlet-controller/LICENSE
               lib/cmake/gauntlet/gauntletConfig.cmake lib/pkgconfig/gauntlet-controller.pc)
    if(NOT EXISTS ${prefix}/${file})
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
  set(ENV{PKG_CONFIG_PATH} ${prefix}/lib/pkgconfig)
  execute_process(COMMAND pkg-config --cflags gauntlet-controller OUTPUT_VARIABLE flags
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND pkg-config --libs gauntlet-controller OUTPUT_VARIABLE libraries
                  COMMAND_ERROR_IS_FATAL ANY)
  if("${flags} ${libraries}" MATCHES "eigen")
    message(FATAL_ERROR "a program needs Eigen: ${flags} ${libraries}")
  endif()
  separate_arguments(flags UNIX_COMMAND "${flags}")
  separate_arguments(libraries UNIX_COMMAND "${libraries}")
  foreach(compiler IN LISTS compilers)
    foreach(standard c++20 c++2b)
      cmake_path(GET compiler FILENAME name)
      set(object ${WORK_DIR}/${name}-${standard}.o)  # both libraries have the same headers
      if(NOT EXISTS ${object})
        run(${compiler} -std=${standard} ${strict} ${flags} -c ${main} -o ${object})
      endif()
      run(${compiler} ${object} -o ${WORK_DIR}/outside ${libraries} -Wl,-rpath,${prefix}/lib)
      run(${WORK_DIR}/outside)
    endforeach()
  endforeach()
  # From C, which does not know that the library is C++: a static one needs its libraries, too.
  execute_process(COMMAND pkg-config --static --libs gauntlet-controller OUTPUT_VARIABLE libraries
                  COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(libraries UNIX_COMMAND "${libraries}")
  run(${c_compiler} -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror ${flags}
      ${examples}/07_from_c.c -o ${WORK_DIR}/from_c_${kind} ${libraries} -Wl,-rpath,${prefix}/lib)
  commands(from_c_${kind} ${WORK_DIR}/from_c_${kind} ${examples}/robot.txt)
endforeach()
if(NOT from_c_static STREQUAL from_c_shared)
  message(FATAL_ERROR "static and shared give other commands")
endif()

# Programs that are compiled for other instructions than the library, by all compilers. All examples through CMake, and
# through pkg-config those that make and free most in the library.
set(ENV{CMAKE_PREFIX_PATH} ${WORK_DIR}/shared)
set(ENV{PKG_CONFIG_PATH} ${WORK_DIR}/shared/lib/pkgconfig)
execute_process(COMMAND pkg-config --cflags --libs gauntlet-controller OUTPUT_VARIABLE flags
                COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags} -Wl,-rpath,${WORK_DIR}/shared/lib -pthread")
set(for_this_processor -march=native)
execute_process(COMMAND ${CXX} -mavx2 -E -x c++ /dev/null RESULT_VARIABLE avx2 OUTPUT_QUIET ERROR_QUIET)
if(avx2 EQUAL 0)
  set(for_this_processor -march=native -mavx2)
endif()
file(GLOB sources RELATIVE ${examples} ${examples}/*.cc)
list(JOIN strict " " strict_line)
list(JOIN for_this_processor " " processor_line)
foreach(compiler IN LISTS compilers)
  cmake_path(GET compiler FILENAME name)
  set(build ${WORK_DIR}/examples-${name})
  run(${CMAKE_COMMAND} -S ${examples} -B ${build} -G Ninja -DCMAKE_CXX_COMPILER=${compiler}
      "-DCMAKE_CXX_FLAGS=${strict_line} ${processor_line}")
  run(${CMAKE_COMMAND} --build ${build})
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM example)
    run(${build}/${example})
  endforeach()
  foreach(example 05_calibrate 06_change_from_another_thread)
    run(${compiler} -std=c++20 ${strict} ${for_this_processor} ${examples}/${example}.cc -o ${WORK_DIR}/example
        ${flags})
    run(${WORK_DIR}/example)
  endforeach()
endforeach()

# As a part of another project: by add_subdirectory() of controller/, and by FetchContent of all, which configures
# neither the simulation nor tests.
foreach(way IN ITEMS "add_subdirectory(${SOURCE_DIR}/controller controller)"
                     "include(FetchContent)\nFetchContent_Declare(gauntlet SOURCE_DIR ${SOURCE_DIR})\nFetchContent_MakeAvailable(gauntlet)")
  file(WRITE ${WORK_DIR}/robot/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(robot LANGUAGES CXX)
${way}
add_executable(robot ${examples}/01_glove_to_motors.cc)
target_link_libraries(robot PRIVATE gauntlet::controller)
get_property(tests DIRECTORY \${CMAKE_BINARY_DIR} PROPERTY TESTS)
if(TARGET gauntlet OR tests)
  message(FATAL_ERROR \"more than the controller\")
endif()
")
  run(${CMAKE_COMMAND} -S ${WORK_DIR}/robot -B ${WORK_DIR}/robot_build -G Ninja --fresh
      -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON)
  execute_process(COMMAND ninja -C ${WORK_DIR}/robot_build -t inputs robot OUTPUT_VARIABLE inputs
                  COMMAND_ERROR_IS_FATAL ANY)
  if(NOT inputs MATCHES "libgauntlet_controller.a" OR NOT inputs MATCHES "controller.cc|unity")
    message(FATAL_ERROR "the robot's program does not need the library:\n${inputs}")
  endif()
endforeach()

# Headers of the library itself are not installed, and none that is includes Eigen.
file(GLOB_RECURSE headers RELATIVE ${WORK_DIR}/shared/include/gauntlet ${WORK_DIR}/shared/include/*)
file(GLOB_RECURSE all_headers RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/controller/*.h)
list(LENGTH headers header_count)
list(LENGTH all_headers all_header_count)
if(NOT header_count LESS all_header_count)
  message(FATAL_ERROR "all headers are installed")
endif()
set(everything "")
foreach(header IN LISTS headers)
  string(APPEND everything "#include \"${header}\"\n")
endforeach()
file(WRITE ${WORK_DIR}/everything.cc "${everything}")
run(${CXX} -std=c++20 ${strict} -I${WORK_DIR}/shared/include/gauntlet -fsyntax-only ${WORK_DIR}/everything.cc)
file(WRITE ${WORK_DIR}/controller.cc "#include \"controller/controller.h\"\n")
execute_process(COMMAND ${CXX} -std=c++20 -I${WORK_DIR}/shared/include/gauntlet -E ${WORK_DIR}/controller.cc
                OUTPUT_VARIABLE preprocessed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n" lines "${preprocessed}")
list(LENGTH lines line_count)
if(line_count GREATER 75000)
  message(FATAL_ERROR "controller.h brings ${line_count} lines, must be at most 75000")
endif()

# The shared library has exactly the functions of the C header, beside those of C++, and nothing of others.
set(library ${WORK_DIR}/shared/lib/libgauntlet_controller.so)
execute_process(COMMAND nm -D --defined-only --format=just-symbols ${library}
                OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
set(foreign ${symbols})
list(FILTER foreign EXCLUDE REGEX "^(_ZNK?8gauntlet|_ZT[ISV]N8gauntlet|gauntlet_controller_)")
if(foreign)
  message(FATAL_ERROR "the shared library shows symbols of others:\n${foreign}")
endif()
string(REGEX MATCH "12SettingErrorE" shown "${symbols}")
string(REGEX MATCH "9TendonMap|10Controller5State" hidden "${symbols}")
if(NOT shown OR hidden)
  message(FATAL_ERROR "the shared library does not show what GAUNTLET_API marks, and only that")
endif()
list(FILTER symbols EXCLUDE REGEX "^_Z")
file(READ ${SOURCE_DIR}/controller/c_api/gauntlet_controller.h header)
string(REGEX MATCHALL "\n[a-z][a-z0-9_ ]*[* ]+gauntlet_controller_[a-z_]+\\(" functions "${header}")
list(TRANSFORM functions REPLACE ".*[* ](gauntlet_controller_[a-z_]+).*" "\\1")
list(SORT symbols)
list(SORT functions)
if(NOT symbols STREQUAL functions)
  message(FATAL_ERROR "the header declares\n${functions}\nand the library has\n${symbols}")
endif()

if(PYTHON)
  commands(from_python ${PYTHON} ${examples}/08_from_python.py ${library} ${examples}/robot.txt)
  if(NOT from_python STREQUAL from_c_shared)
    message(FATAL_ERROR "other commands from Python:\n${from_python}\nthan from C:\n${from_c_shared}")
  endif()
else()
  message("not tried: there is no python3")
endif()

# Neither has assertions, which are for Gauntlet's own builds; those for the debugger have them.
set(without_assertions ${library})
if(RELEASE)
  list(APPEND without_assertions ${WORK_DIR}/static/lib/libgauntlet_controller.a)
endif()
foreach(file IN LISTS without_assertions)
  file(STRINGS ${file} found REGEX "assertion failed")
  if(found)
    message(FATAL_ERROR "${file} has assertions:\n${found}")
  endif()
endforeach()

# The static library can be part of somebody's shared object: a plug-in, a ROS node.
run(${CXX} -shared -o ${WORK_DIR}/plugin.so -Wl,--whole-archive
    ${WORK_DIR}/static/lib/libgauntlet_controller.a -Wl,--no-whole-archive)
# The shared one has the version in its name.
execute_process(COMMAND readelf -d ${WORK_DIR}/shared/lib/libgauntlet_controller.so
                OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
if(NOT dynamic MATCHES "soname: \\[libgauntlet_controller.so.0.4\\]")
  message(FATAL_ERROR "no version in its soname:\n${dynamic}")
endif()
file(REMOVE_RECURSE ${WORK_DIR})
