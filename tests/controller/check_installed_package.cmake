# Installs components into an empty folder and builds and runs a project that knows only them: with
# CMake, and with what pkg-config says of the last of them.
# Called with -DBUILD_DIR, -DCOMPONENTS, -DOUTSIDE_DIR, -DWORK_DIR, -DCXX, -DCXX_FLAGS, and
# -DARGUMENT for the project's program if it takes one.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK_DIR})
foreach(component IN LISTS COMPONENTS)
  run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix --component ${component})
endforeach()
run(${CMAKE_COMMAND} -G Ninja -S ${OUTSIDE_DIR} -B ${WORK_DIR}/build -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/outside ${ARGUMENT})

file(GLOB_RECURSE pkgconfig_file ${WORK_DIR}/prefix/gauntlet-controller.pc)
cmake_path(GET pkgconfig_file PARENT_PATH pkgconfig_dir)
set(ENV{PKG_CONFIG_PATH} ${pkgconfig_dir})
list(GET COMPONENTS -1 component)
execute_process(COMMAND pkg-config --cflags --libs gauntlet-${component}
                OUTPUT_VARIABLE package_flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${CXX_FLAGS} ${package_flags}")
run(${CXX} -std=c++20 ${OUTSIDE_DIR}/main.cc -o ${WORK_DIR}/outside ${flags})
run(${WORK_DIR}/outside ${ARGUMENT})
file(REMOVE_RECURSE ${WORK_DIR})
