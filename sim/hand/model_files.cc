#include "sim/hand/model_files.h"

#include <mujoco/mujoco.h>

#include <cstddef>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/base/input_file.h"
#include "sim/hand/mujoco_messages.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// Values of the attributes whose names end in `name`.
std::vector<std::string> ValuesOf(std::string_view name, std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<std::string> values;
  for (std::size_t at = text.find(name); at != std::string_view::npos;) {
    at = text.find_first_not_of(kBlanks, at + name.size());
    if (at == std::string_view::npos) break;
    if (text[at] == '=') at = text.find_first_not_of(kBlanks, at + 1);
    if (at == std::string_view::npos) break;
    if (const char quote = text[at]; quote == '"' || quote == '\'') {
      const std::size_t end = text.find(quote, at + 1);
      if (end == std::string_view::npos) break;
      values.emplace_back(text.substr(at + 1, end - at - 1));
      at = end;
    }
    at = text.find(name, at);
  }
  return values;
}

void RegisterFile(const fs::path& file, const fs::path& folder, std::set<fs::path>& taken) {
  if (!taken.insert(file).second) return;
  std::ifstream stream(InputFile(file), std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  std::vector<std::string> folders = ValuesOf("dir", text);
  folders.emplace_back();
  for (const std::string& name : ValuesOf("file", text)) {
    for (const std::string& below : folders) {
      const fs::path part = folder / below / name;
      std::error_code missing;
      if (!fs::is_regular_file(part, missing)) continue;
      part.extension() == ".xml" ? RegisterFile(part, folder, taken) : void(InputFile(part));
    }
  }
}

}  // namespace

void RegisterModelFiles(const fs::path& model) {
  std::set<fs::path> taken;
  RegisterFile(model, model.parent_path(), taken);
}

mjModel* LoadModel(const fs::path& path, ReadableMjcf& readable) {
  readable = ReadModelText(path);
  // The engine finds the text by the file's name, and its meshes beside the file.
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> files(new mjVFS, [](mjVFS* given) {
    mj_deleteVFS(given);
    delete given;
  });
  mj_defaultVFS(files.get());
  const std::string text = std::exchange(readable.text, {});
  if (mj_makeEmptyFileVFS(files.get(), path.c_str(), static_cast<int>(text.size())) != 0) {
    throw UserError({.place = path.string(), .problem = "has a name that the engine cannot take"});
  }
  std::memcpy(files->filedata[0], text.data(), text.size());
  char message[1000] = "";
  mjModel* model = nullptr;
  try {
    model = mj_loadXML(path.c_str(), files.get(), message, sizeof message);
  } catch (const RunError& error) {
    throw UserError({.place = path.string(), .problem = error.what()});
  }
  TakeMujocoWarning();
  if (model != nullptr) return model;
  std::string line = message;
  for (char& letter : line) letter = letter == '\n' ? ' ' : letter;
  throw UserError({.place = path.string(), .problem = line});
}

void TryModel(const fs::path& path, const std::string& key) {
  constexpr HelperLimits kLimits = {
      .processor_s = 20.0, .memory_bytes = std::size_t{2} << 30, .silence_s = 30};
  try {
    RegisterModelFiles(path);
  } catch (const UserError& error) {
    throw UserError({.key = key, .problem = error.what()});
  }
  if (!DataName(fs::absolute(path).lexically_normal()).empty()) return;
  const fs::path root = InputRoot();
  const auto load = [&path, &root](const HelperProcess::Send&) {
    if (!root.empty()) ReadOnlyBelow({root, DataFolder("models")});
    try {
      ReadableMjcf readable;
      mj_deleteModel(LoadModel(path, readable));
    } catch (const std::bad_alloc&) {
      throw UserError({.place = path.string(), .problem = "takes more than 2 GB of memory"});
    }
  };
  try {
    HelperProcess(load, kLimits).Finish();
  } catch (const HelperError& error) {
    throw UserError(error.what());
  } catch (const HelperSilent& silent) {
    throw RunError(path.string() + ": the process that reads it " + silent.what());
  } catch (const HelperEnded& ended) {
    throw UserError(
        {.place = path.string(),
         .problem = std::string("cannot be loaded: the process that tried it ") + ended.what()});
  }
}

}  // namespace gauntlet::sim
