// The start script, with a project of two files in place of Gauntlet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string Text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void Write(const fs::path& file, std::string_view text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

void WriteTool(const fs::path& file, std::string_view text) {
  Write(file, text);
  fs::permissions(file, fs::perms{0755});
}

/// Neither ended nor about to.
bool Works(pid_t process) {
  const std::string state = Text("/proc/" + std::to_string(process) + "/stat");
  return !state.empty() && state.find(") Z ") == std::string::npos;
}

class StartScript : public testing::Test {
 protected:
  StartScript() {
    std::string script = Text(fs::path(SourceDir()) / "gauntlet");
    Replace(script, "export PATH=", "export PATH=" + tools_.string() + ":");
    Replace(script, "/etc/os-release", os_release_.string());
    WriteTool(root_ / "gauntlet", script);
    Write(root_ / "CMakeLists.txt", R"(
cmake_minimum_required(VERSION 3.20)
project(Toy NONE)
set(KIND "none" CACHE STRING "")
file(WRITE ${CMAKE_BINARY_DIR}/program.in "#!/bin/sh\necho ${KIND} $@\n")
foreach(program gauntlet gauntlet_studies)
  set(place sim/cli/${program})
  add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/${place}
    COMMAND ${CMAKE_SOURCE_DIR}/compile && mkdir -p sim/cli && cp program.in ${place}
            && chmod +x ${place}
    DEPENDS ${CMAKE_SOURCE_DIR}/source ${CMAKE_BINARY_DIR}/program.in)
  add_custom_target(${program} ALL DEPENDS ${CMAKE_BINARY_DIR}/${place})
endforeach()
)");
    Write(root_ / "CMakePresets.json", R"({"version": 3, "configurePresets": [{"name": "release",
      "generator": "Ninja", "binaryDir": "${sourceDir}/build/release",
      "cacheVariables": {"KIND": "toy"}}]})");
    Write(root_ / "source", "");
    WriteTool(root_ / "compile", "#!/bin/sh\n");
    WritePackageTools();
    Installed(Packages());
  }

  using Versions = std::map<std::string, std::string>;

  /// Packages of the script, each in the least version that it accepts.
  static Versions Packages() {
    std::ifstream script(fs::path(SourceDir()) / "gauntlet");
    Versions packages;
    std::string line;
    while (std::getline(script, line) && line != "PACKAGES=(") {
    }
    while (std::getline(script, line) && line != ")") {
      const std::size_t blank = line.find(' ', 3);
      std::string least = line.substr(blank + 1, line.size() - blank - 2);
      if (least.starts_with('=')) least = least.substr(1) + "-1";
      packages[line.substr(3, blank - 3)] = least;
    }
    return packages;
  }

  static Versions PackagesWith(const std::string& name, const std::string& version) {
    Versions packages = Packages();
    packages.at(name) = version;
    return packages;
  }

  /// Tools of Debian that read and change two lists: packages that are installed, and packages that
  /// apt offers. apt-get installs what apt offers, and logs its commands.
  void WritePackageTools() const {
    WriteTool(tools_ / "dpkg-query", "#!/bin/sh\ncat '" + installed_.string() + "'\n");
    WriteTool(tools_ / "apt-cache", "#!/bin/sh\ncat '" + offered_.string() + "'\n");
    WriteTool(tools_ / "sudo", "#!/bin/sh\n[ \"$1\" = -v ] || exec \"$@\"\n");
    WriteTool(tools_ / "apt-get", "#!/bin/sh\necho \"$*\" >>'" + commands_.string() +
                                      "'\ncase \"$*\" in *\\ install\\ *)\n  cp '" + all_.string() +
                                      "' '" + installed_.string() + "';;\nesac\n");
  }

  static std::string DpkgList(const Versions& packages) {
    std::string text;
    for (const auto& [name, version] : packages) {
      text += "installed " + name + " " + version + "\n";
    }
    return text;
  }

  void Installed(const Versions& packages) const { Write(installed_, DpkgList(packages)); }

  /// An empty version: apt has the name without a package, as of a virtual one.
  void Offered(const Versions& packages) const {
    std::string text;
    for (const auto& [name, version] : packages) {
      text += name +
              ":\n  Installed: (none)\n  Candidate: " + (version.empty() ? "(none)" : version) +
              "\n  Version table:\n     " + version + " 500\n";
    }
    Write(offered_, text);
    Write(all_, DpkgList(packages));
  }

  static void Replace(std::string& text, std::string_view what, const std::string& by) {
    const std::size_t place = text.find(what);
    ASSERT_NE(place, std::string::npos) << what;
    text.replace(place, what.size(), by);
  }

  /// A compiler that says when it works, then takes its time.
  void CompileForLong() {
    WriteTool(root_ / "compile", "#!/bin/sh\necho $$ > \"$0.pid\"\nexec sleep 60\n");
  }

  std::vector<std::string> Command() const { return {(root_ / "gauntlet").string(), "list"}; }
  ProgramResult Start() const { return RunProgram(Command()); }

  TemporaryDirectory folder_;
  fs::path root_ = folder_.path() / "a checkout";
  fs::path tools_ = folder_.path() / "tools";
  fs::path os_release_ = folder_.path() / "os-release";
  fs::path installed_ = folder_.path() / "installed";
  fs::path offered_ = folder_.path() / "offered";
  fs::path all_ = folder_.path() / "all";  // `installed_` after apt-get
  fs::path commands_ = folder_.path() / "commands";
};

TEST_F(StartScript, BuildsOnceThenSaysNothing) {
  const ProgramResult first = Start();
  EXPECT_EQ(first.standard_output, "toy list\n") << first.standard_error;
  EXPECT_THAT(first.standard_error, HasSubstr("gauntlet: built in "));
  const ProgramResult second = Start();
  EXPECT_EQ(second.standard_output, "toy list\n");
  EXPECT_EQ(second.standard_error, "");
}

TEST_F(StartScript, BuildsWhatACommandNeeds) {
  const fs::path folder = root_ / "build/release/sim/cli";
  EXPECT_EQ(Start().exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "gauntlet_studies"));
  EXPECT_FALSE(fs::exists(folder / "gauntlet"));
  const std::string script = (root_ / "gauntlet").string();
  EXPECT_EQ(RunProgram({script, "help", "run"}).standard_output, "toy help run\n");
  EXPECT_FALSE(fs::exists(folder / "gauntlet"));
  EXPECT_EQ(RunProgram({script, "live"}).standard_output, "toy live\n");
  EXPECT_TRUE(fs::exists(folder / "gauntlet"));

  fs::remove_all(folder);
  const ProgramResult all = RunProgram({script, "build"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.standard_output, "");
  EXPECT_TRUE(fs::exists(folder / "gauntlet_studies"));
  EXPECT_TRUE(fs::exists(folder / "gauntlet"));
  const ProgramResult mistaken = RunProgram({script, "build", "lvie"});
  EXPECT_EQ(mistaken.exit_code, 2);
  EXPECT_EQ(mistaken.standard_error, "gauntlet: build takes no 'lvie'\n");
}

TEST_F(StartScript, AddsItsOwnCommandsToTheHelpOfTheProgram) {
  const std::string script = (root_ / "gauntlet").string();
  for (const std::string words : {"help", "--help", "-h", "help --all", "--help --all"}) {
    const ProgramResult result = RunProgram({"/bin/bash", "-c", "\"$0\" " + words, script});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.standard_output,
              "toy " + words +
                  "\nAlso: ./gauntlet build builds all that is not built yet; "
                  "./gauntlet test runs all tests.\n");
  }
  EXPECT_EQ(RunProgram({script, "run", "--help"}).standard_output, "toy run --help\n");
}

TEST_F(StartScript, KnowsTheCommandsOfTheProgramOfStudies) {
  const std::string script = Text(root_ / "gauntlet");
  const std::string_view begin = "\nSTUDY_COMMANDS=\" ";
  const std::size_t place = script.find(begin) + begin.size();
  std::istringstream listed(script.substr(place, script.find('"', place) - place));
  std::vector<std::string> names;
  for (std::string name; listed >> name;) names.push_back(name);

  const fs::path program = fs::path(GAUNTLET_PROGRAM).parent_path() / "gauntlet_studies";
  std::istringstream offered(RunProgram({program.string(), "--complete", ""}).standard_output);
  std::vector<std::string> commands;
  for (std::string line; std::getline(offered, line);) {
    if (!line.starts_with('-')) commands.push_back(line.substr(0, line.find('\t')));
  }
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(commands));
}

TEST_F(StartScript, ASignalEndsTheBuildToo) {
  for (const auto& [signal, exit_code] : {std::pair{SIGTERM, 143}, {SIGINT, 130}, {SIGHUP, 129}}) {
    CompileForLong();
    fs::remove(root_ / "compile.pid");
    Program program(Command());
    ASSERT_TRUE(program.WaitForPath(root_ / "compile.pid"));
    ASSERT_TRUE(program.WaitForText("building Gauntlet"));
    pid_t compiler = 0;
    while (!(std::ifstream(root_ / "compile.pid") >> compiler)) usleep(10'000);
    program.SendSignal(signal);
    EXPECT_EQ(program.Wait().exit_code, exit_code) << program.Wait().standard_error;
    EXPECT_THAT(program.Wait().standard_error, HasSubstr("gauntlet: stopped\n"));
    for (int i = 0; i < 1000 && Works(compiler); ++i) usleep(10'000);
    EXPECT_FALSE(Works(compiler));
  }
}

TEST_F(StartScript, WaitsForAnotherBuildAndSaysSo) {
  CompileForLong();
  Program first(Command());
  ASSERT_TRUE(first.WaitForPath(root_ / "compile.pid"));
  Program second(Command());
  EXPECT_TRUE(second.WaitForText("waiting for another build in " + root_.string()));
  second.SendSignal(SIGTERM);
  EXPECT_EQ(second.Wait().exit_code, 143);
  first.SendSignal(SIGTERM);
  EXPECT_EQ(first.Wait().exit_code, 143);
}

TEST_F(StartScript, DamagedBuildFilesAreMadeAnew) {
  ASSERT_EQ(Start().exit_code, 0);
  const fs::path build = root_ / "build/release";
  for (const char* name : {"build.ninja", "CMakeCache.txt", "CMakeFiles/rules.ninja"}) {
    const std::string whole = Text(build / name);
    for (const std::string& damaged : {std::string(), whole.substr(0, whole.size() / 3),
                                       "\x01 garbage\n" + whole, std::string(whole.size(), '\0')}) {
      Write(build / name, damaged);
      const ProgramResult result = Start();
      EXPECT_EQ(result.standard_output, "toy list\n") << name << "\n" << result.standard_error;
      EXPECT_THAT(result.standard_error,
                  HasSubstr("the files that say how to build are damaged; making them anew"))
          << name << " of " << damaged.size() << " bytes";
    }
  }
}

TEST_F(StartScript, AMistakeInTheProjectIsShownAsItIs) {
  ASSERT_EQ(Start().exit_code, 0);
  std::ofstream(root_ / "CMakeLists.txt", std::ios::app) << "no_such_command()\n";
  const ProgramResult result = Start();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error, HasSubstr("no_such_command"));
  EXPECT_THAT(result.standard_error, Not(HasSubstr("damaged")));
}

TEST_F(StartScript, ACheckoutThatMovedAndCannotBeWrittenIsRefusedInOneSentence) {
  ASSERT_EQ(Start().exit_code, 0);
  const fs::path moved = folder_.path() / "moved";
  fs::rename(root_, moved);
  const fs::path build = moved / "build/release";
  fs::permissions(build, fs::perms{0555});
  fs::permissions(folder_.path(), fs::perms{0755});
  std::vector<std::string> command = {(moved / "gauntlet").string(), "list"};
  if (geteuid() == 0) {  // who may write everywhere
    command.insert(command.begin(),
                   {"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"});
  }
  const ProgramResult result = RunProgram(command);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.standard_error, "gauntlet: it was built in " + root_.string() + ", and " +
                                       build.string() + " cannot be written: copy " +
                                       moved.string() + " to where it can\n");
  EXPECT_EQ(result.standard_output, "");
}

TEST_F(StartScript, InstallsWhatIsMissingOnDebian12And13WithoutAWarning) {
  for (const char* version : {"12", "13"}) {
    Write(os_release_, std::string("ID=debian\nVERSION_ID=\"") + version + "\"\n");
    Versions some = Packages();
    some.erase("libmujoco-dev");
    some.erase("cmake");
    Installed(some);
    Offered(Packages());
    const ProgramResult result = Start();
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_THAT(result.standard_error,
                HasSubstr("gauntlet: installing with their dependencies: cmake libmujoco-dev\n"));
    EXPECT_THAT(result.standard_error, Not(HasSubstr("not tested")));
    EXPECT_THAT(Text(commands_),
                HasSubstr(" install --no-install-recommends cmake libmujoco-dev\n"));
    EXPECT_EQ(Start().standard_error, "");
  }
}

TEST_F(StartScript, AnotherSystemWithUsablePackagesIsReportedOnceAndBuilds) {
  Write(os_release_, "ID=ubuntu\nVERSION_ID=\"26.04\"\n");
  Installed({});
  Offered(PackagesWith("libmujoco-dev", "2.2.2+dfsg-4ubuntu3"));
  const ProgramResult result = Start();
  EXPECT_EQ(result.standard_output, "toy list\n") << result.standard_error;
  EXPECT_THAT(result.standard_error, HasSubstr("gauntlet: not tested on ubuntu 26.04\n"));
  EXPECT_EQ(result.standard_error.find("not tested"), result.standard_error.rfind("not tested"));
  EXPECT_EQ(Start().standard_error, "");
}

TEST_F(StartScript, APackageThatAptOffersInNoUsableVersionIsNamedAndNothingInstalled) {
  Write(os_release_, "ID=ubuntu\nVERSION_ID=\"24.04\"\n");
  const std::vector<std::array<std::string, 3>> cases = {
      {"libmujoco-dev", "2.3.7-1", "has libmujoco-dev 2.3.7-1, and Gauntlet needs 2.2.2 exactly"},
      {"libmujoco-dev", "2.2.20-1", "has libmujoco-dev 2.2.20-1, and Gauntlet needs 2.2.2 exactly"},
      {"cmake", "3.22.1-1", "has cmake 3.22.1-1, and Gauntlet needs 3.25 or newer"},
      {"g++", "4:11.2.0-1", "has g++ 11.2.0-1, and Gauntlet needs 12.2 or newer"},
      {"libnlopt-cxx-dev", "", "has no package libnlopt-cxx-dev, and Gauntlet needs it"},
  };
  for (const auto& [name, version, problem] : cases) {
    Installed({});
    Offered(PackagesWith(name, version));
    const ProgramResult result = Start();
    EXPECT_EQ(result.exit_code, 2) << problem;
    EXPECT_EQ(result.standard_error, "gauntlet: ubuntu 24.04 " + problem +
                                         "; nothing is installed; " + root_.string() +
                                         "/docs/how-to/install.md describes other ways\n");
    EXPECT_EQ(Text(commands_).find(" install "), std::string::npos);
  }
  Offered({});
  EXPECT_THAT(Start().standard_error, HasSubstr("ubuntu 24.04 has no package cmake, and "));
}

TEST_F(StartScript, AnInstallationThatFailsHasItsReasonInOneSentence) {
  struct Case {
    std::string says;  // apt-get, before its end
    std::string ends;
    std::string sentence;
  };
  Write(os_release_, "ID=debian\nVERSION_ID=\"12\"\n");
  const std::string more = " (more in " + root_.string() + "/build/packages.log)";
  const std::vector<Case> cases = {
      {"dpkg: error processing archive /var/cache/apt/archives/cmake_3.25.deb (--unpack):\n"
       " cannot copy extracted data: failed to write (No space left on device)\n"
       "dpkg: error while cleaning up:\n second\n"
       "E: Sub-process /usr/bin/dpkg returned an error code (1)\n",
       "exit 100",
       "could not install them: dpkg: error processing archive "
       "/var/cache/apt/archives/cmake_3.25.deb (--unpack): cannot copy extracted data: failed to "
       "write (No space left on device)" +
           more},
      {"dpkg: error: dpkg frontend lock is locked by another process\nE: Sub-process\n", "exit 100",
       "could not install them: dpkg: error: dpkg frontend lock is locked by another process" +
           more},
      {"E: Unable to locate package cmake\n", "exit 100",
       "could not install them: Unable to locate package cmake" + more},
      {"E: Failed to fetch http://x/cmake.deb  No network\nE: Unable to fetch some archives\n",
       "exit 100", "could not install them: Failed to fetch http://x/cmake.deb  No network" + more},
      {"", "exit 7", "could not install them: it ended with exit code 7" + more},
      {"Unpacking cmake\n", "kill -KILL $$",
       "was ended by the signal KILL; the same command goes on with what is missing"},
  };
  for (const auto& [says, ends, sentence] : cases) {
    Installed({});
    Offered(Packages());
    WriteTool(tools_ / "apt-get", "#!/bin/sh\ncase \"$*\" in *\\ install\\ *)\ncat <<'E'\n" + says +
                                      "E\n" + ends + ";;\nesac\n");
    const ProgramResult result = Start();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.standard_error, testing::EndsWith("\ngauntlet: apt-get " + sentence + "\n"));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 2) << result.standard_error;
  }
}

TEST_F(StartScript, AnInstalledPackageThatIsTooOldIsNamed) {
  Write(os_release_, "ID=debian\nVERSION_ID=\"11\"\n");
  ASSERT_EQ(Start().exit_code, 0);
  Installed(PackagesWith("libeigen3-dev", "3.3.9-2"));
  const ProgramResult result = Start();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error,
              testing::StartsWith("gauntlet: debian 11 has libeigen3-dev 3.3.9-2, and Gauntlet "
                                  "needs 3.4 or newer; nothing is installed; "));
}

TEST_F(StartScript, WithoutAptThereIsOneSentence) {
  const fs::path bin = folder_.path() / "bin";  // all that the script calls before it needs apt
  fs::create_directory(bin);
  for (const std::string name : {"dirname", "flock", "grep", "mkdir", "readlink", "setsid"}) {
    fs::create_symlink("/usr/bin/" + name, bin / name);
  }
  std::string script = Text(root_ / "gauntlet");
  const std::string path = "export PATH=" + tools_.string();
  Replace(script, path + ":/usr/sbin:/usr/bin:/sbin:/bin", "export PATH=" + bin.string());
  WriteTool(root_ / "gauntlet", script);
  Write(os_release_, "ID=fedora\nVERSION_ID=41\n");
  const ProgramResult result = Start();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.standard_error,
            "gauntlet: fedora 41 has no apt-get, and Gauntlet needs apt; nothing is installed; " +
                root_.string() + "/docs/how-to/install.md describes other ways\n");
}

TEST_F(StartScript, ASystemWithoutANameIsReportedAsUnknown) {
  for (const char* text : {"", "ID=\n", "(\n", "exit 1\n"}) {
    Write(os_release_, text);
    Installed({});
    Offered({});
    EXPECT_THAT(Start().standard_error,
                testing::StartsWith("gauntlet: an unknown system has no package cmake, and "))
        << text;
  }
  Write(os_release_, "ID=arch\n");
  EXPECT_THAT(Start().standard_error, HasSubstr("gauntlet: arch has no package cmake, and "));
}

}  // namespace
}  // namespace gauntlet::test
