"""Makes the README's animation, an animated PNG: the drawn knob of the live page during one press. Standard library only.

    animate.py PROGRAM OUT.png [PRESET]
"""

import base64
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from collections import Counter

from chromium import Chromium

WIDTH, FRAME_S, PERIOD_S = 660, 0.08, 4.8
# Number of colours in the palette, and the palette index of a pixel that does not change.
COLOURS, STAYS = 255, 255

GRAB = """(() => {
  const { width, height } = stage.canvas, rgba = stage.canvas.getContext("2d").getImageData(0, 0, width, height).data;
  const paper = /#(..)(..)(..)/.exec(ink.panel).slice(1).map((x) => parseInt(x, 16));
  let out = "";
  for (let i = 0; i < rgba.length; i += 4) {
    const a = rgba[i + 3] / 255;
    for (let c = 0; c < 3; c += 1) out += String.fromCharCode(Math.round(rgba[i + c] * a + paper[c] * (1 - a)));
  }
  return [width, height, runs[0].last.time_s, btoa(out)];
})()"""


def frames(page):
    """Returns width, height and pictures (three bytes per pixel) at equal intervals over one period of the scene's hand motion."""
    page.until(f"(runs[0].last.time_s % {PERIOD_S}) < 0.1")
    start = page.run("runs[0].last.time_s")
    taken = []
    while len(taken) * FRAME_S < PERIOD_S - FRAME_S / 2:
        page.until(f"runs[0].last.time_s >= {start + len(taken) * FRAME_S}")
        page.run("stage.draw(runs, runs[0].last.rest_rad)")
        width, height, _, data = page.run(GRAB)
        taken.append(base64.b64decode(data))
    return width, height, taken


def indexed(taken):
    """Returns the palette, and the frames as indices into it. A rare colour is replaced by the nearest frequent one."""
    split = [[frame[i:i + 3] for i in range(0, len(frame), 3)] for frame in taken]
    counts = Counter(colour for frame in split for colour in frame)
    frequent = [colour for colour, _ in counts.most_common(COLOURS)]
    index = {colour: i for i, colour in enumerate(frequent)}
    for colour in counts:
        if colour not in index:
            index[colour] = min(range(len(frequent)), key=lambda i: sum((a - b) ** 2 for a, b in zip(colour, frequent[i])))
    return b"".join(frequent).ljust(3 * 256, b"\0"), [bytes(index[colour] for colour in frame) for frame in split]


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def packed(width, height, pixels):
    """The pixels as compressed rows of a PNG file, each row without a filter."""
    return zlib.compress(b"".join(b"\0" + pixels[y * width:(y + 1) * width] for y in range(height)), 9)


def changed(width, height, before, now):
    """Returns the rectangle in which a frame differs from the one before it, and the rectangle's pixels."""
    rows = [y for y in range(height) if before[y * width:(y + 1) * width] != now[y * width:(y + 1) * width]]
    if not rows:
        return 0, 0, 1, 1, bytes([STAYS])
    top, bottom = rows[0], rows[-1] + 1
    columns = [x for x in range(width) if any(before[y * width + x] != now[y * width + x] for y in rows)]
    left, right = columns[0], columns[-1] + 1
    pixels = bytes(STAYS if before[y * width + x] == now[y * width + x] else now[y * width + x] for y in range(top, bottom) for x in range(left, right))
    return left, top, right - left, bottom - top, pixels


def animation(width, height, taken):
    """The bytes of an animated PNG that repeats without end."""
    palette, taken = indexed(taken)
    parts = [b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)), chunk(b"acTL", struct.pack(">II", len(taken), 0)),
             chunk(b"PLTE", palette), chunk(b"tRNS", b"\xff" * STAYS + b"\0")]
    number = 0
    for i, now in enumerate(taken):
        left, top, w, h, pixels = (0, 0, width, height, now) if i == 0 else changed(width, height, taken[i - 1], now)
        # The last two numbers: this frame stays when the next frame comes (dispose 0), and is drawn over the frame before it
        # (blend 1).
        parts.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, w, h, left, top, round(FRAME_S * 1000), 1000, 0, 1)))
        number += 1
        data = packed(w, h, pixels)
        if i == 0:
            parts.append(chunk(b"IDAT", data))
        else:
            parts.append(chunk(b"fdAT", struct.pack(">I", number) + data))
            number += 1
    return b"".join(parts + [chunk(b"IEND", b"")])


def main():
    program, out, preset = os.path.abspath(sys.argv[1]), sys.argv[2], (sys.argv[3:] or ["6"])[0]
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "page.html")
        subprocess.run([program, "--quiet", "live", "--no-open", "--out", file], check=True)
        page = Chromium(f"file://{file}", width=WIDTH + 60)
        try:
            page.until("typeof runs !== 'undefined' && runs.length > 0 && !pending && runs[0].ring.size > 20")
            page.run("stage.canvas.style.height = '230px'")
            page.key(preset)
            page.wait(0.5)
            # Taking pictures takes time: the simulation runs at a quarter of its speed, and the animation shows it at full speed.
            page.run("chosen.speed = 0.25; run(true)")
            page.wait(PERIOD_S)
            width, height, taken = frames(page)
        finally:
            page.close()
    data = animation(width, height, taken)
    with open(out, "wb") as file:
        file.write(data)
    print(f"{out}: {len(taken)} frames of {width} by {height}, {len(data)} bytes")


if __name__ == "__main__":
    main()
