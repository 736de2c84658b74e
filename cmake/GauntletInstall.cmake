# What `cmake --install` puts beside the libraries for a robot (controller/, sim/settings/): the
# program, what it needs, and what tells about it. Nothing of it names the place where it was built.

install(TARGETS gauntlet RUNTIME COMPONENT program)
# Where OwnLibrary() of sim/base/data_folder.h looks.
install(TARGETS gauntlet_drawing LIBRARY DESTINATION lib/gauntlet COMPONENT program)
# Where DataFolder() looks.
install(DIRECTORY models scenarios studies DESTINATION share/gauntlet COMPONENT program
        PATTERN "*.py" EXCLUDE PATTERN "*.gp" EXCLUDE)
# What wheels for pip leave out.
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
        FILES_MATCHING PATTERN "*.md" PATTERN "*.html" PATTERN "*.png" PATTERN "*.mp4")
install(FILES README.md CHANGELOG.md CITATION.cff SECURITY.md LICENSE
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(FILES sim/cli/completion/gauntlet DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT documentation)
install(FILES sim/cli/completion/_gauntlet DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
        COMPONENT documentation)

# Pages for man, made of what --help says.
find_program(GAUNTLET_HELP2MAN help2man)
if(NOT GAUNTLET_HELP2MAN)
  if(GAUNTLET_BUILD_TESTS)
    message(FATAL_ERROR "the tests need help2man")
  endif()
  message(STATUS "help2man is not installed: no pages for man")
  return()
endif()
set(pages_dir ${PROJECT_BINARY_DIR}/man)
set(pages_source ${PROJECT_SOURCE_DIR}/sim/cli/man)
add_custom_command(
  OUTPUT ${pages_dir}/gauntlet.1
  COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:gauntlet> -D HELP2MAN=${GAUNTLET_HELP2MAN}
          -D SECTIONS=${pages_source}/sections.h2m -D VERSION=${PROJECT_VERSION}
          -D OUTPUT_DIR=${pages_dir} -P ${pages_source}/make_man_pages.cmake
  DEPENDS gauntlet ${pages_source}/make_man_pages.cmake ${pages_source}/sections.h2m
  COMMENT "Making the pages for man"
  VERBATIM)
add_custom_target(man_pages ALL DEPENDS ${pages_dir}/gauntlet.1)
install(DIRECTORY ${pages_dir}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT documentation)
