# Writes OUTPUT, a .cc file that defines the strings of assets.h. Run at build time:
#   cmake -D OUTPUT=.. -D ASSETS=<folder> -D DYGRAPHS=<folder> -D SCRIPTS=a.js,b.js
#         -D CELLS_SCRIPTS=a.js,c.js -P embed_assets.cmake

# GCC takes string literals of any length.
function(add_text constant text)
  if(text MATCHES "\\)asset\"")
    message(FATAL_ERROR "${constant} holds the end mark of its string")
  endif()
  string(APPEND code "const std::string_view ${constant} = R\"asset(${text})asset\";\n")
  set(code "${code}" PARENT_SCOPE)
endfunction()

function(read_text path)
  file(READ "${path}" text)
  # Maps of sources are not in the page; a browser would look for them beside it.
  string(REGEX REPLACE "(//|/\\*)# sourceMappingURL=[^\n]*" "" text "${text}")
  if(text MATCHES "</(script|style)" AND NOT path MATCHES "\\.html$")
    message(FATAL_ERROR "${path} would end its element of the page")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

set(code "#include \"sim/report/assets.h\"\n\nnamespace gauntlet::sim::assets {\n\n")
read_text("${ASSETS}/page.html")
add_text(kPageHtml "${text}")
read_text("${ASSETS}/page.css")
add_text(kStyle "${text}")
read_text("${DYGRAPHS}/dygraph.min.css")
add_text(kPlotStyle "${text}")
read_text("${DYGRAPHS}/dygraph.min.js")
add_text(kPlotLibrary "${text}")
read_text("${ASSETS}/cells.html")
add_text(kCellsHtml "${text}")
read_text("${ASSETS}/cells.css")
add_text(kCellsStyle "${text}")

function(add_scripts constant names)
  string(REPLACE "," ";" names "${names}")
  set(script "")
  foreach(name IN LISTS names)
    read_text("${ASSETS}/${name}")
    string(APPEND script "// ${name}\n${text}\n")
  endforeach()
  add_text(${constant} "${script}")
  set(code "${code}" PARENT_SCOPE)
endfunction()

add_scripts(kScript "${SCRIPTS}")
add_scripts(kCellsScript "${CELLS_SCRIPTS}")
string(APPEND code "\n}  // namespace gauntlet::sim::assets\n")
file(WRITE "${OUTPUT}" "${code}")
