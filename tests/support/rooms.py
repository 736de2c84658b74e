#!/usr/bin/python3
"""Rooms of sim/ and which includes which, as ARCHITECTURE.md shows them.

  tests/support/rooms.py            checks that the picture in ARCHITECTURE.md is current and that no room includes one above it
  tests/support/rooms.py --write    draws it there

The rooms stand in the order of the table in ARCHITECTURE.md, lowest first.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "ARCHITECTURE.md"
BEGIN, END = "<!-- rooms.py -->\n", "<!-- end -->\n"


def rooms_of(page):
    return re.findall(r"^\| `sim/(\w+)/` \|", page, re.M)


def arrows():
    """{(room, room that it includes): one of the lines that do}"""
    found = {}
    for path in sorted((ROOT / "sim").rglob("*")):
        if path.suffix not in (".h", ".cc"):
            continue
        room = path.relative_to(ROOT / "sim").parts[0]
        for included in re.findall(r'^#include "sim/(\w+)/', path.read_text("utf-8"), re.M):
            if included != room:
                found.setdefault((room, included), path.relative_to(ROOT))
    return found


def picture(rooms, found):
    """A row for each room, highest first, with a point in the column of each room that it includes."""
    width = max(map(len, rooms))
    lines = []
    for number in range(len(rooms) - 1, -1, -1):
        room = rooms[number]
        points = "".join(" x " if (room, other) in found else " . " for other in rooms[:number])
        lines.append(f"    {room:>{width}} {points}".rstrip())
    below = "".join(f"{room[:2]} " for room in rooms[:-1])
    return "\n".join([*lines, f"    {'':>{width}} {below}".rstrip()]) + "\n"


def main():
    page = PAGE.read_text("utf-8")
    rooms, found = rooms_of(page), arrows()
    folders = {path.name for path in (ROOT / "sim").iterdir() if path.is_dir()}
    faults = [f"sim/{room}: not in the table of ARCHITECTURE.md" for room in sorted(folders - set(rooms))]
    faults += [f"sim/{room}: in the table of ARCHITECTURE.md, and no folder" for room in sorted(set(rooms) - folders)]
    if not faults:
        faults = [f"{path}: sim/{room} includes sim/{other}, which stands above it" for (room, other), path in found.items()
                  if rooms.index(other) > rooms.index(room)]
    if not faults:
        begin, end = page.index(BEGIN) + len(BEGIN), page.index(END)
        current = page[:begin] + picture(rooms, found) + page[end:]
        if sys.argv[1:] == ["--write"]:
            PAGE.write_text(current, "utf-8")
        elif current != page:
            faults.append("ARCHITECTURE.md: its picture of the rooms is not current: tests/support/rooms.py --write")
    print("".join(fault + "\n" for fault in faults), end="")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
