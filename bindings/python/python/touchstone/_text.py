"""Converts Python values to the text form of settings: exact decimals, words, true and false."""

from decimal import Decimal


def text(value: object) -> str:
    """Converts a setting's value to text. A float becomes its shortest decimal number without an exponent, which scenes and firmware can read."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return str(value)
    if isinstance(value, float) or hasattr(value, "__float__"):
        return format(Decimal(repr(float(value))), "f")
    raise TypeError(f"{value!r}: give a number, a word, True or False")
