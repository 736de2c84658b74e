#!/usr/bin/python3
"""Lists types of controller/ and sim/ that two files define in one namespace.

  tests/support/one_definition.py [FOLDER]...

Such types are undefined behaviour that no compiler reports: the linker keeps the inline members of one of them for both.
Relies on the style of the project: a namespace and a type of it begin at the begin of a line.
"""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TYPE = re.compile(r"(?:struct|class|enum class) (?:GAUNTLET_API )?([A-Za-z]\w*)(?: final)?(?: :.*)?(?: \{.*)?$")


def types_of(path):
    """Full names of the types that a file defines outside unnamed namespaces."""
    namespaces = []
    lines = path.read_text().splitlines()
    for line, after in zip(lines, lines[1:] + [""]):
        if opened := re.match(r"namespace ?(\S*) \{$", line):
            namespaces.append(opened[1])
        elif line.startswith("}  // namespace"):
            namespaces.pop()
        elif (found := TYPE.match(line)) and "" not in namespaces and not line.endswith(";"):
            if "{" in line or after.startswith(("    :", " {", "{")):  # else a declaration
                yield "::".join([*namespaces, found[1]])


def main():
    folders = [pathlib.Path(name) for name in sys.argv[1:]] or [ROOT / "controller", ROOT / "sim"]
    files = collections.defaultdict(list)
    for folder in folders:
        for path in sorted([*folder.rglob("*.h"), *folder.rglob("*.cc")]):
            for name in types_of(path):
                files[name].append(str(path))
    twice = {name: paths for name, paths in files.items() if len(paths) > 1}
    for name, paths in twice.items():
        print(f"{name} is defined in {' and in '.join(paths)}")
    print(f"{len(files)} types, {len(twice)} with more than one definition")
    return 1 if twice or not files else 0


sys.exit(main())
