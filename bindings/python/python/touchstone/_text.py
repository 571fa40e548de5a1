"""Values of Python as settings have them: exact decimals, words, true and false."""

from decimal import Decimal


def text(value: object) -> str:
    """A setting's text. A float is its shortest decimal, without an exponent, as scenes and firmware read it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return str(value)
    if isinstance(value, float) or hasattr(value, "__float__"):
        return format(Decimal(repr(float(value))), "f")
    raise TypeError(f"{value!r}: give a number, a word, True or False")
