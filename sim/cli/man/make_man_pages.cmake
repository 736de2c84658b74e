# Writes gauntlet.1 and a page per command, gauntlet-run.1 .., from the texts of --help. Run at build time:
#   cmake -D PROGRAM=<gauntlet> -D HELP2MAN=<help2man> -D SECTIONS=<sections.h2m> -D VERSION=<version>
#         -D OUTPUT_DIR=<folder> -P make_man_pages.cmake

# make_page(<name of the page> <its one line> <option for help> <command>..)
function(make_page page summary help)
  list(JOIN ARGN " " command)
  execute_process(
    COMMAND ${HELP2MAN} --no-info --section=1 "--name=${summary}" "--source=Gauntlet ${VERSION}"
            --version-string=${VERSION} "--help-option=${help}" --include=${SECTIONS} --include=${OUTPUT_DIR}/see_also.h2m "${command}"
    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  # Titled as the page is called, and without the day on which it was made.
  string(TOUPPER ${page} title)
  string(REGEX REPLACE "\n\\.TH [^\n]*" "\n.TH ${title} \"1\" \"\" \"Gauntlet ${VERSION}\" \"User Commands\""
         text "${text}")
  string(REGEX REPLACE "\n\\.SH NAME\n[^\n]*" "\n.SH NAME\n${page} \\\\- ${summary}" text "${text}")
  # Examples have their section and keep their lines.
  string(REPLACE ".SS \"Example:\"" ".SH EXAMPLES" text "${text}")
  string(REGEX REPLACE "\n\\.IP\n(([^.\n][^\n]*\n)+)" "\n.IP\n.nf\n\\1.fi\n" text "${text}")
  file(WRITE ${OUTPUT_DIR}/${page}.1 "${text}")
endfunction()

file(REMOVE_RECURSE ${OUTPUT_DIR})
execute_process(COMMAND ${PROGRAM} --complete "" OUTPUT_VARIABLE offered COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," offered "${offered}")  # no ends of CMake's lists
string(REGEX MATCHALL "[a-z]+\t[^\n]+" commands "${offered}")
if(NOT commands)
  message(FATAL_ERROR "gauntlet --complete names no commands:\n${offered}")
endif()
set(see_also "[SEE ALSO]\n.BR gauntlet (1)")
foreach(line IN LISTS commands)
  string(REGEX REPLACE "^([a-z]+)\t.*" ",\n.BR gauntlet-\\1 (1)" page "${line}")
  string(APPEND see_also "${page}")
endforeach()
file(WRITE ${OUTPUT_DIR}/see_also.h2m "${see_also}\n")
foreach(line IN LISTS commands)
  string(REGEX MATCH "^([a-z]+)\t(.+)$" found "${line}")
  make_page(gauntlet-${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" --help ${PROGRAM} ${CMAKE_MATCH_1})
endforeach()
make_page(gauntlet "testbed for glove-driven, tendon-driven prosthetic hands" "--help --all" ${PROGRAM})
file(REMOVE ${OUTPUT_DIR}/see_also.h2m)
