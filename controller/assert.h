#pragma once

/// GAUNTLET_ASSERT(condition): a caller's promise. A false one ends the program with its place and
/// text on stderr. Input of a user is checked by SettingError or UserError instead.
///
/// Only builds of Gauntlet itself define GAUNTLET_ASSERTIONS, and never for the libraries of a
/// robot in a release (cmake/GauntletTargets.cmake). Elsewhere the condition is not computed. An
/// inline function of a public header does the same with and without it, as long as promises are
/// kept.
#ifdef GAUNTLET_ASSERTIONS

#include <cstdio>
#include <cstdlib>

namespace gauntlet::controller {

[[noreturn, gnu::cold, gnu::noinline]] inline void EndForAssertion(const char* condition,
                                                                   const char* file,
                                                                   int line) noexcept {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace gauntlet::controller

#define GAUNTLET_ASSERT(...)            \
  ((__VA_ARGS__) ? static_cast<void>(0) \
                 : ::gauntlet::controller::EndForAssertion(#__VA_ARGS__, __FILE__, __LINE__))

#else

#define GAUNTLET_ASSERT(...) static_cast<void>(sizeof(!(__VA_ARGS__)))

#endif
