#!/usr/bin/env python3
"""Draws the wiring pictures of docs/build-guide.md, one SVG beside this script for each way of building.

    docs/wiring/draw.py            writes the pictures
    docs/wiring/draw.py --check    exit code 1 if a picture is not as this script draws it

The connectors come from the guide's table "Where the pins are on a NUCLEO". A pin that the guide's table or the board's file in
firmware/src/board does not have is an error, so table, firmware and picture cannot differ.
"""
import html
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
GUIDE = HERE.parent / "build-guide.md"
BOARDS = HERE.parent.parent / "firmware/src/board"

# A picture is a list of groups: left part, right part, wires. A wire is (left end, right end). A left end that names a pin of the
# chip gets its connector from the guide.
MAGNETIC = ("NUCLEO", "AS5047P-TS_EK_AB, P1", [
    ("PC10", "5 CLK"), ("PC11", "7 MISO"), ("PC12", "6 MOSI"), ("PD2", "4 CSn"), ("3V3 CN7", "2 3V3"), ("GND CN7", "8 GND")])
INCREMENTAL = ("NUCLEO", "incremental encoder", [
    ("PA15", "A"), ("PB3", "B"), ("3V3 CN7", "supply 3.3 V"), ("GND CN7", "ground")])
DESKTOP = ("ST-LINK", "desktop", [("USB", "USB")])

WAYS = {
    "ihm16m1": ("NUCLEO with X-NUCLEO-IHM16M1", "ihm16m1.rs", [
        MAGNETIC,
        ("X-NUCLEO-IHM16M1", "motor, any order", [("CN1 3", "wire"), ("CN1 4", "wire"), ("CN1 5", "wire")]),
        ("X-NUCLEO-IHM16M1", "supply 12 V, limited", [("CN1 1, 2; or J4", "as printed")]),
        DESKTOP]),
    "simplefoc-mini": ("NUCLEO-G474RE with SimpleFOC Mini v1.1", "nucleo_g474re_simplefoc_mini.rs", [
        MAGNETIC,
        ("NUCLEO", "SimpleFOC Mini", [
            ("PA8", "IN1"), ("PA9", "IN2"), ("PA10", "IN3"), ("PB13", "EN"), ("PB12", "nFT"), ("GND CN10", "GND")]),
        ("NUCLEO", "two resistors", [("PA0", "100 kΩ to supply +"), ("PA0", "10 kΩ to GND")]),
        ("SimpleFOC Mini", "motor, any order", [("M1", "wire"), ("M2", "wire"), ("M3", "wire")]),
        ("SimpleFOC Mini", "supply 12 V, limited", [("+", "+"), ("−", "−")]),
        DESKTOP]),
    "ihm08m1": ("NUCLEO-G474RE with X-NUCLEO-IHM08M1", "nucleo_g474re.rs", [
        INCREMENTAL,
        ("NUCLEO", "amplifier, if used", [("PA4", "command 0 to 3.3 V"), ("PC8", "enable, high")]),
        ("X-NUCLEO-IHM08M1", "motor, any order", [("output terminals", "three wires")]),
        ("X-NUCLEO-IHM08M1", "supply 24 V, limited", [("supply terminals", "as printed")]),
        DESKTOP]),
    "b-g431b-esc1": ("B-G431B-ESC1", "b_g431b_esc1.rs", [
        ("B-G431B-ESC1, pads", "incremental encoder", [("A+ PB6", "A"), ("B+ PB7", "B"), ("encoder pads", "supply, ground")]),
        ("B-G431B-ESC1, pads", "motor, any order", [("output pads", "three wires")]),
        ("B-G431B-ESC1, pads", "supply 24 V, limited", [("supply pads", "as printed")]),
        DESKTOP]),
}

# The board's file names this pin by the converter whose output it is.
NAMES = {"PA4": "DAC1"}

# Sizes in px of a picture that is 400 px wide. The text is 12 px or larger.
WIDTH, EDGE, BOX, ROW, TITLE = 400, 6, 160, 22, 24
STYLE = """\
:root { color-scheme: light; --page: #fcfcfa; --panel: #fff; --text: #1d2126; --muted: #565d67; --rule: #9aa2ad; --wire: #0a5cad; }
@media (prefers-color-scheme: dark) {
  :root { color-scheme: dark; --page: #14161a; --panel: #1a1d22; --text: #e4e7eb; --muted: #a3abb5; --rule: #626973; --wire: #6fb4ff; }
}
text { font: 12px sans-serif; fill: var(--text); }
.title { font-size: 14px; font-weight: bold; }
.part { fill: var(--muted); }
.end { text-anchor: end; }
.page { fill: var(--page); }
.box { fill: var(--panel); stroke: var(--rule); }
.wire { stroke: var(--wire); stroke-width: 2; }
.dot { fill: var(--wire); }
"""


def connectors():
    """Connector and pin of each chip pin, by the guide: {"PC10": "CN7 1", "GND CN7": "CN7 20", …}."""
    found = {}
    for pin, connector in re.findall(r"^\| (P[A-F]\d+|3V3|GND) \| (CN\d+ \d+) \|", GUIDE.read_text(encoding="utf-8"), re.M):
        key = pin if pin.startswith("P") else f"{pin} {connector.split()[0]}"
        found[key] = connector
    return found


def left_text(end, places, firmware):
    """Text at the left end of a wire; an error if guide or firmware do not have its pin."""
    pin = re.search(r"\bP[A-F]\d+\b", end)
    if pin and f"p.{NAMES.get(pin[0], pin[0])}" not in firmware:
        sys.exit(f"{pin[0]}: the board's file in {BOARDS} does not use it")
    if end in places:
        return f"{places[end]} · {end.split()[0]}"
    if pin and pin[0] == end or end.startswith(("3V3", "GND")):
        sys.exit(f"{end}: {GUIDE} names no connector")
    return end


def picture(title, file, groups):
    places, firmware = connectors(), (BOARDS / file).read_text(encoding="utf-8")
    out, y = [], 34
    left, right = EDGE + BOX, WIDTH - EDGE - BOX

    def text(x, y, words, kind=""):
        kind = f' class="{kind}"' if kind else ""
        out.append(f'<text x="{x}" y="{y}"{kind}>{html.escape(words)}</text>')

    text(EDGE, 22, title, "title")
    for left_part, right_part, wires in groups:
        height = TITLE + ROW * len(wires) + 4
        for x in (EDGE, right):
            out.append(f'<rect x="{x}" y="{y}" width="{BOX}" height="{height}" rx="4" class="box"/>')
        text(EDGE + 8, y + 17, left_part, "part")
        text(right + 8, y + 17, right_part, "part")
        for row, (a, b) in enumerate(wires):
            at = y + TITLE + ROW * row + ROW // 2
            out.append(f'<path d="M{left} {at}H{right}" class="wire"/>')
            out.extend(f'<circle cx="{x}" cy="{at}" r="3" class="dot"/>' for x in (left, right))
            text(left - 10, at + 4, left_text(a, places, firmware), "end")
            text(right + 10, at + 4, b)
        y += height + 8
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y}" width="{WIDTH}" height="{y}">\n'
    page = f'<title>{html.escape("Wires of " + title)}</title>\n<style>\n{STYLE}</style>\n<rect width="{WIDTH}" height="{y}" class="page"/>\n'
    return head + page + "\n".join(out) + "\n</svg>\n"


def main():
    wrong = []
    for name, way in WAYS.items():
        file, drawn = HERE / f"{name}.svg", picture(*way)
        if "--check" not in sys.argv[1:]:
            file.write_text(drawn, encoding="utf-8")
        elif not file.is_file() or file.read_text(encoding="utf-8") != drawn:
            wrong.append(file.name)
    if wrong:
        sys.exit(f"{', '.join(wrong)}: not as drawn from {GUIDE.name}; run {Path(__file__).name}")


main()
