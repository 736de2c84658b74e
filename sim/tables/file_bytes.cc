#include "sim/tables/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {

FileBytes FileBytes::Of(const std::filesystem::path& file) {
  constexpr std::uint64_t kSmall = std::uint64_t{1} << 20;
  FileBytes bytes{std::string()};
  bytes.file_ = std::make_unique<Descriptor>(open(InputFile(file).c_str(), O_RDONLY | O_CLOEXEC));
  struct stat facts = {};
  if (!bytes.file_->is_open() || fstat(bytes.file_->get(), &facts) != 0) {
    throw UserError({.place = file.string(),
                     .problem = fmt::format("cannot be read: {}", std::strerror(errno))});
  }
  bytes.size_ = static_cast<std::uint64_t>(facts.st_size);
  if (bytes.size_ > kSmall) return bytes;
  std::string whole;
  bytes.At(0, static_cast<std::size_t>(bytes.size_), whole);
  return FileBytes(std::move(whole));
}

std::string_view FileBytes::At(std::uint64_t place, std::size_t size, std::string& room) const {
  if (place > size_ || size > size_ - place) FailAsDamaged("it ends too early");
  if (file_ == nullptr) return std::string_view(bytes_).substr(place, size);
  room.resize(size);
  for (std::size_t read = 0; read < size;) {
    const ssize_t got =
        pread(file_->get(), room.data() + read, size - read, static_cast<off_t>(place + read));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) FailAsDamaged("it ends too early");
    read += static_cast<std::size_t>(got);
  }
  return room;
}

}  // namespace gauntlet::sim
