#include "tests/support/read_file.h"

#include <fstream>
#include <sstream>

namespace gauntlet::test {

std::string ReadFile(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace gauntlet::test
