# The physics engine as mujoco::mujoco: 2.2.2 of Debian, the reference, or one of PyPI's packages.

set(GAUNTLET_MUJOCO "" CACHE PATH "Folder 'mujoco' of an unpacked package mujoco or mujoco-core of PyPI, in place of MuJoCo 2.2.2")

if(NOT GAUNTLET_MUJOCO)
  find_package(mujoco 2.2.2 EXACT REQUIRED)
  # Debian's target exports an include path that does not exist.
  get_target_property(mujoco_includes mujoco::mujoco INTERFACE_INCLUDE_DIRECTORIES)
  list(FILTER mujoco_includes EXCLUDE REGEX "libqhull_r")
  set_target_properties(mujoco::mujoco PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${mujoco_includes}")
  return()
endif()

# Those that docs/evidence/mujoco-versions.md compares, as their headers have them.
set(mujoco_version_3017000 3.17.0)
set(mujoco_version_4000000 4.0.0)
set(mujoco_header ${GAUNTLET_MUJOCO}/include/mujoco/mujoco.h)
if(NOT EXISTS ${mujoco_header})
  message(FATAL_ERROR "GAUNTLET_MUJOCO: there is no ${mujoco_header}; it must be the folder 'mujoco' of PyPI's mujoco 3.17.0 or mujoco-core 4.0.0")
endif()
file(STRINGS ${mujoco_header} mujoco_number REGEX "^#define mjVERSION_HEADER ")
string(REGEX REPLACE "[^0-9]" "" mujoco_number "${mujoco_number}")
if(NOT DEFINED mujoco_version_${mujoco_number})
  message(FATAL_ERROR "GAUNTLET_MUJOCO: mjVERSION_HEADER of ${mujoco_header} is ${mujoco_number}; it must be 3017000 (MuJoCo 3.17.0) or 4000000 (4.0.0)")
endif()
set(mujoco_library ${GAUNTLET_MUJOCO}/libmujoco.so.${mujoco_version_${mujoco_number}})
if(NOT EXISTS ${mujoco_library})
  message(FATAL_ERROR "GAUNTLET_MUJOCO: there is no ${mujoco_library}, the library of the headers beside it")
endif()
message(STATUS "MuJoCo ${mujoco_version_${mujoco_number}}: ${GAUNTLET_MUJOCO}; the reference is 2.2.2")
add_library(mujoco::mujoco SHARED IMPORTED)
set_target_properties(mujoco::mujoco PROPERTIES
  IMPORTED_LOCATION ${mujoco_library}
  INTERFACE_INCLUDE_DIRECTORIES ${GAUNTLET_MUJOCO}/include)
