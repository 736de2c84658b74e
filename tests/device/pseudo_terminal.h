#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// A serial line without hardware: what is written to one end is read at the other. `link` is a
/// name for the far end that stays while terminals come and go, as those below /dev/serial/by-id.
class PseudoTerminal {
 public:
  explicit PseudoTerminal(std::filesystem::path link);
  ~PseudoTerminal() { Unplug(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  void Plug();
  void Unplug();
  void Write(std::string_view bytes) const;
  /// Bytes that arrived within the time; returns early with `least` bytes.
  std::string Read(int timeout_ms, std::size_t least = 1) const;
  const std::filesystem::path& link() const { return link_; }

 private:
  std::filesystem::path link_;
  int near_ = -1;
};

}  // namespace gauntlet::sim
