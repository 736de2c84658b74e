#include "sim/study/trial_table/study_database.h"

#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <span>
#include <string_view>

#include "sim/base/hash.h"
#include "sim/study/trial_table/trial_table.h"

namespace gauntlet::sim {
namespace {

std::string ChecksumOf(const TrialKey& key, const TrialOutcome& outcome,
                       const std::vector<std::size_t>& /*metrics*/) {
  Hash hash;
  const auto add_number = [&hash](auto number) {
    hash.Add(std::span<const decltype(number)>(&number, 1));
  };
  const auto add_text = [&](std::string_view text) {
    add_number(text.size());  // so that no text runs into the next
    hash.Add(text);
  };
  const auto add_values = [&](const std::vector<double>& values) {
    for (const double value : values) {
      // A value that is not finite is not kept, and is read as missing.
      add_number(std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN());
    }
  };
  add_text(key.study);
  add_text(key.controller);
  add_text(key.settings);
  add_number(key.seed);
  add_text(outcome.health.problem);
  add_values(outcome.scores.summary);
  for (const std::vector<double>& channel : outcome.scores.channels) add_values(channel);
  for (const std::int64_t samples : outcome.untrusted_samples) add_number(samples);
  return hash.Text();
}

TrialTableOptions OptionsFor(const Study& study, const StudyDatabaseOptions& options) {
  TrialTableOptions table = {.kept_for = "comparison",
                             .metrics = std::vector<std::size_t>(Metrics().size()),
                             .rows = study.rows.names,
                             .channels = study.channel_names(),
                             .checksum = ChecksumOf,
                             .patience = options.patience,
                             .between_writes = {}};
  std::iota(table.metrics.begin(), table.metrics.end(), 0);
  return table;
}

}  // namespace

struct StudyDatabase::State {
  State(std::filesystem::path file, const Study& s, StudyIdentity i, StudyDatabaseOptions options)
      : study(s), identity(std::move(i)), table(std::move(file), OptionsFor(s, options)) {
    table.ReadTogether([&] { Read(options.seeds); });
    table.Add([this](TrialTable& /*table*/) { Start(); });
    table.WriteUnlessLocked();  // a file that cannot be written is found here
  }

  TrialKey KeyOf(int seed, std::size_t controller) const {
    return {.study = identity.hash,
            .controller = study.scenario.controllers[controller].name,
            .settings = identity.controller_settings[controller],
            .seed = seed};
  }

  void Read(int seeds) {
    const int first = study.scenario.seed;
    for (std::size_t c = 0; c < identity.controller_settings.size(); ++c) {
      const TrialKey key = KeyOf(first, c);
      const auto outcomes = table.Read(key, seeds);
      for (int i = 0; i < seeds; ++i) {
        if (outcomes[i]) found[{first + i, c}] = *outcomes[i];
      }
      const auto count = table.Prepare(
          "SELECT count(*) FROM trial WHERE study = ? AND controller = ? AND settings = ? "
          "AND typeof(seed) = 'integer'",
          key.study, key.controller, key.settings);
      count->executeStep();
      known += count->getColumn(0).getInt();
    }
    known -= table.damaged();
  }

  /// Puts the study into its table. Its trials become the newest as they are asked for.
  void Start() {
    table.Run(
        "INSERT INTO study VALUES (?, ?) "
        "ON CONFLICT (hash) DO UPDATE SET scenario = excluded.scenario",
        identity.hash, identity.shared_settings);
    table.database().exec("UPDATE trial SET newest = 0 WHERE newest <> 0");
  }

  const Study& study;
  const StudyIdentity identity;
  TrialTable table;
  std::mutex mutex;
  std::map<std::pair<int, std::size_t>, TrialOutcome> found;  // by seed and controller; not taken
  int known = 0;                                              // when the file was opened
};

StudyDatabase::StudyDatabase(std::filesystem::path file, const Study& study,
                             StudyDatabaseOptions options)
    : StudyDatabase(std::move(file), study, IdentityOf(study), options) {}

StudyDatabase::StudyDatabase(std::filesystem::path file, const Study& study, StudyIdentity identity,
                             StudyDatabaseOptions options)
    : state_(std::make_unique<State>(std::move(file), study, std::move(identity), options)) {}

StudyDatabase::~StudyDatabase() = default;

bool StudyDatabase::Has(int seed, std::size_t controller) {
  const std::lock_guard lock(state_->mutex);
  return state_->found.contains({seed, controller});
}

std::optional<TrialOutcome> StudyDatabase::Take(int seed, std::size_t controller) {
  const std::lock_guard lock(state_->mutex);
  auto trial = state_->found.extract({seed, controller});
  if (trial.empty()) return std::nullopt;
  state_->table.Add([key = state_->KeyOf(seed, controller)](TrialTable& table) {
    table.Run(
        "UPDATE trial SET newest = 1 "
        "WHERE study = ? AND controller = ? AND settings = ? AND seed = ?",
        key.study, key.controller, key.settings, key.seed);
  });
  return std::move(trial.mapped());
}

void StudyDatabase::Keep(int seed, std::size_t controller, const TrialOutcome& outcome) {
  const std::lock_guard lock(state_->mutex);
  state_->table.Keep(state_->KeyOf(seed, controller), outcome);
}

std::optional<std::string> StudyDatabase::Finish() {
  const std::lock_guard lock(state_->mutex);
  return state_->table.Finish();
}

int StudyDatabase::TrialCount() const {
  const std::lock_guard lock(state_->mutex);
  return state_->known + state_->table.added();
}

int StudyDatabase::DamagedCount() const { return state_->table.damaged(); }

}  // namespace gauntlet::sim
