# Builds controller/ by itself, static and shared, with Eigen alone, installs it, and builds a program of
# somebody else against it: by all compilers that there are, in C++20 and 23, with warnings as errors.
# Called with -DSOURCE_DIR, -DWORK_DIR, -DCXX, -DLAUNCHER (may be empty).
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

foreach(shared OFF ON)
  set(build ${WORK_DIR}/build_${shared})
  set(prefix ${WORK_DIR}/prefix_${shared})
  run(${CMAKE_COMMAND} -E chdir ${WORK_DIR}/source ${CMAKE_COMMAND} -S controller -B ${build} -G Ninja
      -DBUILD_SHARED_LIBS=${shared} -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
      -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=10 -DCMAKE_CXX_COMPILER=${CXX}
      -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_INSTALL_LIBDIR=lib
      -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON)
  run(${CMAKE_COMMAND} --build ${build})
  run(${CMAKE_COMMAND} --install ${build} --prefix ${prefix})
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
endforeach()

# The static library can be part of somebody's shared object: a plug-in, a ROS node.
run(${CXX} -shared -o ${WORK_DIR}/plugin.so -Wl,--whole-archive
    ${WORK_DIR}/prefix_OFF/lib/libgauntlet_controller.a -Wl,--no-whole-archive)
# The shared one has the version in its name.
execute_process(COMMAND readelf -d ${WORK_DIR}/prefix_ON/lib/libgauntlet_controller.so
                OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
if(NOT dynamic MATCHES "soname: \\[libgauntlet_controller.so.[0-9]+.[0-9]+\\]")
  message(FATAL_ERROR "no version in its soname:\n${dynamic}")
endif()
file(REMOVE_RECURSE ${WORK_DIR})
