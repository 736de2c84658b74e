# Builds with clang's sanitizers: their options, and the rooms whose tests they run.

# The allow lists: the tests that sanitizers run for every change.
# address: rooms that read or write bytes of others, controller/, and cli, whose tests are whole commands.
set(GAUNTLET_SANITIZED_ROOMS support controller base settings recordings inspect device calibrate trial live scenario
    trial_table cli)
# thread: rooms with threads. Of those of `study` and `video` only the files that are about threads.
set(GAUNTLET_THREADED_ROOMS support controller device live study video)
# With GAUNTLET_ALL_ROOMS also what runs in the threads of studies.
set(GAUNTLET_ROOMS_OF_STUDIES trial_table comparison sweep search robust)

# Of these rooms only what is short: see REST of gauntlet_add_test() and tests/support/long_test.h.
set(GAUNTLET_SHORT OFF)
if(GAUNTLET_SANITIZE AND NOT GAUNTLET_ALL_ROOMS)
  set(GAUNTLET_SHORT ON)
endif()

# Libraries whose branches fuzzers follow: those of the fuzzers that run for every change, or of all.
set(GAUNTLET_COVERED_ROOMS base settings tables recordings inspect scenario)
if(GAUNTLET_ALL_ROOMS)
  list(APPEND GAUNTLET_COVERED_ROOMS controller device calibrate trial live trial_table comparison)
endif()

set(GAUNTLET_SANITIZER_FLAGS "")
if(GAUNTLET_SANITIZE STREQUAL "address")
  # vptr asks the system for a pipe, which the process that reads a stranger's trace may not have.
  set(GAUNTLET_SANITIZER_FLAGS -fsanitize=address,undefined -fno-sanitize=vptr
      -fno-sanitize-recover=undefined -fno-omit-frame-pointer
      -fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/../tests/support/unchecked.txt
      -D__SANITIZE_ADDRESS__)  # as GCC has it
elseif(GAUNTLET_SANITIZE STREQUAL "thread")
  set(GAUNTLET_SANITIZER_FLAGS -fsanitize=thread -D__SANITIZE_THREAD__)
elseif(GAUNTLET_SANITIZE)
  message(FATAL_ERROR "GAUNTLET_SANITIZE is ${GAUNTLET_SANITIZE}; it may be address, thread or empty")
endif()
if(GAUNTLET_SANITIZE AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "GAUNTLET_SANITIZE needs clang++, which has the fuzzers and takes less time to build; this is ${CMAKE_CXX_COMPILER}")
endif()
list(JOIN GAUNTLET_SANITIZER_FLAGS " " GAUNTLET_SANITIZER_FLAG_LINE)  # for builds of other projects
# Tells a fuzzer which branches an input takes.
set(GAUNTLET_COVERAGE_FLAGS -fsanitize=fuzzer-no-link
    -fsanitize-coverage-ignorelist=${CMAKE_CURRENT_LIST_DIR}/../tests/fuzz/uncovered.txt)

# gauntlet_sanitize_library(<target> <room>)
# What a library has with sanitizers in addition to the options of all. What computes (GAUNTLET_COMPUTING_ROOMS, and
# COMPUTING of gauntlet_add_library()) takes longer to run than to compile; the rest is not optimised, which halves the
# time of compiling it.
function(gauntlet_sanitize_library target room)
  if(GAUNTLET_SANITIZE AND (room IN_LIST GAUNTLET_COMPUTING_ROOMS OR target MATCHES "_computing$"))
    target_compile_options(${target} PRIVATE -O2)
  endif()
  if(GAUNTLET_SANITIZE STREQUAL "address" AND room IN_LIST GAUNTLET_COVERED_ROOMS)
    target_compile_options(${target} PRIVATE ${GAUNTLET_COVERAGE_FLAGS})
  endif()
endfunction()

# gauntlet_rooms_to_test(<variable> <room>...)
# Sets the variable to those of the rooms, in their order, whose tests this build has.
function(gauntlet_rooms_to_test result)
  set(rooms ${ARGN})
  set(allowed ${ARGN})
  if(GAUNTLET_SANITIZE STREQUAL "thread")
    set(allowed ${GAUNTLET_THREADED_ROOMS})
    if(GAUNTLET_ALL_ROOMS)
      list(APPEND allowed ${GAUNTLET_ROOMS_OF_STUDIES})
    endif()
  elseif(GAUNTLET_SHORT)
    set(allowed ${GAUNTLET_SANITIZED_ROOMS})
  endif()
  list(JOIN allowed "|" allowed)
  list(FILTER rooms INCLUDE REGEX "^(${allowed})$")
  set(${result} ${rooms} PARENT_SCOPE)
endfunction()
