"""Wrong changes of a function's machine code, by rule: each must be refuted, and what refutes it must be wrong in Unicorn as well."""

NOP, WIDE_NOP = 0xbf00.to_bytes(2, "little"), bytes.fromhex("aff30080")
#: Largest number of changes of one kind in a function.
OF_A_KIND = 3
#: Instructions that a change may remove. The list has no plain stores, which also save registers to the stack: without such a
#: store the checker would stop with an error when the word is loaded.
LEFT_OUT = ("smlal", "umlal", "mla", "strd", "strb")


def other_condition(insn, name):
    """The opposite condition."""
    code = bytearray(insn.bytes)
    if name == "b" and insn.cc not in (0, 15):
        if insn.size == 2:
            code[1] ^= 1
        else:
            code[0] ^= 0x40
        return "condition", bytes(code)
    if name == "it":
        code[0] ^= 0x10
        return "condition", bytes(code)
    return None


def left_out(insn, name):
    return ("left out", NOP if insn.size == 2 else WIDE_NOP) if name in LEFT_OUT else None


def other_word(insn, name):
    """The word before the one that is loaded; of a structure's first, the next."""
    if name == "ldr" and insn.size == 2 and insn.bytes[1] & 0xf8 == 0x68:
        code = int.from_bytes(insn.bytes, "little")
        code += -(1 << 6) if code & 0x7c0 else 1 << 6
        return "other word", code.to_bytes(2, "little")
    return None


def other_shift(insn, name):
    """One digit more or less."""
    if name in ("lsl", "lsr", "asr") and insn.size == 2 and insn.bytes[1] & 0xe0 == 0 and len(insn.operands) == 3:
        code = int.from_bytes(insn.bytes, "little") ^ (1 << 6)
        return "shift", code.to_bytes(2, "little")
    return None


def other_sum(insn, name):
    """A saturating difference in the place of a sum, and the other way."""
    if name in ("qadd", "qsub"):
        code = bytearray(insn.bytes)
        code[2] ^= 0x20
        return "sum or difference", bytes(code)
    return None


RULES = (other_condition, left_out, other_word, other_shift, other_sum)


def changes(tick, decoder):
    """Where, what was there, the rule's word and the other bytes: spread over the function."""
    found, at = {}, tick.at
    while at < tick.at + tick.length:
        try:
            insn, name = decoder[at]
        except Exception:
            # Bytes that are no instruction are a table, which no path reaches as code.
            at += 2
            continue
        for rule in RULES:
            change = rule(insn, name)
            if change:
                found.setdefault(change[0], []).append((at, f"{insn.mnemonic} {insn.op_str}", *change))
        at += insn.size
    for of_kind in found.values():
        step = max(1, len(of_kind) // OF_A_KIND)
        yield from of_kind[::step][:OF_A_KIND]
