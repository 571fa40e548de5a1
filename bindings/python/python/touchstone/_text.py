"""Python values as the text of settings: exact decimals, words, true and false."""

from decimal import Decimal


def text(value: object) -> str:
    """The text of a setting's value. A float becomes its shortest decimal without an exponent, which scenes and firmware read."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return str(value)
    if isinstance(value, float) or hasattr(value, "__float__"):
        return format(Decimal(repr(float(value))), "f")
    raise TypeError(f"{value!r}: give a number, a word, True or False")
