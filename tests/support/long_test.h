#pragma once
// Tests that take minutes with sanitizers.
#include <gtest/gtest.h>

/// At the begin of a test that runs again what shorter ones run, with other values or at more
/// moments: builds with sanitizers that are made for every change leave it out, `.ci/run all` does
/// not.
#ifdef GAUNTLET_SHORT
#define GAUNTLET_LONG_TEST() GTEST_SKIP() << "long: see .ci/run all"
#else
#define GAUNTLET_LONG_TEST() static_cast<void>(0)
#endif
