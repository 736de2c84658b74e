#!/bin/bash
# polars 2.1.0, pandas 3.1.1, pyarrow 26.0.1 and duckdb 2.0.1 (PyPI), with NumPy 2.4.6: the time since the first sample of a 100 Hz
# glove, time - time[0], in a Parquet file that DuckDB reads.
#
# Guess: a duration stays one: DuckDB makes an INTERVAL of the same column of a polars frame or an Arrow table.
# Seen: of the file it makes whole numbers, without a word. The second sample is at 10, 10000 or 10000000, as the times were made of
# epochs in ms, of texts, or cast to ns. Parquet has no type for durations; their unit is in the schema of Arrow beside them, which
# pandas and polars alone read. A reader that takes the number for ms makes a glove of 0.1 Hz of one of 100 Hz.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 pyarrow==26.0.1 pandas==3.1.1 polars==2.1.0 duckdb==2.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import datetime

import duckdb
import pandas as pd
import polars as pl

BEGIN_MS = 1764410400000
begin = datetime.datetime(2025, 11, 29, 10)
moments = pl.Series("time", [begin + datetime.timedelta(milliseconds=10 * i) for i in range(100)])
epochs = pl.Series("time", [BEGIN_MS + 10 * i for i in range(100)]).cast(pl.Datetime("ms"))
frames = {"polars, epochs in ms": epochs - epochs[0],
          "polars, moments": moments - moments[0],
          "polars, cast to ns": (moments - moments[0]).cast(pl.Duration("ns"))}
files = {}
for i, (name, time) in enumerate(frames.items()):
    frame = pl.DataFrame({"time": time})
    in_memory = duckdb.sql("SELECT time FROM frame").fetchall()[1][0]
    assert in_memory == datetime.timedelta(milliseconds=10), "the frame itself is another"
    files[name] = f"polars_{i}.parquet"
    frame.write_parquet(files[name])
texts = pd.to_datetime(pd.Series([f"2025-11-29 10:00:00.{10 * i:03d}" for i in range(100)]))
files["pandas, texts"] = "pandas.parquet"
pd.DataFrame({"time": texts - texts[0]}).to_parquet(files["pandas, texts"])
seen = {}
for name, file in files.items():
    table = duckdb.sql(f"SELECT time FROM '{file}'")
    seen[name] = (str(table.types[0]), table.fetchall()[1][0])
    back = pl.read_parquet(file)["time"][1], pd.read_parquet(file)["time"][1].to_pytimedelta()
    assert back == (datetime.timedelta(milliseconds=10),) * 2, "polars or pandas lost the unit"
    print(f"{name}: {seen[name][0]}, {seen[name][1]}; polars and pandas: {back[0]}")
assert seen == {"polars, epochs in ms": ("BIGINT", 10), "polars, moments": ("BIGINT", 10000),
                "polars, cast to ns": ("BIGINT", 10000000), "pandas, texts": ("BIGINT", 10000)}, "it has a unit"
PYTHON
