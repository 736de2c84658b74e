#!/usr/bin/python3
"""Runs whole commands on Parquet and MCAP files that are damaged inside, with right checksums.

    tests/fuzz/whole_commands.py build/release/sim/cli/gauntlet --seconds 60 --keep found

A byte that is changed in a compressed page or chunk ends in its checksum or its codec, and never
reaches what is behind them. So the files of tests/recordings (and other good ones that are named)
are taken apart: pages and chunks are unpacked, changed, packed again by one of the codecs, and get
sizes, places and checksums that fit. Numbers of headers and descriptions are changed, too.

A command has to end within 20 s, with exit code 0, 1 or 2, with at most 1.5 GB (the limit of a
helper process is 1 GB beside the program), with JSON that is JSON, or with one line that says what
is wrong. Files that break this are kept. Needs the programs zstd and lz4. Exit code: 0 nothing was
found, 1 something was. `--seed` repeats a run as far as it got.
"""
import argparse
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
GOOD = ("parquet/snappy.parquet", "parquet/gzip.parquet", "parquet/uncompressed.parquet", "keypoints/hand.parquet",
        "mcap/plain.mcap", "mcap/lz4.mcap", "mcap/zstd.mcap", "mcap/no_index.mcap", "keypoints/hand.mcap")
LONGEST_S = 20
MOST_BYTES = 1500 << 20
# What one of the program's own errors does not say.
STRANGE = re.compile(r"by signal|std::|bad_alloc|basic_string|vector|terminate|what\(\)|assert|\b(?:stoi|stod|map::at)\b", re.I)


def edge(draw, bits):
    """A number near an end of some range."""
    return (draw.choice((0, 1, 2, 7, 8, 1 << draw.randrange(bits), -1, -2)) + draw.choice((0, 0, 1, -1))) % (1 << bits)


def damaged(draw, data):
    """The bytes with one to four changes."""
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        at = draw.randrange(len(data) + 1) if draw.random() < 0.6 else min(draw.randrange(24), len(data))
        change = draw.randrange(7)
        if change == 0:
            data[at:at + 1] = bytes([draw.randrange(256)])
        elif change == 1 and at < len(data):
            data[at] ^= 1 << draw.randrange(8)
        elif change == 2:
            del data[at:at + draw.choice((1, 2, 4, 8, 100))]
        elif change == 3:
            data[at:at] = bytes(draw.randrange(256) for _ in range(draw.choice((1, 4, 8))))
        elif change == 4:
            size = draw.choice((2, 4, 8))
            data[at:at + size] = edge(draw, 8 * size).to_bytes(size, "little")
        elif change == 5:
            data[at:at] = data[at:at + draw.choice((1, 8, 64, 1000))]
        else:
            data[at:at + 8] = struct.pack("<d", draw.choice((float("nan"), float("inf"), -1e308, 5e-324, 1e18)))
    return bytes(data)


def piped(command, data):
    return subprocess.run(command, input=data, stdout=subprocess.PIPE, check=True).stdout


# --- Parquet: thrift in its compact form. A struct is a list of [field, type, value].

BOOLEANS, WHOLE, DOUBLE, BINARY, LISTS, STRUCT = (1, 2), (3, 4, 5, 6), 7, 8, (9, 10), 12


def varint(number):
    data = bytearray()
    while True:
        number, low = number >> 7, number & 127
        data.append(low | (128 if number else 0))
        if not number:
            return bytes(data)


def zigzag(number):
    return varint((number << 1 ^ number >> 63) & (1 << 64) - 1)


class Thrift:
    def __init__(self, data, at):
        self.data, self.at = data, at

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def varint(self):
        number = shift = 0
        while True:
            byte = self.byte()
            number |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return number

    def number(self):
        number = self.varint()
        return number >> 1 ^ -(number & 1)

    def take(self, size):
        self.at += size
        return self.data[self.at - size:self.at]

    def value(self, kind, in_list=False):
        if kind in BOOLEANS:
            return self.byte() if in_list else kind
        if kind == 3:
            return self.byte()
        if kind in WHOLE:
            return self.number()
        if kind == DOUBLE:
            return self.take(8)
        if kind == BINARY:
            return self.take(self.varint())
        if kind in LISTS:
            head = self.byte()
            size = self.varint() if head >> 4 == 15 else head >> 4
            return [head & 15] + [self.value(head & 15, True) for _ in range(size)]
        assert kind == STRUCT, kind
        return self.struct()

    def struct(self):
        fields, last = [], 0
        while (head := self.byte()) != 0:
            last = last + (head >> 4) if head >> 4 else self.number()
            fields.append([last, head & 15, self.value(head & 15)])
        return fields


def packed_value(kind, value, in_list=False):
    if kind in BOOLEANS:
        return bytes([value]) if in_list else b""
    if kind == 3:
        return bytes([value % 256])
    if kind in WHOLE:
        return zigzag(value)
    if kind == DOUBLE:
        return value
    if kind == BINARY:
        return varint(len(value)) + value
    if kind in LISTS:
        size = len(value) - 1
        head = bytes([size << 4 | value[0]]) if size < 15 else bytes([240 | value[0]]) + varint(size)
        return head + b"".join(packed_value(value[0], item, True) for item in value[1:])
    return packed_struct(value)


def packed_struct(fields):
    data, last = b"", 0
    for field, kind, value in fields:
        step, last = field - last, field
        data += (bytes([step << 4 | kind]) if 0 < step < 16 else bytes([kind]) + zigzag(field)) + packed_value(kind, value)
    return data + b"\0"


def field_of(fields, wanted):
    """None without it."""
    return next((value for field, _, value in fields if field == wanted), None)


def set_field(fields, wanted, kind, value):
    for one in fields:
        if one[0] == wanted:
            one[2] = value
            return
    fields.append([wanted, kind, value])
    fields.sort(key=lambda one: one[0])


def all_fields(fields):
    """(the struct, the place in it) of all fields, those of nested structs included."""
    for place, (_, kind, value) in enumerate(fields):
        yield fields, place
        if kind == STRUCT:
            yield from all_fields(value)
        if kind in LISTS and value[0] == STRUCT:
            for item in value[1:]:
                yield from all_fields(item)


def damage_struct(draw, fields):
    inside, place = draw.choice(list(all_fields(fields)))
    _, kind, value = inside[place]
    if draw.random() < 0.1:
        del inside[place]
    elif kind in WHOLE:
        number = draw.choice((value + 1, value - 1, -value, edge(draw, 63), edge(draw, 31), draw.randrange(16)))
        inside[place][2] = number % 256 if kind == 3 else number
    elif kind == BINARY:
        inside[place][2] = damaged(draw, value)
    elif kind in LISTS and len(value) > 1:
        if draw.random() < 0.5:
            del value[draw.randrange(1, len(value))]
        else:
            value.insert(draw.randrange(1, len(value) + 1), draw.choice(value[1:]))


def snappy_packed(data):
    stored = varint(len(data))
    for at in range(0, len(data), 60000):
        part = data[at:at + 60000]
        stored += bytes([61 << 2]) + struct.pack("<H", len(part) - 1) + part
    return stored


def snappy_unpacked(stored):
    reader, data = Thrift(stored, 0), bytearray()
    reader.varint()
    while reader.at < len(stored):
        head = reader.byte()
        kind, size = head & 3, head >> 2
        if kind == 0:
            if size >= 60:
                size = int.from_bytes(reader.take(size - 59), "little")
            data += reader.take(size + 1)
            continue
        if kind == 1:
            size, far = (size & 7) + 4, head >> 5 << 8 | reader.byte()
        else:
            size, far = size + 1, int.from_bytes(reader.take(2 if kind == 2 else 4), "little")
        for _ in range(size):
            data.append(data[-far])
    return bytes(data)


def gzipped(data):
    packer = zlib.compressobj(6, zlib.DEFLATED, 31)
    return packer.compress(data) + packer.flush()


CODECS = {
    0: (lambda data: data, lambda data: data),
    1: (snappy_packed, snappy_unpacked),
    2: (gzipped, lambda data: zlib.decompress(data, 47)),
    6: (lambda data: piped(["zstd", "-qc"], data), lambda data: piped(["zstd", "-qdc"], data)),
}


def damaged_parquet(draw, good):
    size = struct.unpack("<I", good[-8:-4])[0]
    meta = Thrift(good, len(good) - 8 - size).struct()
    codec = draw.choice(sorted(CODECS))
    page_share, head_share = draw.choice(((0.1, 0.0), (0.5, 0.0), (0.0, 0.1), (0.05, 0.05), (0.0, 0.0)))
    with_sums = draw.random() < 0.5
    out = b"PAR1"
    for group in field_of(meta, 4)[1:]:
        for chunk in field_of(group, 1)[1:]:
            about = field_of(chunk, 3)
            pack, unpack = CODECS[codec][0], CODECS[field_of(about, 4)][1]
            at = min(filter(None, (field_of(about, 9), field_of(about, 11))))
            end = at + field_of(about, 7)
            begin, data_at, dictionary_at = len(out), None, None
            while at < end:
                reader = Thrift(good, at)
                head = reader.struct()
                body = reader.take(field_of(head, 3))
                at = reader.at
                second = field_of(head, 8)  # levels of a page of version 2 are never compressed
                levels = field_of(second, 5) + field_of(second, 6) if second else 0
                packed = not second or field_of(second, 7) != 2
                plain = body[:levels] + (unpack(body[levels:]) if packed else body[levels:])
                if draw.random() < page_share:
                    plain = damaged(draw, plain)
                levels = min(levels, len(plain))
                stored = plain[:levels] + (pack(plain[levels:]) if packed else plain[levels:])
                if field_of(head, 1) == 2:
                    dictionary_at = len(out)
                elif data_at is None:
                    data_at = len(out)
                set_field(head, 2, 5, len(plain))
                set_field(head, 3, 5, len(stored))
                if with_sums or field_of(head, 4) is not None:
                    set_field(head, 4, 5, struct.unpack("<i", struct.pack("<I", zlib.crc32(stored)))[0])
                if draw.random() < head_share:
                    damage_struct(draw, head)
                out += packed_struct(head) + stored
            set_field(about, 4, 5, codec)
            for field in (6, 7):
                set_field(about, field, 6, len(out) - begin)
            set_field(about, 9, 6, begin if data_at is None else data_at)
            if dictionary_at is not None:
                set_field(about, 11, 6, dictionary_at)
    if page_share + head_share == 0.0 or draw.random() < 0.2:
        for _ in range(draw.choice((1, 2, 5))):
            damage_struct(draw, meta)
    about = packed_struct(meta)
    return out + about + struct.pack("<I", len(about)) + b"PAR1"


# --- MCAP

MCAP = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = 2, 3, 4, 5, 6, 7, 8, 11, 15


def records_of(data):
    records, at = [], 0
    while at + 9 <= len(data):
        opcode, size = struct.unpack_from("<BQ", data, at)
        records.append([opcode, data[at + 9:at + 9 + size]])
        at += 9 + size
    return records


def record(opcode, content, size=None):
    return struct.pack("<BQ", opcode, len(content) if size is None else size) + content


def text(data):
    return struct.pack("<I", len(data)) + data


def damage_records(draw, records):
    """Returns the bytes."""
    change = draw.randrange(8)
    wanted = draw.choice((MESSAGE, MESSAGE, CHANNEL, SCHEMA, None))
    places = [i for i, one in enumerate(records) if one[0] == wanted] or range(len(records))
    place = draw.choice(places)
    if change < 4:
        records[place][1] = damaged(draw, records[place][1])
    elif change == 4:
        del records[place]
    elif change == 5:
        records.insert(draw.randrange(len(records)), list(records[place]))
    elif change == 6:
        records[place][0] = draw.randrange(17)
    sizes = [None] * len(records)
    if change == 7:
        sizes[place] = draw.choice((edge(draw, 64), len(records[place][1]) + draw.choice((-1, 1))))
    return b"".join(record(*one, size) for one, size in zip(records, sizes))


PACKED = {
    b"": (lambda data: data, lambda data: data),
    b"lz4": (lambda data: piped(["lz4", "-qc"], data), lambda data: piped(["lz4", "-qdc"], data)),
    b"zstd": (lambda data: piped(["zstd", "-qc", "--no-check"], data), lambda data: piped(["zstd", "-qdc"], data)),
}


class Chunk:
    """What a chunk says, and its records."""

    def __init__(self, content):
        self.first, self.last, _, _, size = struct.unpack_from("<QQQII", content)
        self.packing = content[32:32 + size]
        self.records = PACKED[self.packing][1](content[40 + size:])

    def content(self, draw, is_damaged):
        stored = PACKED[self.packing][0](self.records)
        size = len(self.records)
        if is_damaged and draw.random() < 0.15:
            size = draw.choice((edge(draw, 64), size + 1, size - 1, 1 << 28, 1 << 30))
        return struct.pack("<QQQI", self.first, self.last, size, zlib.crc32(self.records)) + text(self.packing) + \
            struct.pack("<Q", len(stored)) + stored, len(stored), size


def damaged_mcap(draw, good):
    share = draw.choice((0.1, 0.5, 0.0))
    end = len(good) - len(MCAP)
    summary_at, = struct.unpack_from("<Q", good, end - 20)
    places, out, packing = {}, MCAP, draw.choice(sorted(PACKED))
    data = records_of(good[len(MCAP):summary_at or end - 29])
    if all(opcode != CHUNK for opcode, _ in data):
        loose = [one for one in data if one[0] != DATA_END]
        out += damage_records(draw, loose)
        data = [[DATA_END, b"0000"]]
    for opcode, content in data:
        if opcode == CHUNK:
            old, chunk = len(places), Chunk(content)
            chunk.packing = packing
            is_damaged = draw.random() < share or (share == 0.0 and old == 0 and not summary_at)
            if is_damaged:
                chunk.records = damage_records(draw, records_of(chunk.records))
            content, stored, size = chunk.content(draw, is_damaged)
            last = places[old] = {"at": len(out), "length": len(content) + 9, "stored": stored, "size": size, "indexes": {}}
        elif opcode == MESSAGE_INDEX:
            last["indexes"][content[:2]] = len(out)
            if draw.random() < 0.1 * share:
                content = damaged(draw, content)
            last["end"] = len(out) + 9 + len(content)
        elif opcode == DATA_END:
            content = struct.pack("<I", zlib.crc32(out))
        out += record(opcode, content)
    if not summary_at or draw.random() < 0.2:
        return out + record(FOOTER, struct.pack("<QQI", 0, 0, 0)) + MCAP
    summary, number = [], 0
    for opcode, content in records_of(good[summary_at:end - 29]):
        if opcode == CHUNK_INDEX and number in places:
            chunk, number = places[number], number + 1
            indexes = b"".join(channel + struct.pack("<Q", at) for channel, at in chunk["indexes"].items())
            content = content[:16] + struct.pack("<QQ", chunk["at"], chunk["length"]) + text(indexes) + \
                struct.pack("<Q", chunk.get("end", chunk["at"] + chunk["length"]) - chunk["at"] - chunk["length"]) + \
                text(packing) + struct.pack("<QQ", chunk["stored"], chunk["size"])
        if opcode in (SCHEMA, CHANNEL, CHUNK_INDEX, STATISTICS):
            summary.append([opcode, content])
    begin = len(out)
    whole = b"".join(record(*one) for one in summary)
    if share == 0.0 or draw.random() < 0.1:
        whole = damage_records(draw, summary)
    tail = struct.pack("<BQQQ", FOOTER, 20, begin, 0)
    return out + whole + tail + struct.pack("<I", zlib.crc32(whole + tail)) + MCAP


# --- commands

def commands(draw, name):
    topic = []
    if name.endswith(".mcap"):
        topic = ["--topic", draw.choice(("/joint_states", "/commands", "/fingers", "/camera"))]
        if "hand" in name or draw.random() < 0.1:
            topic = []
    shown = draw.choice((["--json"], ["--json"], ["--verbose"],
                         ["--write-map", "map.csv", "--write-scenario", "scenario.yaml", "--out", "page.html", "--force"]))
    return draw.choice((["inspect", name, *topic, *shown],) * 6 +
                       (["audit", name, *topic], ["identify", name, *topic], ["calibrate", name, *topic],
                        ["compare", name, *topic, "--controllers", "raw,one_euro", "--seeds", "1", "--filter-only",
                         "--out", "out", "--force"]))


def no_number(name):
    raise ValueError(name)


def run(program, arguments, folder):
    """(what is wrong, or None; the exit code)."""
    with open(os.path.join(folder, "said"), "w+b") as said, open(os.path.join(folder, "wrong"), "w+b") as wrong:
        child = subprocess.Popen([program, *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=said, stderr=wrong)
        limit = time.monotonic() + LONGEST_S
        while True:
            pid, status, used = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > limit:
                child.kill()
                child.returncode = -9
                os.waitpid(child.pid, 0)
                return "it hangs", None
            time.sleep(0.002)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        wrong.seek(0)
        output, errors = said.read(), wrong.read().decode(errors="replace")
    code = child.returncode
    if code not in (0, 1, 2):
        return f"exit code {code}", code
    if used.ru_maxrss * 1024 > MOST_BYTES:
        return f"{used.ru_maxrss >> 10} MB", code
    if strange := STRANGE.search(errors):
        return f"it says '{strange.group()}': {errors.strip()[-200:]}", code
    if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", errors) or re.search(rb"[\x00-\x08\x0b-\x1f\x7f]", output):
        return "bytes that steer a terminal", code
    if code and not errors.startswith("gauntlet: ") and "\ngauntlet: " not in errors:
        return f"no error in its words: {errors[:200]}", code
    if code == 0 and "--json" in arguments:
        try:
            json.loads(output, parse_constant=no_number)
        except ValueError as error:
            return f"no JSON: {error}", code
    return None, code


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("files", nargs="*", help="other good files, .parquet or .mcap")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", default="found", help="a folder, for what breaks something")
    options = parser.parse_args()
    good = {}
    for path in [os.path.join(ROOT, "tests/recordings", name) for name in GOOD] + options.files:
        with open(path, "rb") as file:
            good[path] = file.read()
    draw = random.Random(options.seed)
    begin, ran, found, codes = time.monotonic(), 0, 0, {}
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() - begin < options.seconds:
            path = draw.choice(sorted(good))
            ending = os.path.splitext(path)[1]
            name = ("hand" if "hand" in path else "file") + ending
            damage = damaged_parquet if ending == ".parquet" else damaged_mcap
            with open(os.path.join(folder, name), "wb") as file:
                file.write(damage(draw, good[path]))
            arguments = commands(draw, name)
            problem, code = run(options.program, arguments, folder)
            if problem == "it hangs":  # or the machine was busy
                problem, code = run(options.program, arguments, folder)
            ran += 1
            codes[code] = codes.get(code, 0) + 1
            if problem:
                found += 1
                os.makedirs(options.keep, exist_ok=True)
                kept = os.path.join(options.keep, f"{options.seed}_{ran}_{name}")
                shutil.copy(os.path.join(folder, name), kept)
                print(f"{kept}: {' '.join(arguments)}: {problem}", flush=True)
    print(f"seed {options.seed}: {ran} commands, exit codes {codes}, {found} found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
