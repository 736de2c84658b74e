// A firmware that has nothing but the header of gauntlet export --embedded: steps a glove and
// prints the command of each event; at last, as an error, the clock's ticks for all steps and for
// the longest, and the bytes of the controller and of its settings.
// With START_COUNTS, the motors are there; no channel has a sample for ABSENT_TICKS, and the third
// has none for twice as long. With MIXED_CONVERTERS, channels have converters of their own.
#include <cstdint>
#include <cstdio>

#include ROBOT_HEADER
#include "tests/settings/embedded_glove.h"

#ifdef __arm__
// SysTick of a Cortex-M counts down.
static volatile std::uint32_t* const kSysTick = reinterpret_cast<std::uint32_t*>(0xE000E010);
static void StartClock() {
  kSysTick[1] = 0xFFFFFF;
  kSysTick[2] = 0;
  kSysTick[0] = 5;
}
static std::uint32_t Clock() { return 0xFFFFFF - kSysTick[2]; }
#else
static void StartClock() {}
static std::uint32_t Clock() { return 0; }
#endif

static robot::Controller controller(robot::kSettings);

int main() {
  gauntlet::test::EmbeddedGlove glove;
  float counts[robot::kChannelCount];
  std::int32_t motors[robot::kMotorCount];
  std::uint32_t all = 0;
  std::uint32_t most = 0;
#ifdef START_COUNTS
  const std::int32_t start[] = {START_COUNTS};
  controller.Reset(start);
#endif
  StartClock();
  for (int tick = 0; tick < TICKS; ++tick) {
    const bool fresh = tick % robot::kTicksPerSample == 0;
    if (fresh) glove.Next(counts, robot::kChannelCount);
#ifdef MIXED_CONVERTERS
    if (fresh) gauntlet::test::ToMixedConverters(counts, robot::kChannelCount);
#endif
#ifdef START_COUNTS
    const float missing = __builtin_nanf("");
    for (float& count : counts) count = tick < ABSENT_TICKS ? missing : count;
    if (tick < 2 * ABSENT_TICKS) counts[2] = missing;
#endif
    const std::uint32_t before = Clock();
    const bool event = controller.Step(fresh ? counts : nullptr, motors);
    const std::uint32_t clocks = (Clock() - before) & 0xFFFFFF;
    all += clocks;
    if (clocks > most) most = clocks;
    if (!event) continue;
    std::printf("%d", tick);
    for (const std::int32_t motor : motors) std::printf(" %d", static_cast<int>(motor));
    std::printf("\n");
  }
  std::fprintf(stderr, "%lu %lu %u %u\n", static_cast<unsigned long>(all),
               static_cast<unsigned long>(most), static_cast<unsigned>(sizeof controller),
               static_cast<unsigned>(sizeof robot::kSettings));
}
