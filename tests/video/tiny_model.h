#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace gauntlet::sim {

/// A model written in the test itself, and a state of it.
class TinyModel {
 public:
  explicit TinyModel(const std::string& xml) {
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "tiny.xml", static_cast<int>(xml.size()));
    xml.copy(static_cast<char*>(files.filedata[0]), xml.size());
    char problem[1000] = "";
    model_.reset(mj_loadXML("tiny.xml", &files, problem, sizeof(problem)));
    mj_deleteVFS(&files);
    if (model_ == nullptr) throw std::runtime_error(problem);
    data_.reset(mj_makeData(model_.get()));
  }

  const mjModel& model() const { return *model_; }
  mjData& data() const { return *data_; }

 private:
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, &mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, &mj_deleteData};
};

}  // namespace gauntlet::sim
