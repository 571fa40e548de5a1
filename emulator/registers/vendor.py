#!/usr/bin/env python3
"""Writes vendor.tsv: where the vendor says that the registers, fields and pins' functions of registers.tsv and pins.tsv are.

    vendor.py stm32g474xx.h GPIO-STM32G47x_gpio_v1_0_Modes.xml stm32g431xx.h GPIO-STM32G43x_gpio_v1_0_Modes.xml

Headers: STMicroelectronics' cmsis-device-g4. Pins: its STM32_open_pin_data, mcu/IP. Neither is part of this repository.
"""

import re
import sys
import xml.etree.ElementTree as tree
from pathlib import Path

HERE = Path(__file__).parent
# Each with its chip: the first or the second header and list of pins.
BOARDS = {"nucleo-g474re": 0, "nucleo-g474re-ihm16m1": 0, "nucleo-g474re-simplefoc-mini": 0, "nucleo-g431rb-ihm16m1": 1,
          "b-g431b-esc1": 1}


def rows(name):
    lines = (HERE / name).read_text().splitlines()
    return [line.split("\t") for line in lines if not line.startswith("#")]


def number(text):
    return int(text.strip().rstrip("UL"), 0)


class Header:
    """Addresses of registers and masks of fields, from a device header."""

    def __init__(self, path):
        self.text = Path(path).read_text()
        self.bases = dict(re.findall(r"#define\s+(\w+_BASE)\s+\(?([^()/\n]+)\)?", self.text))
        self.structures = {name: self.structure(body) for body, name in re.findall(
            r"typedef struct\s*\{([^}]*)\}\s*(\w+)_TypeDef;", self.text)}
        self.instances = {name: (kind, base) for name, kind, base in re.findall(
            r"#define\s+(\w+)\s+\(\((\w+)_TypeDef \*\)\s*(\w+_BASE)\)", self.text)}
        places = dict(re.findall(r"#define\s+(\w+)_Pos\s+\((\d+)U\)", self.text))
        self.masks = {name: number(mask) << int(places[place]) for name, mask, place in re.findall(
            r"#define\s+(\w+)_Msk\s+\((0x[0-9A-Fa-f]+)U?L?\s*<<\s*(\w+)_Pos\)", self.text) if place in places}

    @staticmethod
    def structure(body):
        offset, registers = 0, {}
        for bits, name, count in re.findall(r"uint(32|16|8)_t\s+(\w+)(?:\[(\d+)U?\])?;", body):
            size = int(bits) // 8
            offset += -offset % size
            registers[name] = offset
            offset += size * int(count or 1)
        return registers

    def base(self, name):
        return sum(self.base(term.strip()) if term.strip() in self.bases else number(term)
                   for term in self.bases[name].split("+"))

    def address(self, register):
        instance, name = register.rsplit("_", 1)
        kind, base = self.instances[instance]
        return self.base(base) + self.structures[kind][name]

    def mask(self, register, field):
        instance, name = register.rsplit("_", 1)
        kind = self.instances[instance][0].removesuffix("_Common")
        found = [self.masks[full] for full in (f"{instance}_{name}_{field}", f"{kind}_{name}_{field}") if full in self.masks]
        if not found:
            sys.exit(f"{register}: the header knows no field {field}")
        return found[0]


def functions(path):
    """(pin, signal) to its alternate function's number."""
    found = {}
    for pin in tree.parse(path).iter():
        if not pin.tag.endswith("GPIO_Pin"):
            continue
        for signal in pin:
            for value in signal.iter():
                match = re.match(r"GPIO_AF(\d+)_", value.text or "")
                if match:
                    name = pin.get("Name").split("-")[0]
                    found[name, signal.get("Name")] = match[1]
    return found


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    lines = []
    chips = [(Header(header), functions(pins)) for header, pins in zip(sys.argv[1::2], sys.argv[2::2])]
    for board, chip in BOARDS.items():
        described, numbers = chips[chip]
        for on, register, fields, _ in rows("registers.tsv"):
            if on != "all" and board not in on.split():
                continue
            lines.append((board, register, "", f"{described.address(register):#010x}"))
            for field in fields.split():
                name = field.split("=")[0]
                if "=" in field and name:
                    lines.append((board, register, name, f"{described.mask(register, name):#x}"))
        for on, pin, signal, mode, *_ in rows("pins.tsv"):
            if board in on.split() and mode == "function":
                lines.append((board, pin, signal, numbers[pin, signal]))
    (HERE / "vendor.tsv").write_text("".join("\t".join(line) + "\n" for line in lines))


main()
