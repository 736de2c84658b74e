#!/bin/bash
# pandas 3.1.1, polars 2.1.0 and duckdb 2.0.1 (PyPI), with NumPy 2.4.6: a glove of 100 Hz is averaged to the frames of a camera of 30 Hz,
# by resample("33ms"), group_by_dynamic(every="33ms") and time_bucket(INTERVAL 33 MILLISECONDS).
#
# Guess: windows of all three begin at whole multiples of the width, so that each has the same samples, as for 10, 20 and 100 ms.
# Seen: they count from midnight of the recording's first day, from 1970 and from 2000-01-03. Windows of one recording of 2025-11-29 begin
# at 30, 27 and 9 ms behind 10:00, and so on. A join of two of the tables by time is empty; joined by row, samples are up to 21 ms apart.
# With a width that a day is a multiple of, all agree. pandas with origin="epoch" agrees with polars.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 pandas==3.1.1 polars==2.1.0 pyarrow==26.0.1 duckdb==2.0.1
"$folder/venv/bin/python" - <<'PYTHON'
import duckdb
import pandas as pd
import polars as pl

ZERO = pd.Timestamp("2025-11-29 10:00")


def begins(width_ms, **options):
    """Begins of the windows in ms behind 10:00, by pandas, polars and DuckDB."""
    glove = pd.DataFrame({"time": pd.date_range(ZERO + pd.Timedelta("3ms"), periods=50, freq="10ms"), "angle": range(50)})
    pandas = glove.set_index("time")["angle"].resample(f"{width_ms}ms", **options).mean()
    polars = pl.from_pandas(glove).group_by_dynamic("time", every=f"{width_ms}ms").agg(pl.col("angle").mean())
    rows = duckdb.sql(f"SELECT time_bucket(INTERVAL {width_ms} MILLISECONDS, time) t, avg(angle) FROM glove GROUP BY t ORDER BY t")
    tables = [pandas.index, polars["time"], [row[0] for row in rows.fetchall()]]
    return [[round((pd.Timestamp(time) - ZERO).total_seconds() * 1e3) for time in table] for table in tables]


for width_ms in (33, 20, 100):
    print(f"{width_ms} ms, first begins [ms]:", [table[:4] for table in begins(width_ms)])
pandas, polars, duck = begins(33)
assert (pandas[:2], polars[:2], duck[:2]) == ([-3, 30], [-6, 27], [-24, 9]), "the windows are others"
assert not set(pandas) & set(polars) and not set(pandas) & set(duck) and not set(polars) & set(duck)
assert begins(33, origin="epoch")[0] == polars, "the origin is another"
for width_ms in (20, 100):
    assert begins(width_ms)[0] == begins(width_ms)[1] == begins(width_ms)[2]
PYTHON
