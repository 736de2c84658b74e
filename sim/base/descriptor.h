#pragma once

#include <unistd.h>

#include <utility>

namespace gauntlet::sim {

/// A descriptor of this process (file, folder, pipe, socket); below 0: none. Closes it.
class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }
  void Set(int descriptor) {
    Close();
    descriptor_ = descriptor;
  }
  int Release() { return std::exchange(descriptor_, -1); }
  void Close() {
    if (is_open()) close(Release());
  }

 private:
  int descriptor_;
};

}  // namespace gauntlet::sim
