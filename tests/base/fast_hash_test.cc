#include "sim/base/fast_hash.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

std::string FastHashOf(std::string_view text) {
  FastHash hash;
  hash.Add(text);
  return hash.Text();
}

/// The bytes 0 .. size - 1, each its own number.
std::string Numbered(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i);
  return bytes;
}

// The second to fourth are those that the library's own programs and bindings document; all are
// what XXH64() of libxxhash 0.8.1 gives.
TEST(FastHash, GivesTheValuesOfXxHash) {
  EXPECT_EQ(FastHashOf(""), "ef46db3751d8e999");
  EXPECT_EQ(FastHashOf("a"), "d24ec4f1a98c6e5b");
  EXPECT_EQ(FastHashOf("abc"), "44bc2cf5ad770999");
  EXPECT_EQ(FastHashOf("Nobody inspects the spammish repetition"), "fbcea83c8a378bf1");
  EXPECT_EQ(FastHashOf("xyzwxyzwxyzwxyzwxyzwxyzwxyzwxyzw"), "a0b93074aef86dd1");
  EXPECT_EQ(FastHashOf(Numbered(101)), "e99038495f85381e");
}

TEST(FastHash, IsThatOfAllPiecesTogether) {
  const std::string bytes = Numbered(200);
  const std::string whole = FastHashOf(bytes);
  for (std::size_t first = 0; first <= bytes.size(); ++first) {
    for (const std::size_t step : {1, 7, 31, 32, 33, 90}) {
      FastHash hash;
      hash.Add(std::string_view(bytes).substr(0, first));
      for (std::size_t i = first; i < bytes.size(); i += step) {
        hash.Add(std::string_view(bytes).substr(i, step));
      }
      ASSERT_EQ(hash.Text(), whole) << first << " " << step;
    }
  }
}

TEST(FastHash, OfAFileIsThatOfItsBytes) {
  const test::TemporaryDirectory folder;
  const std::string bytes = Numbered(1'000'003);
  std::ofstream(folder.path() / "file") << bytes;
  EXPECT_EQ(FastHashOfFile(folder.path() / "file"), FastHashOf(bytes));
}

}  // namespace
}  // namespace gauntlet::sim
