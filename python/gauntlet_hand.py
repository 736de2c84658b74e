"""The program `gauntlet` of an installed wheel. Not in the package, which would load the module first."""
import os
import pathlib
import sys


def main() -> None:
    """Becomes the program, with the arguments of the command line."""
    program = pathlib.Path(__file__).parent / "gauntlet" / "bin" / "gauntlet"
    try:
        os.execv(program, ["gauntlet", *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"gauntlet: {program} cannot be started: {error.strerror}; install gauntlet-hand again")
