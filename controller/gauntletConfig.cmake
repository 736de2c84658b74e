include(CMakeFindDependencyMacro)
include(${CMAKE_CURRENT_LIST_DIR}/gauntletTargets.cmake)
set(gauntlet_controller_FOUND TRUE)

# Robot files (sim/settings), if they are installed, too, and asked for.
set(settings_targets ${CMAKE_CURRENT_LIST_DIR}/gauntletSettingsTargets.cmake)
if("settings" IN_LIST gauntlet_FIND_COMPONENTS AND EXISTS ${settings_targets})
  find_dependency(yaml-cpp)
  find_dependency(fmt)
  include(${settings_targets})
  set(gauntlet_settings_FOUND TRUE)
endif()

foreach(component IN LISTS gauntlet_FIND_COMPONENTS)
  if(gauntlet_FIND_REQUIRED_${component} AND NOT gauntlet_${component}_FOUND)
    set(gauntlet_FOUND FALSE)
    set(gauntlet_NOT_FOUND_MESSAGE "component ${component} is not installed")
  endif()
endforeach()
