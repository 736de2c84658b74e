#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "controller/filters/external_filter.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::sim {

/// A filter as an object of the process that uses this library, as of Python.
struct OwnObject {
  std::string identity;  // of its code: equal where it answers alike
  /// A new one, at the first sample of a filter, in any thread. Errors: as Stepper::Step().
  std::function<std::unique_ptr<Stepper>(const FilterFacts&)> make;
};
using OwnObjects = std::map<std::string, OwnObject>;

/// The objects that `command: python:NAME` can name from now on. No file can add one.
void SetOwnObjects(const OwnObjects& objects);

/// True if the command names an object, be it there or not.
bool NamesObject(const controller::ExternalConfig& config);
/// The object of such a command. Errors: SettingError `command` if it is not there.
std::shared_ptr<const OwnObject> FindObject(const controller::ExternalConfig& config);

}  // namespace gauntlet::sim
