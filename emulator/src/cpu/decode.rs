//! The cycles that an instruction takes, and the few instructions that the emulator's run loop must recognise.
//!
//! The cycle counts come from the Cortex-M4 technical reference manual (DDI 0439, tables 3-1 and 7-1). Each is the upper value for
//! memory without wait states. A taken branch costs [`REFILL`] cycles more.

/// Cycles to refill the pipeline after a taken branch. The manual says 1 to 3, depending on the alignment of the branch's target.
pub const REFILL: u64 = 3;
/// Cycles of an exception entry, including the stacking of registers; also the cycles of an exception return (DDI 0439, 2.3.5).
pub const EXCEPTION: u64 = 12;
/// Cycles from the end of one exception handler to the start of the next when the registers stay stacked (tail-chaining).
pub const TAIL_CHAIN: u64 = 6;

/// How the emulator's run loop must treat an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An instruction that needs no special treatment.
    Plain,
    /// Begins an IT (if-then) block.
    IfThen {
        /// Number of conditional instructions in the IT block.
        count: u8,
        /// Length of the conditional instructions of the IT block together, in bytes.
        bytes: u8,
    },
    /// Changes the interrupt masks, so the run loop checks for pending interrupts at the next instruction boundary.
    Mask,
    /// Uses the floating-point unit, so the next exception frame includes the floating-point registers.
    Float,
    /// The instruction WFE, which waits for an event.
    WaitEvent,
    /// The instruction WFI, which waits for an interrupt.
    WaitInterrupt,
    /// The instruction SEV, which sends an event.
    SendEvent,
    /// Reads the register IPSR (number of the running exception), whose value Unicorn does not hold in this emulator.
    ReadIpsr,
}

/// A decoded instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Info {
    /// Processor cycles of the instruction without the refill of the pipeline.
    pub cycles: u8,
    /// How the run loop treats the instruction.
    pub kind: Kind,
    /// Whether the instruction reads a constant from the program memory beside the code.
    pub reads_literal: bool,
}

impl Info {
    /// An instruction that takes one cycle and needs no special treatment.
    pub const SIMPLE: Self = info(1, Kind::Plain);
}

const fn info(cycles: u32, kind: Kind) -> Info {
    Info {
        cycles: cycles as u8,
        kind,
        reads_literal: false,
    }
}

/// Whether the instruction loads from an address relative to the program counter. Such instructions are the `LDR` variants, `LDRD`,
/// `VLDR` and the table branches.
#[must_use]
pub const fn reads_literal(first: u16, second: u16) -> bool {
    if !is_wide(first) {
        return first >> 11 == 0b0_1001;
    }
    let one = first & 0xfe1f == 0xf81f && second >> 12 != 15;
    let two = first & 0xfe5f == 0xe85f && first & 0x0120 != 0;
    let float = first & 0xff3f == 0xed1f && second & 0x0e00 == 0x0a00;
    let table = first == 0xe8df;
    one || two || float || table
}

/// Whether this first half-word begins a 32-bit instruction, which has a second half-word.
#[must_use]
pub const fn is_wide(first: u16) -> bool {
    first >> 11 >= 0b11101
}

/// Returns `info` with the length of its IT block computed from the half-words that follow the IT instruction. Other instructions
/// are returned unchanged.
#[must_use]
pub fn with_block(info: Info, following: &[u16]) -> Info {
    let Kind::IfThen { count, .. } = info.kind else {
        return info;
    };
    let mut halves = 0;
    for _ in 0..count {
        let first = following.get(halves).copied().unwrap_or(0);
        halves += if is_wide(first) { 2 } else { 1 };
    }
    let bytes = 2 * halves as u8;
    Info {
        kind: Kind::IfThen { count, bytes },
        ..info
    }
}

/// Decodes an instruction from its first half-word and, for a 32-bit instruction, its second half-word. For an IT instruction the
/// length of the block assumes 16-bit instructions; [`with_block`] corrects it.
#[must_use]
pub const fn decode(first: u16, second: u16) -> Info {
    if is_wide(first) {
        wide(first, second)
    } else {
        narrow(first)
    }
}

const fn narrow(op: u16) -> Info {
    match op >> 8 {
        0xbf => match op & 0xff {
            0x20 => info(1, Kind::WaitEvent),
            0x30 => info(1, Kind::WaitInterrupt),
            0x40 => info(1, Kind::SendEvent),
            hint if hint & 15 == 0 => info(1, Kind::Plain),
            // The lowest set bit of the mask marks the length of the IT block.
            mask => {
                let count = 4 - (mask & 15).trailing_zeros() as u8;
                info(
                    1,
                    Kind::IfThen {
                        count,
                        bytes: 2 * count,
                    },
                )
            }
        },
        0xb6 => info(1, Kind::Mask),
        // PUSH, POP with LR or PC.
        0xb4 | 0xb5 | 0xbc | 0xbd => info(1 + (op & 0x1ff).count_ones(), Kind::Plain),
        // STM, LDM.
        0xc0..=0xcf => info(1 + (op & 0xff).count_ones(), Kind::Plain),
        // LDR (literal) and all loads and stores with an offset.
        0x48..=0x9f => info(2, Kind::Plain),
        _ => info(1, Kind::Plain),
    }
}

const fn wide(first: u16, second: u16) -> Info {
    match first >> 9 {
        // 1110 100: LDM, STM; with bit 6 the doubles, exclusives and table branches.
        0b111_0100 => match first & 0x40 {
            0 => info(1 + second.count_ones(), Kind::Plain),
            _ => info(3, Kind::Plain),
        },
        // 1110 110, 1110 111, 1111 110 and 1111 111: coprocessors.
        0b111_0110 | 0b111_0111 | 0b111_1110 | 0b111_1111 => float(first, second),
        // 1111 100: single loads and stores.
        0b111_1100 => info(2, Kind::Plain),
        // 1111 101 1 1: SDIV, UDIV.
        0b111_1101 => match first & 0xffd0 {
            0xfb90 => info(12, Kind::Plain),
            _ => info(1, Kind::Plain),
        },
        _ => system(first, second),
    }
}

const fn float(first: u16, second: u16) -> Info {
    if second >> 9 & 7 != 0b101 {
        return info(1, Kind::Plain);
    }
    let load_or_store = first & 0x0200 == 0;
    if load_or_store {
        // VLDR and VSTR have P set and W clear; VLDM and VSTM have other values.
        let single = first & 0x0120 == 0x0100;
        let words = if single { 1 } else { (second & 0xff) as u32 };
        return info(1 + words, Kind::Float);
    }
    let divide = first & 0x00b0 == 0x0080 && second & 0x0040 == 0;
    let root = first & 0x00bf == 0x00b1 && second & 0x00c0 == 0x00c0;
    let accumulate = first & 0x00b0 == 0x0000 || first & 0x00a0 == 0x00a0 && first & 0x0010 == 0;
    info(
        if divide || root {
            14
        } else if accumulate {
            3
        } else {
            1
        },
        Kind::Float,
    )
}

const fn system(first: u16, second: u16) -> Info {
    // MSR; MRS from IPSR and from the combined registers that contain it.
    if first & 0xfff0 == 0xf380 && second & 0xff00 == 0x8800 {
        return info(2, Kind::Mask);
    }
    if first == 0xf3ef && second & 0xf000 == 0x8000 {
        let register = second & 0xff;
        let ipsr = register == 3 || (register >= 5 && register <= 7) || register == 1;
        return info(2, if ipsr { Kind::ReadIpsr } else { Kind::Plain });
    }
    // DSB, DMB, ISB.
    if first == 0xf3bf {
        return info(4, Kind::Plain);
    }
    info(1, Kind::Plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_beside_the_code_are_known() {
        for (first, second, reads) in [
            // ldr r0, [pc, #4]; ldr.w r3, [pc, #16]; ldrd r0, r1, [pc, #8]; vldr s0, [pc, #4]; tbb [pc, r0].
            (0x4801, 0, true),
            (0xf8df, 0x3010, true),
            (0xe9df, 0x0102, true),
            (0xed9f, 0x0a01, true),
            (0xe8df, 0xf000, true),
            // ldr r0, [r1, #4]; ldr.w r3, [r4, #16]; pld [pc, #4]; ldrd r0, r1, [r2, #8]; bl.
            (0x6848, 0, false),
            (0xf8d4, 0x3010, false),
            (0xf89f, 0xf004, false),
            (0xe9d2, 0x0102, false),
            (0xf000, 0xf800, false),
        ] {
            assert_eq!(
                reads_literal(first, second),
                reads,
                "{first:04x} {second:04x}"
            );
        }
    }
    #[test]
    fn instructions_of_each_class() {
        // adds r0, r0, r1; ldr r0, [r0]; ldr r0, [pc, #4]; push {r4-r7, lr}; pop {r4, pc}; it eq; itte eq; wfe; nop; cpsid i
        for (first, second, cycles, kind) in [
            (0x1840, 0, 1, Kind::Plain),
            (0x6800, 0, 2, Kind::Plain),
            (0x4801, 0, 2, Kind::Plain),
            (0xb5f0, 0, 6, Kind::Plain),
            (0xbd10, 0, 3, Kind::Plain),
            (0xbf08, 0, 1, Kind::IfThen { count: 1, bytes: 2 }),
            (0xbf06, 0, 1, Kind::IfThen { count: 3, bytes: 6 }),
            (0xbf20, 0, 1, Kind::WaitEvent),
            (0xbf00, 0, 1, Kind::Plain),
            (0xb672, 0, 1, Kind::Mask),
            // ldmia.w r0, {r1, r2, r3}; ldrd r0, r1, [r2]; udiv r0, r0, r1; smull r0, r1, r2, r3
            (0xe890, 0x000e, 4, Kind::Plain),
            (0xe9d2, 0x0100, 3, Kind::Plain),
            (0xfbb0, 0xf0f1, 12, Kind::Plain),
            (0xfb82, 0x0103, 1, Kind::Plain),
            // msr basepri, r0; mrs r0, ipsr; mrs r0, primask; isb
            (0xf380, 0x8811, 2, Kind::Mask),
            (0xf3ef, 0x8005, 2, Kind::ReadIpsr),
            (0xf3ef, 0x8010, 2, Kind::Plain),
            (0xf3bf, 0x8f6f, 4, Kind::Plain),
            // vadd.f32 s0, s0, s1; vdiv.f32 s0, s0, s1; vsqrt.f32 s0, s0; vmla.f32 s0, s1, s2; vldr s0, [r0]; vpush {s16-s19}
            (0xee30, 0x0a20, 1, Kind::Float),
            (0xee80, 0x0a20, 14, Kind::Float),
            (0xeeb1, 0x0ac0, 14, Kind::Float),
            (0xee00, 0x0a81, 3, Kind::Float),
            (0xed90, 0x0a00, 2, Kind::Float),
            (0xed2d, 0x8a04, 5, Kind::Float),
        ] {
            assert_eq!(
                decode(first, second),
                info(cycles, kind),
                "{first:04x} {second:04x}"
            );
        }
    }
}
