#include "sim/tables/name_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <set>

#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<Meaning, 5> kFingers = {
    {{"thumb", "thumb th thm thj"},
     {"index", "index fore forefinger pointer if ff ffj idx"},
     {"middle", "middle mid mf mfj"},
     {"ring", "ring rf rfj"},
     {"little", "little pinky pinkie pink small lf lfj"}}};

constexpr std::array<Meaning, 5> kFingersElsewhere = {
    {{"thumb", "pollice pouce pulgar daumen polegar duim"},
     {"index", "indice ndice zeigefinger wijsvinger"},  // ndice: behind an accent
     {"middle", "medio majeur medius mittelfinger middelvinger"},
     {"ring", "anulare annulaire anular ringfinger ringvinger"},
     {"little", "mignolo auriculaire menique kleiner kleinfinger pinkvinger minimo"}}};

constexpr std::array<Meaning, 5> kJoints = {
    {{"mcp", "mcp mpj knuckle proximal inner near"},
     {"pip", "pip pij intermediate"},
     {"ip", "ip ij"},
     {"dip", "dip dij distal outer far tip"},
     {"rotation", "cmc tmc tmj roll rotation rot opposition"}}};

constexpr std::array<Meaning, 4> kArmParts = {{{"wrist", "wrist wr"},
                                               {"forearm", "forearm pronation"},
                                               {"elbow", "elbow"},
                                               {"shoulder", "shoulder"}}};

constexpr std::array<Meaning, 2> kSides = {{{"left", "left l lh"}, {"right", "right r rh"}}};

std::string Joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, "_"));
}

}  // namespace

std::string_view MeaningOf(std::span<const Meaning> list, std::string_view word) {
  const auto found = std::ranges::find_if(
      list, [word](const Meaning& meaning) { return IsWordOf(meaning.words, word); });
  return found == list.end() ? "" : found->means;
}

std::vector<std::string> WordsOf(std::string_view name) {
  enum class Kind { kNone, kUpper, kLower, kDigit };
  std::vector<std::string> words;
  Kind before = Kind::kNone;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name.substr(i).starts_with("°")) {
      words.emplace_back("deg");
      before = Kind::kLower;
      ++i;
      continue;
    }
    const auto byte = static_cast<unsigned char>(name[i]);
    Kind kind = Kind::kNone;
    if (std::isupper(byte) != 0) kind = Kind::kUpper;
    if (std::islower(byte) != 0) kind = Kind::kLower;
    if (std::isdigit(byte) != 0) kind = Kind::kDigit;
    const bool next_is_lower =
        i + 1 < name.size() && std::islower(static_cast<unsigned char>(name[i + 1])) != 0;
    const bool ends =
        i + 1 == name.size() || std::isalnum(static_cast<unsigned char>(name[i + 1])) == 0;
    // mA, mV, uV, pF, degC and °C are units.
    const bool is_unit =
        ends && kind == Kind::kUpper && before == Kind::kLower &&
        (IsWordOf("m u", words.back()) || (byte == 'F' && IsWordOf("p n", words.back())) ||
         (IsWordOf("C F", name.substr(i, 1)) && words.back() == "deg"));
    const bool begins =
        kind != before && !(before == Kind::kUpper && kind == Kind::kLower) && !is_unit;
    const bool new_word = kind == Kind::kUpper && before == Kind::kUpper && next_is_lower;
    if (kind != Kind::kNone) {
      if (words.empty() || begins || new_word) words.emplace_back();
      words.back().push_back(static_cast<char>(std::tolower(byte)));
    }
    before = kind;
  }
  return words;
}

bool HasWordOf(const std::vector<std::string>& words, std::string_view list) {
  return std::ranges::any_of(words,
                             [list](const std::string& word) { return IsWordOf(list, word); });
}

std::vector<std::string> WithFingers(std::vector<std::string> names) {
  constexpr std::string_view kLetters = "timrlp";  // L or P: little or pinky
  std::array<bool, kLetters.size()> found = {};
  const auto finger_of = [&](const std::string& name) {
    const std::vector<std::string> words = WordsOf(name);
    return words.empty() || words[0].size() != 1 ? kLetters.npos : kLetters.find(words[0]);
  };
  for (const std::string& name : names) {
    if (const std::size_t finger = finger_of(name); finger != kLetters.npos) found[finger] = true;
  }
  const bool has_little = found[kFingers.size() - 1] != found[kFingers.size()];
  if (!has_little ||
      !std::all_of(found.begin(), found.begin() + kFingers.size() - 1, std::identity())) {
    return names;
  }
  for (std::string& name : names) {
    const std::size_t finger = finger_of(name);
    const std::size_t letter = name.find_first_of("TIMRLPtimrlp");
    if (finger == kLetters.npos) continue;
    name.replace(letter, 1, kFingers[std::min(finger, kFingers.size() - 1)].means);
  }
  return names;
}

std::vector<std::string> WithDigits(std::vector<std::string> names) {
  for (std::string& name : names) {
    std::vector<std::string> words = WordsOf(name);
    const auto digit = std::ranges::find(words, "digit");
    if (digit == words.end() || digit + 1 == words.end()) continue;
    const std::string& number = *(digit + 1);
    if (number.size() != 1 || number < "1" || number > "5") continue;
    *digit = kFingers[static_cast<std::size_t>(number.front() - '1')].means;
    words.erase(digit + 1);
    name = Joined(words);
  }
  return names;
}

std::vector<std::string> WithJoints(std::vector<std::string> names) {
  constexpr std::array<Meaning, 3> kAnatomy = {{{"mcp", "metacarpophalangeal"},
                                                {"ip", "interphalangeal"},
                                                {"cmc", "carpometacarpal trapeziometacarpal"}}};
  for (std::string& name : names) {
    std::vector<std::string> words;
    bool is_changed = false;
    for (std::string word : WordsOf(name)) {
      if (word == "phalangeal" && !words.empty() && IsWordOf("inter metacarpo", words.back())) {
        word = words.back() + word;
        words.pop_back();
      }
      std::string_view joint = MeaningOf(kAnatomy, word);
      if (joint == "ip" && !words.empty() && IsWordOf("proximal distal", words.back())) {
        joint = words.back() == "distal" ? "dip" : "pip";
        words.pop_back();
      }
      is_changed = is_changed || !joint.empty();
      words.push_back(joint.empty() ? word : std::string(joint));
    }
    if (is_changed) name = Joined(words);
  }
  return names;
}

std::vector<std::string> InEnglish(const std::vector<std::string>& names) {
  constexpr std::size_t kFewest = 3;
  std::vector<std::string> english = names;
  std::set<std::string_view> fingers;
  for (std::string& name : english) {
    std::vector<std::string> words = WordsOf(name);
    for (std::string& word : words) {
      const std::string_view finger = MeaningOf(kFingersElsewhere, word);
      if (finger.empty()) continue;
      fingers.insert(finger);
      word = finger;
      name = Joined(words);
    }
  }
  return fingers.size() < kFewest ? std::vector<std::string>() : english;
}

std::string_view FingerOf(std::string_view word) { return MeaningOf(kFingers, word); }
std::string_view FingerOfJointName(std::string_view name) {
  for (const std::string& word : WordsOf(name)) {
    if (const std::string_view finger = FingerOf(word); !finger.empty()) return finger;
  }
  return "";
}
std::string_view JointOf(std::string_view word) { return MeaningOf(kJoints, word); }
bool IsSpread(std::string_view word) {
  return IsWordOf("abd abduction adduction abducted spread splay aa", word);
}
bool NamesParts(std::string_view name) {
  return HasWordOf(WordsOf(name),
                   "session sessions trial trials episode episodes take run repetition rep "
                   "recording part segment file subject participant person user");
}
bool IsSensorWord(std::string_view word) {
  return IsWordOf(
      "flex bend bending glove finger fingers hand sensor sensors sens s ch chan channel channels "
      "enc encoder encoders hall pot pots potentiometer "
      "adc a f v val value values raw norm normalized normalised data analog volt volts count "
      "counts deg degree degrees rad radian radians angle angles cyberglove dataglove cal "
      "calibrated filtered abc",
      word);
}
bool IsJointWord(std::string_view word) {
  return IsWordOf("joint joints j q qpos pos position positions g col column share percent smooth",
                  word);
}
std::string_view ArmPartOf(std::string_view word) { return MeaningOf(kArmParts, word); }
std::string_view SideOf(std::string_view word) { return MeaningOf(kSides, word); }

}  // namespace gauntlet::sim
