#!/usr/bin/env python3
"""The first lines of controller/README.md, in C++ and in C, are a robot's program.

    readme.py SOURCE_FOLDER LIBRARY C++_COMPILER

Both programs take one sample of the two sensors of examples/robot.txt, and print the command to its 18 motors.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

CPP = """#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>
#include "controller/controller.h"
#include "controller/robot_text.h"
int main(int, char** arguments) {
  std::ifstream file(arguments[1]);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::vector<std::int32_t> motor_counts(18, 2048);
  const std::vector<double> counts = {400, 500};
  %s
  std::printf("%%d", command.event);
  for (const int motor : command.motor_counts) std::printf(" %%d", motor);
}
"""
C = """#include <stdint.h>
#include <stdio.h>
#include "controller/c_api/gauntlet_controller.h"
int main(int count, char** arguments) {
  static char text[20000];
  FILE* file = fopen(arguments[count - 1], "r");
  size_t length = fread(text, 1, sizeof text, file), channels = 2, motors = 18, i;
  char error[200];
  int32_t motor_counts[18];
  const double counts[] = {400, 500};
  for (i = 0; i < motors; ++i) motor_counts[i] = 2048;
  %s
  printf("%%d", result == GAUNTLET_EVENT);
  for (i = 0; i < motors; ++i) printf(" %%d", motor_counts[i]);
  gauntlet_controller_destroy(controller);
  return 0;
}
"""


def main(source, library, compiler):
    source = pathlib.Path(source)
    readme = (source / "controller/README.md").read_text()
    printed = []
    with tempfile.TemporaryDirectory() as folder:
        for language, frame in ("cpp", CPP), ("c", C):
            lines, = re.findall(rf"```{language}\n(.*?)```", readme, re.S)
            assert lines.count("\n") == 3, f"three lines of {language}"
            program = pathlib.Path(folder) / language
            code = program.with_suffix("." + language)
            code.write_text(frame % lines)
            as_it_is = ["-std=c++20"] if language == "cpp" else ["-x", "c", "-std=c99"]
            subprocess.run([compiler, *as_it_is, "-Wall", "-Wextra", "-Werror", f"-I{source}", code, "-x", "none", library,
                            "-lstdc++", "-lm", "-o", program], check=True)
            printed.append(subprocess.run([program, source / "controller/examples/robot.txt"], check=True,
                                          capture_output=True, text=True).stdout)
    assert printed[0] == printed[1] and printed[0].startswith("1 "), printed
    assert printed[0].split() != ["1"] + ["2048"] * 18, "the motors move"


main(*sys.argv[1:])
