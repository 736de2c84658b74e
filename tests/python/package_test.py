"""The package: names, stubs, data."""
import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys
import unittest

import gauntlet
from gauntlet import _core
from support import SOURCE, Test


class Package(Test):
    def test_has_what_it_names_with_a_description_and_types(self):
        for name in gauntlet.__all__:
            member = getattr(gauntlet, name)
            if name == "Settings":
                continue
            self.assertTrue(inspect.getdoc(member), name)
            if inspect.isfunction(member):
                signature = inspect.signature(member)
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, name)
                for parameter in signature.parameters.values():
                    self.assertIsNot(parameter.annotation, inspect.Parameter.empty, f"{name}({parameter.name})")
        self.assertTrue((pathlib.Path(gauntlet.__file__).parent / "py.typed").exists())

    def test_the_stub_has_exactly_what_is_compiled(self):
        stub = ast.parse((SOURCE / "python/gauntlet/_core.pyi").read_text())
        names, arguments = set(), {}
        for node in stub.body:
            if isinstance(node, ast.FunctionDef):
                arguments[node.name] = [argument.arg for argument in node.args.args]
            elif isinstance(node, ast.ClassDef):
                arguments.update({f"{node.name}.{each.name}": None for each in node.body})
                names.add(node.name)
        compiled = {name for name in dir(_core) if not name.startswith("_")}
        self.assertEqual(compiled, names | {name for name in arguments if "." not in name})
        for name in names:
            members = {f"{name}.{each}" for each in dir(getattr(_core, name)) if not each.startswith("_")}
            self.assertEqual(members, {each for each in arguments if each.startswith(name + ".") and "__" not in each})
        for name, expected in arguments.items():
            if "." in name or expected in ([], None) or name == "set_data_folder":
                continue
            shown = re.search(r"\((.*)\)", getattr(_core, name).__doc__.splitlines()[0])[1]
            self.assertEqual(re.findall(r"(\w+): ", shown), expected, name)

    def test_has_the_version_of_the_program(self):
        self.assertEqual(f"gauntlet {gauntlet.__version__}", subprocess.run(
            [os.environ["GAUNTLET_PROGRAM"], "--version"], text=True, capture_output=True).stdout.split("\n")[0][:len(
                f"gauntlet {gauntlet.__version__}")])

    def test_refuses_the_mujoco_of_another_package(self):
        """Which is called in place of its own if it was loaded for all (RTLD_GLOBAL), and crashes."""
        source, library = self.folder / "other.c", self.folder / "other.so"
        source.write_text('int mj_version(void) { return 3017000; }\nconst char* mj_versionString(void) { return "3.17.0"; }\n')
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
        code = f"import ctypes; ctypes.CDLL({str(library)!r}, ctypes.RTLD_GLOBAL); import gauntlet"
        done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True)
        self.assertEqual(done.stderr.splitlines()[-1], "ImportError: MuJoCo 3.17.0 is loaded for the whole process "
                         "(RTLD_GLOBAL); import gauntlet before it, or in a process of its own")
        self.assertEqual(done.returncode, 1)

    def test_says_that_it_needs_numpy(self):
        code = "import sys; sys.modules['numpy'] = None; import gauntlet"
        done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True)
        self.assertEqual(done.stderr.splitlines()[-1], "ImportError: gauntlet needs numpy: pip install numpy")

    def test_refuses_a_numpy_that_it_would_misread(self):
        # pybind11 before 2.12 gives wrong values for arrays of numpy 2: Debian 12 has 2.10.3 and numpy 1.24.2.
        code = "import numpy; numpy.__version__ = '2.0.1'; import gauntlet; print('reads it')"
        done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True)
        header = pathlib.Path("/usr/include/pybind11/detail/common.h").read_text()
        minor = int(re.search(r"define PYBIND11_VERSION_MINOR (\d+)", header)[1])
        if minor < 12:
            self.assertEqual(done.stderr.splitlines()[-1], "ImportError: this build of gauntlet is for numpy 1 (it was made with pybind11 "
                             "before 2.12), and numpy 2.0.1 is here; take python3-numpy of the system, or the wheel")
        else:
            self.assertEqual(done.stdout, "reads it\n")

    def test_looks_where_the_variable_says(self):
        code = "import gauntlet; gauntlet.run('hold_still', set={'glove.motion.duration_s': 0.3})"
        environment = {**os.environ, "GAUNTLET_DATA_DIR": str(self.folder)}
        done = subprocess.run([sys.executable, "-c", code], env=environment, text=True, capture_output=True)
        self.assertIn("SettingError", done.stderr)
        self.assertIn(f"no folder {self.folder}", done.stderr)
        environment["GAUNTLET_DATA_DIR"] = str(SOURCE)
        subprocess.run([sys.executable, "-W", "ignore", "-c", code], env=environment, check=True)

    def test_shows_no_symbol_but_that_of_python(self):
        lines = subprocess.run(["nm", "--dynamic", "--defined-only", _core.__file__], text=True, capture_output=True,
                               check=True).stdout.splitlines()
        own = [line.split()[-1] for line in lines if "gauntlet" in line]
        self.assertEqual(own, [])
        self.assertTrue(any(line.endswith(" PyInit__core") for line in lines))


if __name__ == "__main__":
    unittest.main()
