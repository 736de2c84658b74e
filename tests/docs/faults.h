#pragma once

/// What is wrong here: for tests of `docs/check_text`.
struct Fault {
  /// Of the second kind.
  int second = 0;
};
