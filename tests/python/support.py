"""Shared by the tests of the module: the program beside it, folders, short scenarios."""
import os
import pathlib
import subprocess
import tempfile
import unittest
import warnings

import gauntlet

SOURCE = pathlib.Path(os.environ["GAUNTLET_SOURCE_DIR"])
SCENARIO = SOURCE / "scenarios/hold_still.yaml"
SHORT = {"glove.motion.duration_s": 0.5}


def program(*arguments, code=0):
    """Standard output and error of the program."""
    done = subprocess.run([os.environ["GAUNTLET_PROGRAM"], *map(str, arguments)], text=True, capture_output=True,
                          stdin=subprocess.DEVNULL)
    if done.returncode != code:
        raise AssertionError(f"exit code {done.returncode}: {done.stderr}")
    return done.stdout, done.stderr


class Test(unittest.TestCase):
    """Runs in an empty folder; remarks are no errors."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(folder.name)
        self.folder = pathlib.Path(folder.name)
        context = warnings.catch_warnings()
        context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        warnings.simplefilter("ignore", gauntlet.Remark)

    def mistake(self, call, *arguments, **named):
        with self.assertRaises(gauntlet.SettingError) as caught:
            call(*arguments, **named)
        return caught.exception
