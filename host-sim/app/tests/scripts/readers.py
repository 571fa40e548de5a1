"""Reads CSV files as pandas, Polars and DuckDB do without a word from anybody, and compares types and values with Python's own reading of
every cell. Prints a line for each file and reader; ends with 1 where one differs, with 9 where no reader is installed."""

import csv
import math
import sys


def cells(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(line for line in file if not line.startswith("#"))]
    return rows[0], rows[1:]


def number(cell):
    try:
        return math.nan if cell == "" else float(cell)
    except ValueError:
        return None


def columns(path):
    """Name, and values where every cell is a number or empty; else None."""
    header, rows = cells(path)
    found = {}
    for index, name in enumerate(header):
        values = [number(row[index]) for row in rows]
        found[name] = None if None in values else values
    decimal = {name: any("." in row[index] for row in rows) for index, name in enumerate(header)}
    return found, decimal


def pandas_reads(path):
    import pandas

    table = pandas.read_csv(path, comment="#", float_precision="round_trip")
    return {name: (table[name].dtype.kind == "f", table[name].tolist()) for name in table}


def polars_reads(path):
    import polars

    table = polars.read_csv(path, comment_prefix="#")
    return {name: (table[name].dtype == polars.Float64, table[name].to_list()) for name in table.columns}


def duckdb_reads(path):
    import duckdb

    # The many-threaded reader gives rows in the file's order; comments are recognised by themselves.
    table = duckdb.sql(f"select * from read_csv('{path}')")
    rows = table.fetchall()
    kinds = [str(kind) for kind in table.types]
    return {name: (kinds[at] == "DOUBLE", [row[at] for row in rows]) for at, name in enumerate(table.columns)}


def same(a, b):
    if b is None:
        return math.isnan(a)
    b = float(b)
    return a == b or (math.isnan(a) and math.isnan(b))


def differences(path, read):
    expected, decimal = columns(path)
    found = read(path)
    if list(found) != list(expected):
        yield f"columns {list(found)}"
    for name, values in expected.items():
        is_float, came = found.get(name, (False, []))
        if values is None:
            continue
        if decimal[name] and not is_float:
            yield f"{name} is no column of decimals"
        wrong = [at for at, pair in enumerate(zip(values, came)) if not same(*pair)]
        if len(came) != len(values) or wrong:
            yield f"{name} differs in {len(wrong)} of {len(values)} rows, {len(came)} read, first {wrong[:1]}"


def main(paths):
    readers, wrong = [], 0
    for name, read in [("pandas", pandas_reads), ("polars", polars_reads), ("duckdb", duckdb_reads)]:
        try:
            __import__(name)
            readers.append((name, read))
        except ImportError:
            print(f"skipped: {name} is not installed; pip install {name}")
    if not readers:
        return 9
    for path in paths:
        for name, read in readers:
            try:
                found = list(differences(path, read))
            except Exception as error:  # A reader that refuses a file is a finding, whatever it raises.
                found = [f"{type(error).__name__}: {error}".splitlines()[0]]
            print(f"{path}: {name}: {'; '.join(found) or 'as written'}")
            wrong += bool(found)
    return int(wrong > 0)


sys.exit(main(sys.argv[1:]))
