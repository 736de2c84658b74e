#include "sim/trial/external/own_objects.h"

#include <fmt/format.h>

#include <mutex>
#include <string_view>

#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kPrefix = "python:";

std::mutex objects_mutex;
std::map<std::string, std::shared_ptr<const OwnObject>> known_objects;

}  // namespace

void SetOwnObjects(const OwnObjects& objects) {
  std::map<std::string, std::shared_ptr<const OwnObject>> shared;
  for (const auto& [name, object] : objects) {
    shared[name] = std::make_shared<const OwnObject>(object);
  }
  const std::lock_guard lock(objects_mutex);
  known_objects.swap(shared);
}

bool NamesObject(const controller::ExternalConfig& config) {
  return config.command.starts_with(kPrefix);
}

std::shared_ptr<const OwnObject> FindObject(const controller::ExternalConfig& config) {
  const std::lock_guard lock(objects_mutex);
  const auto known = known_objects.find(config.command.substr(kPrefix.size()));
  if (known != known_objects.end()) return known->second;
  throw controller::SettingError(
      "command", fmt::format("is {}, an object of Python, which no file contains; run it from "
                             "Python with the object as filter",
                             Shown(config.command)));
}

}  // namespace gauntlet::sim
