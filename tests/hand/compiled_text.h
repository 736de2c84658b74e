#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim::testing {

using CompiledText = std::unique_ptr<mjModel, void (*)(mjModel*)>;

/// The model of an MJCF text; null if it is none.
inline CompiledText Compiled(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  AddText(*files, "model.xml", text);
  char message[500] = "";
  mjModel* const model = mj_loadXML("model.xml", files.get(), message, sizeof message);
  mj_deleteVFS(files.get());
  return {model, &mj_deleteModel};
}

}  // namespace gauntlet::sim::testing
