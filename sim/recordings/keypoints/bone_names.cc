#include "sim/recordings/keypoints/bone_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "controller/number.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 5> kDigits = {"thumb", "index", "middle", "ring", "little"};
constexpr std::array<Meaning, 5> kOrdinals = {{{"thumb", "first"},
                                               {"index", "second"},
                                               {"middle", "third"},
                                               {"ring", "fourth"},
                                               {"little", "fifth"}}};
constexpr std::array<Meaning, 5> kBones = {{{"metacarpal", "metacarpal meta mc cmc"},
                                            {"proximal", "proximal pp mcp"},
                                            {"middle", "middle medial intermediate mp pip"},
                                            {"distal", "distal dp dip ip"},
                                            {"end", "end tip nub"}}};

/// -1 for other words.
int NumberOf(std::string_view word) {
  constexpr int kMost = 100;
  return static_cast<int>(controller::ParseWholeNumber(word, 0, kMost).value_or(-1));
}

int DigitOf(std::string_view word) {
  const std::string_view ordinal = MeaningOf(kOrdinals, word);
  const auto digit = std::ranges::find(kDigits, ordinal.empty() ? FingerOf(word) : ordinal);
  return digit == kDigits.end() ? -1 : static_cast<int>(digit - kDigits.begin());
}

/// Finds the digit, and the number of words up to the end of its name.
int FindDigit(const std::vector<std::string>& words, std::size_t& words_before) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    words_before = i + 1;
    if (const int digit = DigitOf(words[i]); digit >= 0) return digit;
    if (!IsWordOf("digit finger", words[i]) || i + 1 == words.size()) continue;
    words_before = i + 2;
    const int number = NumberOf(words[i + 1]);
    if (number >= 1 && number <= std::ssize(kDigits)) return number - 1;
  }
  return -1;
}

int BoneOfNumber(int digit, int number) {
  constexpr std::array<int, 4> kOfThumb = {0, 1, 3, DigitJoint::kEnd};
  if (number < 1 || number > 4) return DigitJoint::kUnclear;
  return digit == 0 ? kOfThumb[static_cast<std::size_t>(number - 1)] : number;
}

}  // namespace

std::optional<DigitJoint> DigitJointOf(std::string_view name) {
  const std::vector<std::string> words = WordsOf(name);
  DigitJoint joint;
  std::size_t words_before = 0;
  joint.digit = FindDigit(words, words_before);
  if (joint.digit < 0 || HasWordOf(words, "toe toes foot")) return std::nullopt;
  int number = -1, bone = -1;
  bool is_manus = false;  // which has an IP between PIP and DIP
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view side = SideOf(words[i]);
    if (!side.empty() && !joint.hand.empty() && side != joint.hand) return std::nullopt;
    if (!side.empty()) joint.hand = side;
    if (i < words_before || !side.empty()) continue;
    if (const std::string_view called = MeaningOf(kBones, words[i]); !called.empty()) {
      if (bone >= 0) return std::nullopt;
      bone = static_cast<int>(std::ranges::find(kBones, called, &Meaning::means) - kBones.begin());
      is_manus = joint.digit > 0 && words[i] == "ip";
    } else if (NumberOf(words[i]) >= 0) {
      if (number >= 0) return std::nullopt;
      number = NumberOf(words[i]);
    } else if (!IsWordOf("finger hand phalanx joint bone", words[i])) {
      return std::nullopt;  // another thing beside the digit
    }
  }
  const bool is_in_hand = HasWordOf({words.begin(), words.begin() + words_before}, "in");
  if (bone == DigitJoint::kEnd || (bone >= 0 && number < 0)) {
    joint.bone = is_manus ? DigitJoint::kUnclear : bone;
  } else if (bone < 0 && number >= 0 && !is_in_hand) {
    joint.bone = BoneOfNumber(joint.digit, number);
  } else if (bone < 0 && number < 0 && is_in_hand) {
    joint.bone = joint.digit == 0 ? DigitJoint::kUnclear : 0;
  } else {
    return std::nullopt;
  }
  return joint;
}

std::string BoneName(int digit, int bone) {
  return fmt::format("{}_{}", kDigits[static_cast<std::size_t>(digit)],
                     kBones[static_cast<std::size_t>(bone)].means);
}

}  // namespace gauntlet::sim
