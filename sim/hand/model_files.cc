#include "sim/hand/model_files.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
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
#include "sim/base/limited_text.h"
#include "sim/base/text.h"
#include "sim/hand/mujoco_messages.h"
#include "sim/hand/mujoco_versions.h"

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
  const std::string text = LimitedText(InputFile(file), kMostModelBytes);
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

namespace {

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;

/// True if each edge of a mesh is that of two faces, once in each direction.
bool IsClosed(const mjModel& model, int mesh) {
  std::set<std::pair<int, int>> edges;
  const int* const faces = model.mesh_face + 3 * model.mesh_faceadr[mesh];
  const int corners = 3 * model.mesh_facenum[mesh];
  for (int corner = 0; corner < corners; ++corner) {
    const int next = corner % 3 == 2 ? corner - 2 : corner + 1;
    if (!edges.emplace(faces[corner], faces[next]).second) return false;
  }
  return std::ranges::all_of(edges, [&](const auto& edge) {
    return edges.contains({edge.second, edge.first});
  });
}

/// Volumes of the pyramids from the mesh's origin to its faces, with and without their signs.
std::pair<double, double> VolumesOf(const mjModel& model, int mesh) {
  const float* const corners = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  const int* face = model.mesh_face + 3 * model.mesh_faceadr[mesh];
  std::pair<double, double> volume;
  for (int index = 0; index < model.mesh_facenum[mesh]; ++index, face += 3) {
    mjtNum corner[3][3], normal[3];
    for (int k = 0; k < 3; ++k) mju_f2n(corner[k], corners + 3 * face[k], 3);
    mju_cross(normal, corner[1], corner[2]);
    const double pyramid = mju_dot3(corner[0], normal) / 6.0;
    volume.first += pyramid;
    volume.second += std::abs(pyramid);
  }
  return volume;
}

/// A note for each body whose mass the engine computes too large: it counts the volume of a mesh
/// that is not convex more than once, unless the file has kExactMeshes.
void NoteMeshMasses(const fs::path& path, const mjModel& model,
                    const std::function<Model()>& compile_exactly,
                    std::vector<std::string>& notes) {
  constexpr double kSmallShare = 0.01;
  bool counts_twice = false;
  for (int mesh = 0; mesh < model.nmesh; ++mesh) {
    const auto [exact, counted] = VolumesOf(model, mesh);
    counts_twice |= counted > (1.0 + kSmallShare) * std::abs(exact) && IsClosed(model, mesh);
  }
  if (!counts_twice) return;
  const Model exact = compile_exactly();
  if (exact == nullptr) return;
  for (int body = 1; body < model.nbody; ++body) {
    const double right_kg = exact->body_mass[body];
    if (!(std::abs(model.body_mass[body] - right_kg) > kSmallShare * right_kg)) continue;
    const char* const name = mj_id2name(&model, mjOBJ_BODY, body);
    notes.push_back(fmt::format(
        "{}: body {} has {:.1f} g: MuJoCo {} counts some volume of a mesh that is not convex "
        "more than once; with {} it has {:.1f} g",
        path.string(), name == nullptr ? fmt::format("{}", body) : "'" + Shown(name) + "'",
        1e3 * model.body_mass[body], mj_versionString(), kExactMeshes, 1e3 * right_kg));
  }
}

/// Null, and a message, if the text is no model. Errors: UserError.
Model Compile(const fs::path& path, const std::string& text, std::string& message) {
  // The engine finds the text by the file's name, and its meshes beside the file.
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> files(new mjVFS, [](mjVFS* given) {
    mj_deleteVFS(given);
    delete given;
  });
  mj_defaultVFS(files.get());
  if (!AddText(*files, path, text)) {
    throw UserError({.place = path.string(), .problem = "has a name that the engine cannot take"});
  }
  char problem[1000] = "";
  Model model(nullptr, &mj_deleteModel);
  try {
    model.reset(mj_loadXML(path.c_str(), files.get(), problem, sizeof problem));
  } catch (const RunError& error) {
    throw UserError({.place = path.string(), .problem = error.what()});
  }
  TakeMujocoWarning();
  message = problem;
  std::ranges::replace(message, '\n', ' ');
  return model;
}

}  // namespace

mjModel* LoadModel(const fs::path& path, ReadableMjcf& readable) {
  readable = ReadModelText(path);
  std::string message;
  Model model = Compile(path, MjcfText(readable.root), message);
  readable.root = {};
  if (model == nullptr) throw UserError({.place = path.string(), .problem = message});
  const auto compile_exactly = [&] {
    return Compile(path, MjcfText(ReadModelText(path, true).root), message);
  };
  NoteMeshMasses(path, *model, compile_exactly, readable.notes);
  return model.release();
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
