#pragma once

/// GAUNTLET_API: what programs may use of the shared library; it hides everything else.
#define GAUNTLET_API __attribute__((visibility("default")))
