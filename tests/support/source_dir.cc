#include "tests/support/source_dir.h"

namespace gauntlet {

std::string SourceDir() { return GAUNTLET_SOURCE_DIR; }

}  // namespace gauntlet
