"""Reads CSV files as pandas, Polars, DuckDB, R and LibreOffice do without a word from anybody, and compares types and values with Python's own reading of
every cell. Prints a line for each file and reader; ends with 1 where one differs, with 9 where no reader is installed."""

import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile


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


# Columns with whole numbers in every row. Every other column of numbers has decimal numbers.
COUNTS = {"tick", "looks", "tick_low_16_bits", "cell", "count", "cycles", "lateness_cycles", "limits_bits", "timing.rate_hz"}


def without_point(path):
    """Columns of decimals in which some row has none: a reader that sees this row first takes the column for integers."""
    header, rows = cells(path)
    for at, name in enumerate(header):
        column = [row[at] for row in rows]
        if name in COUNTS or any(number(cell) is None for cell in column):
            continue
        bare = [row for row, cell in enumerate(column) if cell.lstrip("-").isdigit()]
        if bare:
            yield f"{name} has no decimal in {len(bare)} of {len(rows)} rows, first {bare[:1]}"


def pandas_reads(path):
    import pandas

    # From version 3 on, pandas reads exactly by default, and warns about this option.
    EXACT = {} if int(pandas.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
    table = pandas.read_csv(path, comment="#", **EXACT)
    return {name: (table[name].dtype.kind == "f", table[name].tolist()) for name in table}


def polars_reads(path):
    import polars

    table = polars.read_csv(path, comment_prefix="#")
    return {name: (table[name].dtype == polars.Float64, table[name].to_list()) for name in table.columns}


def duckdb_reads(path):
    import duckdb

    # DuckDB keeps the file's order of rows also with several threads, and detects comment lines itself.
    table = duckdb.sql(f"select * from read_csv('{path}')")
    rows = table.fetchall()
    kinds = [str(kind) for kind in table.types]
    return {name: (kinds[at] == "DOUBLE", [row[at] for row in rows]) for at, name in enumerate(table.columns)}


R_SCRIPT = r"""
t <- read.csv(commandArgs(TRUE)[1], comment.char = "#", check.names = FALSE)
cat(paste(names(t), sapply(t, function(x) class(x)[1]), sep = "\t"), sep = "\n")
cat("\n--\n")
shown <- lapply(t, function(x) if (is.double(x)) sprintf("%a", x) else as.character(x))
write.table(as.data.frame(shown), sep = "\t", quote = FALSE, row.names = FALSE, col.names = FALSE)
"""


def r_reads(path):
    with tempfile.NamedTemporaryFile("w", suffix=".R") as script:
        script.write(R_SCRIPT)
        script.flush()
        ran = subprocess.run(["Rscript", script.name, path], capture_output=True, text=True, check=True)
    head, rows = ran.stdout.split("\n--\n")
    kinds = [line.split("\t") for line in head.splitlines()]
    rows = [row.split("\t") for row in rows.splitlines()]

    def value(cell):
        if cell in ("NA", "NaN"):
            return None
        try:
            return float.fromhex(cell) if "p" in cell and "0x" in cell else float(cell)
        except ValueError:
            return cell

    return {name: (kind == "numeric", [value(row[at]) for row in rows]) for at, (name, kind) in enumerate(kinds)}


def calc_reads(path):
    # LibreOffice converts the table to its flat XML file (fods). There a cell is a text or a number, and a number has more digits
    # than LibreOffice displays.
    import xml.etree.ElementTree as tree

    with tempfile.TemporaryDirectory() as folder:
        place = os.path.join(folder, "table.csv")
        shutil.copy(path, place)
        # Options of the CSV import: separator comma, double quotes, UTF-8, from line 1, English (United States), numbers are
        # detected.
        rule = "--infilter=CSV:44,34,76,1,,1033,false,true,false"
        profile = f"-env:UserInstallation=file://{folder}/profile"
        subprocess.run(
            ["soffice", profile, "--headless", rule, "--convert-to", "fods", "--outdir", folder, place],
            capture_output=True,
            check=True,
        )
        table = tree.parse(os.path.join(folder, "table.fods")).getroot()
    office, of_table = "{urn:oasis:names:tc:opendocument:xmlns:office:1.0}", "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
    rows = []
    for row in table.iter(f"{of_table}table-row"):
        cells = []
        for cell in row.iter(f"{of_table}table-cell"):
            kind, text = cell.get(f"{office}value-type"), "".join(cell.itertext()).strip()
            value = float(cell.get(f"{office}value")) if kind in ("float", "percentage", "currency") else text or None
            cells += [value] * min(int(cell.get(f"{of_table}number-columns-repeated", 1)), 64)
        rows += [cells] * (int(row.get(f"{of_table}number-rows-repeated", 1)) if any(cell is not None for cell in cells) else 1)
    rows = [row for row in rows if any(cell is not None for cell in row)]
    start = next(at for at, row in enumerate(rows) if not str(row[0]).startswith("#"))
    head, rows = [name for name in rows[start] if name is not None], rows[start + 1 :]
    column = lambda at: [row[at] if at < len(row) else None for row in rows]
    # A spreadsheet has one kind of number, and writes `NaN` as text.
    number = lambda cell: None if isinstance(cell, str) and cell.lower() == "nan" else cell
    return {name: (True, [number(cell) for cell in column(at)]) for at, name in enumerate(head)}


# Largest file that LibreOffice reads here, bytes. A larger file would take minutes and test nothing more, because LibreOffice
# infers no type of a column.
MOST_IN_CALC = 4_000_000


def same(a, b):
    if b is None:
        return math.isnan(a)
    if isinstance(b, str):
        return False
    b = float(b)
    return a == b or (math.isnan(a) and math.isnan(b))


def same_in_r(a, b):
    """R's reader adds digits in a longer format and rounds once more: now and then the neighbour."""
    return same(a, b) or isinstance(b, float) and math.nextafter(a, b) == b


def same_in_calc(a, b):
    """A spreadsheet's file has fifteen digits, the last one of two, and twenty decimals."""
    return same(a, b) or isinstance(b, float) and abs(a - b) <= max(1e-14 * abs(a), 1e-20)


def differences(path, read, same=same):
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
            readers.append((name, read, same))
        except ImportError:
            print(f"skipped: {name} is not installed; pip install {name}")
    programs = [
        ("R", "Rscript", "r-base-core", r_reads, same_in_r),
        ("LibreOffice", "soffice", "libreoffice-calc-nogui", calc_reads, same_in_calc),
    ]
    for name, program, package, read, close in programs:
        if shutil.which(program):
            readers.append((name, read, close))
        else:
            print(f"skipped: {name} is not installed; apt-get install {package}")
    for path in paths:
        bare = list(without_point(path))
        print(f"{path}: decimals: {'; '.join(bare) or 'in every row'}")
        wrong += bool(bare)
    if not readers:
        return 1 if wrong else 9
    verdicts = {}
    for path in paths:
        for name, read, close in readers:
            if name == "LibreOffice" and os.path.getsize(path) > MOST_IN_CALC:
                verdicts[path, name] = "not tried"
                continue
            try:
                found = list(differences(path, read, close))
            except Exception as error:  # A reader that refuses a file is a finding, whatever it raises.
                found = [f"{type(error).__name__}: {error}".splitlines()[0]]
            print(f"{path}: {name}: {'; '.join(found) or 'as written'}")
            wrong += bool(found)
            verdicts[path, name] = "differs" if found else "as written"
    names = [name for name, *_ in readers]
    print("\n" + " " * 42 + "".join(f"{name:<13}" for name in names))
    for path in paths:
        print(f"{path[:40]:<42}" + "".join(f"{verdicts[path, name]:<13}" for name in names))
    return int(wrong > 0)


sys.exit(main(sys.argv[1:]))
