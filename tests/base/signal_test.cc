#include "sim/base/signal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/few_signals_on_heap.h"
#include "tests/support/program.h"
#include "tests/support/signal_limits.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

Signal Numbers(Eigen::Index rows, Eigen::Index cols) {
  Signal signal(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) signal(r, c) = static_cast<double>(1000 * c + r) + 0.5;
  }
  return signal;
}

/// What a computation gives with all signals on the heap and with all on the disk.
template <class Compute>
void ExpectTheSameOnDisk(const Compute& compute) {
  const Eigen::MatrixXd on_heap = compute();
  const test::SignalLimits all_on_disk(test::AllOnDisk());
  const Signal on_disk = compute();
  EXPECT_TRUE(on_disk.is_on_disk());
  EXPECT_EQ(on_heap, on_disk);
}

TEST(Signal, OnTheDiskDoesAllThatItDoesOnTheHeap) {
  ExpectTheSameOnDisk([] { return Numbers(300, 4); });
  ExpectTheSameOnDisk([] {  // a copy of its own
    Signal signal = Numbers(300, 4);
    const Signal copy = signal;
    signal.setZero();
    return copy;
  });
  ExpectTheSameOnDisk([] {
    Signal signal = Numbers(300, 4);
    Signal moved = std::move(signal);
    signal = Numbers(2, 2);
    Signal other(1, 1);
    other = std::move(moved);
    return other;
  });
  ExpectTheSameOnDisk([] { return Signal(Numbers(300, 4).topRows(100).array() * 2.0 - 1.0); });
  ExpectTheSameOnDisk([] {  // made from itself
    Signal signal = Numbers(300, 4);
    signal = signal(Eigen::all, std::vector<int>{3, 1});
    return signal;
  });
  ExpectTheSameOnDisk([] {
    Signal signal = Numbers(300, 4);
    signal.setZero(100, 3);
    signal.col(1) += Numbers(100, 1);
    return signal;
  });
  ExpectTheSameOnDisk([] {
    Signal signal = Numbers(300, 4);
    signal.KeepRows(400);
    signal.KeepRows(17);
    return signal;
  });
  ExpectTheSameOnDisk([] { return EveryRow(Numbers(300, 4), 7); });
  ExpectTheSameOnDisk([] {
    const Signal signal = Numbers(300, 4);
    const Columns part(signal, {2, 0, 3});
    EXPECT_EQ(part->cols(), 3);
    const Columns whole(signal, {0, 1, 2, 3});
    EXPECT_EQ(&*whole, &signal);
    return *part;
  });
}

TEST(Signal, NothingIsASignal) {
  const test::SignalLimits all_on_disk(test::AllOnDisk());
  Signal nothing;
  EXPECT_EQ(nothing.size(), 0);
  nothing = Signal(0, 3);
  const Signal copy = nothing;
  EXPECT_EQ(copy.cols(), 3);
  EXPECT_EQ(EveryRow(copy, 2).rows(), 0);
}

TEST(Signal, ShortOnesLieOnTheHeapUntilTheyAreTooMany) {
  EXPECT_FALSE(Signal(12'000, 18).is_on_disk());
  EXPECT_TRUE(Signal(3'600'000, 18).is_on_disk());
  std::vector<Signal> many;
  while (many.empty() || !many.back().is_on_disk()) many.emplace_back(12'000, 18);
  const std::size_t bytes = many.size() * 12'000 * 18 * sizeof(double);
  EXPECT_NEAR(bytes, GetSignalStorageLimits().all_on_heap_bytes, 2e6);
  EXPECT_FALSE(Signal(1000, 18).is_on_disk());
  many.front() = {};
  EXPECT_FALSE(Signal(12'000, 18).is_on_disk());
}

TEST(Signal, IsOnTheDiskWhereFewAreWantedOnTheHeap) {
  const auto of_mb = [](Eigen::Index mb) { return Signal(mb << 17, 1); };
  EXPECT_FALSE(of_mb(5).is_on_disk());
  {
    const FewSignalsOnHeap few;
    EXPECT_TRUE(of_mb(5).is_on_disk());
    std::vector<Signal> many;
    for (int i = 0; i < 16; ++i) many.push_back(of_mb(4));
    for (const Signal& signal : many) EXPECT_FALSE(signal.is_on_disk());
    EXPECT_TRUE(of_mb(4).is_on_disk());  // beyond 64 MB
    EXPECT_FALSE(Signal(100, 18).is_on_disk());
  }
  EXPECT_FALSE(of_mb(5).is_on_disk());
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // their heap is another one
TEST(Signal, GivesFreedMemoryBackWhereFewAreWanted) {
  const auto resident_mb = [] {
    long pages = 0, resident_pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident_pages;
    return (resident_pages * sysconf(_SC_PAGESIZE)) >> 20;
  };
  std::vector<std::string> blocks;
  for (int i = 0; i < 1024; ++i) blocks.emplace_back(std::size_t{64} << 10, 'x');
  const long full_mb = resident_mb();
  blocks.erase(blocks.begin(), blocks.end() - 1);  // which is behind all others
  ReturnFreedMemory();
  EXPECT_GT(resident_mb(), full_mb - 16);
  const FewSignalsOnHeap few;
  ReturnFreedMemory();
  EXPECT_LT(resident_mb(), full_mb - 48);
}
#endif

TEST(Signal, LeavesNoNameInItsFolder) {
  const test::TemporaryDirectory folder;
  const test::SignalLimits all_on_disk(test::AllOnDisk());
  SetSignalFolder(folder.path() / "not_there" / "yet");
  EXPECT_EQ(FreeSignalSpace().folder, folder.path());
  const Signal signal = Numbers(1000, 3);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  SetSignalFolder(std::filesystem::temp_directory_path());
}

TEST(Signal, KeepsItsValuesWhileItLeavesTheMemory) {
  SignalStorageLimits limits = test::AllOnDisk();
  limits.resident_bytes = std::size_t{48} << 20;
  const test::SignalLimits set(limits);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  Signal signal(1'000'000, 32);  // 256 MB
  for (int c = 0; c < 32; ++c) {
    signal.col(c).setLinSpaced(c, c + 1.0);
    TrimSignals();
  }
  const Signal copy = signal;
  getrusage(RUSAGE_SELF, &after);
#ifdef __SANITIZE_ADDRESS__
  constexpr long kShadow_kib = 64 << 10;  // an eighth of both signals; some kernels count it
#else
  constexpr long kShadow_kib = 0;
#endif
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, (96 << 10) + kShadow_kib);
  for (int c = 0; c < 32; ++c) {
    EXPECT_EQ(copy(0, c), c);
    EXPECT_EQ(copy(999'999, c), c + 1.0);
    EXPECT_EQ(copy.col(c), signal.col(c)) << c;
    TrimSignals();
  }
}

TEST(Signal, AFullDiskIsOneLine) {
  SignalStorageLimits limits = test::AllOnDisk();
  limits.all_on_disk_bytes = 20'000;
  const test::SignalLimits set(limits);
  const Signal fits(1000, 2);
  try {
    const Signal too_much(1000, 3);
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot keep a signal of 0.0 MB there, 0.0 MB are free"));
    EXPECT_THAT(error.what(), HasSubstr("No space left on device"));
  }
}

/// The order of a product's sums depends on them, and with it the last bits.
TEST(Signal, ProductsAreNotThoseOfTheProcessorsCaches) {
  EXPECT_EQ(Eigen::l1CacheSize(), 32 << 10);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 << 10);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 << 20);
}

}  // namespace
}  // namespace gauntlet::sim
