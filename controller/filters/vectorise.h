#pragma once

/// Marks a free function whose loops run over channels: compiled once for any x86-64 and once for
/// processors with AVX2, chosen when the program is loaded. Both give the same bits, because
/// floating-point contraction is off in the whole project.
///
/// AVX2 only: AVX-512 is slower at 18 channels. Sanitizers cannot run the resolvers, which come
/// before them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GAUNTLET_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define GAUNTLET_VECTORISED
#endif

// Under these sanitizers clang cannot vectorise, and warns of every loop that it is asked to.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(undefined_behavior_sanitizer)
#define GAUNTLET_CLANG_SANITIZER
#endif
#endif

/// Before a loop over channels: the arrays are either the same memory or apart from each other.
#if defined(__GNUC__) && !defined(__clang__)
#define GAUNTLET_CHANNEL_LOOP _Pragma("GCC ivdep")
#elif defined(__clang__) && !defined(GAUNTLET_CLANG_SANITIZER)
#define GAUNTLET_CHANNEL_LOOP _Pragma("clang loop vectorize(assume_safety)")
#else
#define GAUNTLET_CHANNEL_LOOP
#endif
