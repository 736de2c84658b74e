// gauntlet sweep --slurm against a real Slurm: its daemons run on loopback, in a temporary folder.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const std::string kDebianPath = "/usr/sbin:/usr/bin:/sbin:/bin";

bool Has(const std::string& part, const std::string& text) {
  return text.find(part) != std::string::npos;
}

/// A port of loopback that nothing listens at.
int FreePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(socket, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  close(socket);
  return ntohs(address.sin_port);
}

bool WaitUntil(const std::function<bool()>& is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

/// The processes that have all of these words in their command lines.
std::vector<pid_t> ProcessesWith(const std::vector<std::string>& words) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string command = ReadFile(entry.path() / "cmdline");
    if (std::ranges::all_of(words, [&command](const std::string& word) {
          return command.find(word) != std::string::npos;
        })) {
      found.push_back(std::stoi(name));
    }
  }
  return found;
}

/// munged, slurmctld and slurmd with one node of two processors.
class Cluster {
 public:
  static bool IsInstalled() {
    return std::ranges::all_of(std::vector{"/usr/sbin/munged", "/usr/sbin/slurmctld",
                                           "/usr/sbin/slurmd", "/usr/bin/sbatch"},
                               [](const char* program) { return access(program, X_OK) == 0; });
  }

  Cluster() {
    for (const char* folder : {"munge", "state", "spool"}) fs::create_directory(At(folder));
    fs::permissions(At("munge"), fs::perms::owner_all);
    std::ofstream(At("munge/key")) << std::string(128, 'k');
    fs::permissions(At("munge/key"), fs::perms::owner_read | fs::perms::owner_write);
    char host[256] = {};
    gethostname(host, sizeof host - 1);
    std::ofstream(At("slurm.conf"))
        << "ClusterName=test\nSlurmctldHost=" << host
        << "(127.0.0.1)\nSlurmUser=" << getpwuid(geteuid())->pw_name
        << "\nSlurmdUser=" << getpwuid(geteuid())->pw_name << "\nSlurmctldPort=" << FreePort()
        << "\nSlurmdPort=" << FreePort()
        << "\nAuthType=auth/munge\nCryptoType=crypto/munge\nAuthInfo=socket=" << At("munge/socket")
        << ",cred_expire=5\nStateSaveLocation=" << At("state") << "\nSlurmdSpoolDir=" << At("spool")
        << "\nSlurmctldPidFile=" << At("slurmctld.pid") << "\nSlurmdPidFile=" << At("slurmd.pid")
        << "\nSlurmctldLogFile=" << At("slurmctld.log") << "\nSlurmdLogFile=" << At("slurmd.log")
        << "\nSlurmctldDebug=error\nSlurmdDebug=error\nProctrackType=proctrack/linuxproc\n"
           "TaskPlugin=task/none\nMpiDefault=none\nSelectType=select/cons_tres\n"
           "SelectTypeParameters=CR_CPU\nSlurmdParameters=config_overrides\nReturnToService=2\n"
           "KillWait=1\nSchedulerParameters=sched_min_interval=0,batch_sched_delay=0\n"
           "NodeName=node NodeHostname="
        << host
        << " NodeAddr=127.0.0.1 CPUs=2\n"
           "PartitionName=all Nodes=node Default=YES MaxTime=INFINITE State=UP\n";
    Start({"munged", "-F", "--force", "--num-threads", "1", "--key-file", At("munge/key"),
           "--socket", At("munge/socket"), "--pid-file", At("munge/pid"), "--log-file",
           At("munge/log"), "--seed-file", At("munge/seed")});
    WaitUntil([this] { return fs::exists(At("munge/socket")); });
    Start({"slurmctld", "-D"});
    Start({"slurmd", "-D", "-N", "node"});
    is_up_ = WaitUntil([this] { return Has("idle", Ask({"sinfo", "-h", "-o", "%T"})); });
  }
  ~Cluster() {
    Ask({"scancel", "--state=PENDING", "--user", getpwuid(geteuid())->pw_name});
    Ask({"scancel", "--user", getpwuid(geteuid())->pw_name});
    WaitUntil([this] { return Queue().empty(); });
    while (!daemons_.empty()) daemons_.pop_back();  // munged last
  }

  bool is_up() const { return is_up_; }
  std::map<std::string, std::string> environment() const {
    return {{"SLURM_CONF", At("slurm.conf")}, {"PATH", kDebianPath}};
  }
  std::string Ask(const std::vector<std::string>& command) const {
    return RunProgram(command, {.environment = environment()}).standard_output;
  }
  /// Not empty, either, while the controller does not answer.
  std::string Queue() const {
    const ProgramResult squeue =
        RunProgram({"squeue", "-h", "-r", "-o", "%A_%a %T"}, {.environment = environment()});
    return squeue.exit_code == 0 ? squeue.standard_output : "no answer: " + squeue.standard_error;
  }
  /// Tasks that run again wait until what they were given before is void; these do not.
  void HurryTheQueue() const {
    std::istringstream tasks(Ask({"squeue", "-h", "-r", "-t", "PENDING", "-o", "%i"}));
    for (std::string task; tasks >> task;) {
      Ask({"scontrol", "update", "JobId=" + task, "StartTime=now"});
    }
  }

 private:
  std::string At(const std::string& name) const { return (folder_.path() / name).string(); }
  void Start(const std::vector<std::string>& command) {
    daemons_.push_back(std::make_unique<Program>(
        command, ProgramOptions{.environment = environment(), .timeout = std::chrono::minutes(5)}));
  }

  TemporaryDirectory folder_;
  std::vector<std::unique_ptr<Program>> daemons_;
  bool is_up_ = false;
};

class SlurmTest : public testing::Test {
 protected:
  SlurmTest() {
    std::ofstream(folder_.path() / "short.yaml")
        << "question: Which filter?\n"
           "scenario: " +
               SourceDir() +
               "/scenarios/hold_still.yaml\n"
               "set: [glove.motion.duration_s=1, score.noise_free_twin=false]\n"
               "controllers: [tuned_kalman]\n"
               "seeds: 4\n"
               "axes:\n"
               "  - {key: controllers.tuned_kalman.filter.q, low: 1e-4, high: 1, count: 9, "
               "spacing: log}\n";
  }
  ProgramResult Sweep(const std::vector<std::string>& more,
                      const std::map<std::string, std::string>& environment = {}) const {
    std::vector<std::string> command = {GAUNTLET_PROGRAM, "sweep", "short.yaml"};
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command, {.environment = environment, .working_directory = folder_.path()});
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }

  TemporaryDirectory folder_;
};

TEST_F(SlurmTest, LosesNothingWhenATaskIsKilledAndItsNodeGoesDown) {
  if (!Cluster::IsInstalled()) GTEST_SKIP() << "slurm-wlm and munge are not installed";
  const Cluster cluster;
  ASSERT_TRUE(cluster.is_up());
  ASSERT_EQ(Sweep({"--out", "whole"}).exit_code, 0);
  const ProgramResult submitted = Sweep({"--slurm", "--tasks", "3"}, cluster.environment());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.standard_error;
  EXPECT_THAT(submitted.standard_error, HasSubstr("3 of 3 shards"));

  // One task is killed, and while it waits to run again the node goes down under the others.
  const std::vector<std::string> second = {"--shard", In("out/short/slurm/shard-2-of-3").string()};
  ASSERT_TRUE(WaitUntil([&] { return fs::exists(In("out/short/slurm/shard-2-of-3/study.db")); }));
  for (const pid_t process : ProcessesWith(second)) kill(process, SIGKILL);
  ASSERT_TRUE(WaitUntil([&] { return Has("PENDING", cluster.Queue()); }));
  const ProgramResult again = Sweep({"--slurm", "--tasks", "3"}, cluster.environment());
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.standard_error, HasSubstr("in Slurm's queue already"));
  cluster.Ask({"scontrol", "update", "NodeName=node", "State=DOWN", "Reason=test"});
  // A node that comes back while its old tasks still end refuses the new ones.
  ASSERT_TRUE(WaitUntil(
      [&] { return !Has("RUNNING", cluster.Queue()) && ProcessesWith({"slurmstepd:"}).empty(); }));
  cluster.Ask({"scontrol", "update", "NodeName=node", "State=RESUME"});
  ASSERT_TRUE(WaitUntil([&] {
    cluster.HurryTheQueue();
    return cluster.Queue().empty();
  })) << cluster.Queue();

  // A shard that is lost altogether. Slurm does not always queue a task again whose node went down
  // under it; --retry runs what is missing, whatever the reason, and nothing else.
  fs::remove_all(In("out/short/slurm/shard-3-of-3"));
  std::vector<std::string> said;
  do {
    ASSERT_LT(said.size(), 4u) << testing::PrintToString(said);
    const ProgramResult retry =
        Sweep({"--slurm", "--tasks", "3", "--retry"}, cluster.environment());
    said.push_back(retry.standard_error);
    ASSERT_TRUE(WaitUntil([&] { return cluster.Queue().empty(); }));
  } while (!Has("nothing is missing; now: gauntlet sweep", said.back()));
  EXPECT_GT(said.size(), 1u);
  EXPECT_THAT(said.front(), HasSubstr(" of 3 shards"));

  const ProgramResult merged = Sweep(
      {"--out", "merged", "--collect", In("out/short/slurm/shard-1-of-3").string(),
       In("out/short/slurm/shard-2-of-3").string(), In("out/short/slurm/shard-3-of-3").string()});
  ASSERT_EQ(merged.exit_code, 0) << merged.standard_error;
  EXPECT_THAT(merged.standard_error, Not(HasSubstr("to run")));
  EXPECT_EQ(ReadFile(In("merged/cells.csv")), ReadFile(In("whole/cells.csv")));
  EXPECT_EQ(ReadFile(In("merged/report.html")), ReadFile(In("whole/report.html")));
  SQLite::Database database(In("merged/study.db").string());
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM trial").getInt(), 9 * 4);

  fs::remove_all(In("out/short/slurm/shard-3-of-3"));
  const ProgramResult script = Sweep({"--slurm", "--tasks", "3", "--retry", "--dry-run"});
  EXPECT_THAT(script.standard_output, HasSubstr("#SBATCH --array=3\n"));
}

TEST_F(SlurmTest, ADryRunPrintsTheScriptAndLeavesNothing) {
  const ProgramResult result =
      Sweep({"--slurm", "--dry-run", "--tasks", "4", "--seeds", "2", "--set", "glove.rate_hz=500",
             "--sbatch=--partition=night", "--out", "it's 100 %"},
            {{"PATH", "/nowhere"}});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  for (const char* part :
       {"#SBATCH --array=1,2,3,4\n", "#SBATCH --requeue\n", "#SBATCH --partition=night\n",
        "/it's 100 %%/slurm/shard-%a-of-4.log\"", "/it'\\''s 100 %/slurm'/shard-$shard-of-4\n",
        "--seeds 2 ", "--set 'glove.rate_hz=500' ", "--shard \"$shard/4\""}) {
    EXPECT_THAT(result.standard_output, HasSubstr(part));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
  std::ofstream(In("script")) << result.standard_output;
  EXPECT_EQ(RunProgram({"bash", "-n", In("script").string()}).exit_code, 0);
}

TEST_F(SlurmTest, MistakesAreOneLineBeforeAnythingRuns) {
  const auto mistake = [this](const std::vector<std::string>& more, const std::string& problem) {
    const ProgramResult result = Sweep(more, {{"PATH", "/nowhere"}});
    EXPECT_EQ(result.exit_code, 2) << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr(problem));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
    EXPECT_FALSE(fs::exists(In("out")));
  };
  mistake({"--slurm"}, "--slurm: there is no sbatch on PATH");
  mistake({"--slurm", "--shard", "1/2"}, "--slurm: and --shard contradict each other");
  mistake({"--retry"}, "--retry: is of --slurm");
  mistake({"--slurm", "--sbatch=x"}, "must be an option of sbatch");
  mistake({"--slurm", "--set", "glove.nois=1"}, "");
}

TEST_F(SlurmTest, AFolderThatWouldMakeLinesOfTheScriptIsRefusedBeforeAnythingIsWritten) {
  const std::string lines = "x\ntouch made\n#";
  fs::create_directory(In(lines));
  fs::copy(In("short.yaml"), In(lines) / "short.yaml");
  const auto refused = [](const fs::path& folder, const std::string& out, bool dry) {
    std::vector<std::string> command = {GAUNTLET_PROGRAM, "sweep", "short.yaml", "--slurm",
                                        "--tasks",        "2",     "--out",      out};
    if (dry) command.emplace_back("--dry-run");
    const ProgramResult result =
        RunProgram(command, {.environment = {{"PATH", kDebianPath}}, .working_directory = folder});
    EXPECT_EQ(result.exit_code, 2) << result.standard_error;
    EXPECT_EQ(result.standard_output, "");
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
  };
  for (const bool dry : {true, false}) {
    if (!dry && !Cluster::IsInstalled()) continue;  // without sbatch another line is first
    for (const char* out : {"x\ntouch made\n#", "a\rb", "a\\b", "a\xff", "a\tb"}) {
      refused(folder_.path(), out, dry);
    }
    refused(In(lines), "out", dry);
    refused(In(lines), In("elsewhere").string(), dry);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(In(lines)), {}), 1);
}

}  // namespace
}  // namespace gauntlet::test
