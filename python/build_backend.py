"""Builds a wheel of the module for pip (PEP 517), with CMake in build/pip and without the network."""
import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
BUILD = ROOT / "build/pip"
NAME = f"{PROJECT['name']}-{PROJECT['version']}"
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"
TAG = f"{TAG}-{TAG}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"

METADATA = f"""Metadata-Version: 2.1
Name: {PROJECT['name']}
Version: {PROJECT['version']}
Summary: {PROJECT['description']}
Requires-Python: {PROJECT['requires-python']}
""" + "".join(f"Requires-Dist: {name}\n" for name in PROJECT["dependencies"])
WHEEL = f"Wheel-Version: 1.0\nGenerator: gauntlet\nRoot-Is-Purelib: false\nTag: {TAG}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The compiled module, its Python files, and the models, scenarios and studies beside them."""
    with tempfile.TemporaryDirectory() as folder:
        stage = pathlib.Path(folder)
        _cmake("-S", ROOT, "-B", BUILD, "--preset", "release", "-DGAUNTLET_BUILD_TESTS=OFF", "-DGAUNTLET_BUILD_BENCHMARKS=OFF",
               "-DGAUNTLET_BUILD_PYTHON=ON", "-DGAUNTLET_PYTHON_DIR=.", f"-DPython_EXECUTABLE={sys.executable}")
        _cmake("--build", BUILD, "--target", "gauntlet_python")
        _cmake("--install", BUILD, "--component", "python", "--prefix", stage, "--strip")
        files = {path.relative_to(stage).as_posix(): path.read_bytes() for path in sorted(stage.rglob("*")) if path.is_file()}
    for data in ("models", "scenarios", "studies"):
        for path in sorted((ROOT / data).rglob("*")):
            if path.is_file() and path.suffix not in (".py", ".gp"):
                files[f"gauntlet/data/{path.relative_to(ROOT).as_posix()}"] = path.read_bytes()
    files |= {f"{NAME}.dist-info/METADATA": METADATA.encode(), f"{NAME}.dist-info/WHEEL": WHEEL.encode(),
              f"{NAME}.dist-info/LICENSE": (ROOT / "LICENSE").read_bytes()}
    record = f"{NAME}.dist-info/RECORD"
    lines = [f"{name},sha256={_hash(content)},{len(content)}" for name, content in files.items()]
    files[record] = "".join(line + "\n" for line in [*lines, f"{record},,"]).encode()
    wheel = f"{NAME}-{TAG}.whl"
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return wheel


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """What pip asks before it builds."""
    folder = pathlib.Path(metadata_directory, f"{NAME}.dist-info")
    folder.mkdir()
    (folder / "METADATA").write_text(METADATA)
    (folder / "WHEEL").write_text(WHEEL)
    return folder.name


def _cmake(*arguments):
    subprocess.run(["cmake", *map(str, arguments)], check=True, cwd=ROOT)


def _hash(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
