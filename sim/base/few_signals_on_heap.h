#pragma once

namespace gauntlet::sim {

/// While one exists, signals leave at most 64 MB on the heap and 96 MB of mapped files in memory,
/// and none longer than 4 MB on the heap: for work that needs the disk anyway, and shall not take
/// more memory the longer it is. Any thread may make one. See SignalStorage.
class FewSignalsOnHeap {
 public:
  FewSignalsOnHeap();
  ~FewSignalsOnHeap();
  FewSignalsOnHeap(const FewSignalsOnHeap&) = delete;
  FewSignalsOnHeap& operator=(const FewSignalsOnHeap&) = delete;
};

/// Gives the system what was freed on the heap and is kept for the next trial, while a
/// FewSignalsOnHeap exists; else nothing. Between trials, and before what is made of all of them.
void ReturnFreedMemory();

}  // namespace gauntlet::sim
