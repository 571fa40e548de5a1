"""Converts Python values to the text form of settings: exact decimals, words, true and false."""

import operator
from decimal import Decimal
from typing import SupportsIndex


def number(value: object) -> object:
    """Converts a number of another library, such as numpy, to Python's: a whole number stays whole, a truth value stays one. Others stay as they are."""
    if isinstance(value, (bool, int, float, str)):
        return value
    item = getattr(value, "item", None)
    if callable(item) and getattr(value, "ndim", 0) == 0:
        return item()
    return operator.index(value) if isinstance(value, SupportsIndex) else value


def text(value: object) -> str:
    """Converts a setting's value to text. A float becomes its shortest decimal number without an exponent, which scenes and firmware can read."""
    value = number(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return str(value)
    if isinstance(value, float) or hasattr(value, "__float__"):
        return format(Decimal(repr(float(value))), "f")
    raise TypeError(f"{value!r}: give a number, a word, True or False")
