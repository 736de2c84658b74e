#pragma once

#include <pybind11/pybind11.h>

#include "sim/trial/external/own_objects.h"

namespace gauntlet::python {

/// Filters of the caller, from {name: (make, identity)}. make(rate_hz, channels, parameters)
/// returns an object with step(sample) -> values. The objects may be called and destroyed without
/// the GIL: they take it.
sim::OwnObjects OwnObjectsOf(const pybind11::dict& filters);

/// True in a thread that is in such an object.
bool IsInOwnFilter();
/// Raises KeyboardInterrupt in every such object that computes now, each in its thread. Needs the
/// GIL.
void InterruptOwnFilters();

}  // namespace gauntlet::python
