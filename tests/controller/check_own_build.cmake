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

run(${CMAKE_COMMAND} -E chdir ${WORK_DIR}/source ${CMAKE_COMMAND} -S controller -B ${WORK_DIR}/build -G Ninja
    -DBUILD_SHARED_LIBS=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
    -DGAUNTLET_UNITY_BUILD=ON -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
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
  # Eigen's own warnings are not Gauntlet's.
  string(REGEX REPLACE "-I([^ ]*eigen3)" "-isystem \\1" flags "${flags}")
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

# The shared library has exactly the functions of the C header, beside those of C++.
set(library ${WORK_DIR}/shared/lib/libgauntlet_controller.so)
execute_process(COMMAND nm -D --defined-only --format=just-symbols ${library}
                OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
list(FILTER symbols EXCLUDE REGEX "^_Z")
file(READ ${SOURCE_DIR}/controller/c_api/gauntlet_controller.h header)
string(REGEX MATCHALL "\n[a-z0-9_]+[* ]+gauntlet_controller_[a-z_]+\\(" functions "${header}")
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
if(NOT dynamic MATCHES "soname: \\[libgauntlet_controller.so.[0-9]+.[0-9]+\\]")
  message(FATAL_ERROR "no version in its soname:\n${dynamic}")
endif()
file(REMOVE_RECURSE ${WORK_DIR})
