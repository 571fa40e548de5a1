//! Decodes the Cortex-M instructions that matter for an analysis of calls, floats and the stack.

/// An instruction, in the classes that the analysis of calls, floats and the stack distinguishes.
#[derive(Debug, PartialEq, Eq)]
pub enum Instruction {
    /// A call or jump with a fixed target (`BL` or `B.W`), with or without a condition. The value is the distance in bytes from the
    /// address after the instruction.
    Branch(i32),
    /// The instruction `BLX` through a register: a call whose target is not fixed.
    CallRegister,
    /// A jump whose target is not fixed: `BX` through a register other than the link register, `MOV PC`, or an `LDR` of the program
    /// counter from elsewhere than the stack.
    JumpRegister,
    /// An instruction of the float unit (coprocessors 10 and 11).
    FloatUnit,
    /// The instruction `UDF` (undefined), which the compiler puts where execution must stop.
    Trap,
    /// An instruction that masks interrupts: `CPSID`, or a write to `PRIMASK`, `BASEPRI` or `FAULTMASK`.
    Mask,
    Other,
}

/// Whether a half-word is the first of an instruction of two half-words.
pub fn is_wide(first: u32) -> bool {
    first >> 11 >= 0b11101
}

pub fn decode(first: u32, second: u32) -> Instruction {
    if !is_wide(first) {
        let register = first >> 3 & 15;
        return match first & 0xff87 {
            0x4780 => Instruction::CallRegister,
            0x4700 if register != 14 => Instruction::JumpRegister,
            // `MOV PC, register`.
            0x4687 => Instruction::JumpRegister,
            _ if first & 0xff00 == 0xde00 => Instruction::Trap,
            _ if first & 0xfffc == 0xb670 => Instruction::Mask,
            _ => Instruction::Other,
        };
    }
    // `LDR PC, [..]` with a base register other than the stack pointer.
    if first & 0xff70 == 0xf850 && second >> 12 == 15 && first & 15 != 13 {
        return Instruction::JumpRegister;
    }
    if first & 0xfff0 == 0xf380 && matches!(second & 0xffff, 0x8810..=0x8813) {
        return Instruction::Mask;
    }
    if first & 0xec00 == 0xec00 && second >> 9 & 7 == 0b101 {
        return Instruction::FloatUnit;
    }
    if first & 0xf800 == 0xf000 && second & 0x8000 != 0 {
        let sign = first >> 10 & 1;
        let low = (second & 0x7ff) << 1;
        if second & 0x1000 != 0 {
            let bit = |at: u32| !(second >> at ^ sign) & 1;
            let far = sign << 24 | bit(13) << 23 | bit(11) << 22 | (first & 0x3ff) << 12 | low;
            return Instruction::Branch(((far << 7) as i32) >> 7);
        }
        let condition = first >> 6 & 15;
        if second & 0x4000 == 0 && condition < 14 {
            let bit = |at: u32| second >> at & 1;
            let far = sign << 20 | bit(11) << 19 | bit(13) << 18 | (first & 0x3f) << 12 | low;
            return Instruction::Branch(((far << 11) as i32) >> 11);
        }
    }
    Instruction::Other
}

/// Number of bytes by which an instruction lowers the stack pointer; `None` if the number is known only at run time.
pub fn lowers(first: u32, second: u32) -> Option<u32> {
    if !is_wide(first) {
        return match first {
            // PUSH of low registers and perhaps the link register.
            _ if first & 0xfe00 == 0xb400 => Some((first & 0x1ff).count_ones() * 4),
            // SUB SP, #.
            _ if first & 0xff80 == 0xb080 => Some((first & 0x7f) * 4),
            // MOV SP, register.
            _ if first & 0xff87 == 0x4685 => None,
            _ => Some(0),
        };
    }
    let (destination, low) = (second >> 8 & 15, second & 0xff);
    let constant = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | low;
    match first {
        // PUSH.W, and STR that pushes one register.
        0xe92d => Some(second.count_ones() * 4),
        0xf84d if second & 0x0fff == 0x0d04 => Some(4),
        // STRD with write-back, downwards.
        0xe96d => Some(low * 4),
        // VPUSH.
        _ if first & 0xffbf == 0xed2d => Some(low * 4),
        // SUB.W and SUBW of a constant.
        _ if first & 0xfbef == 0xf1ad && destination == 13 => Some(modified(constant)),
        _ if first & 0xfbff == 0xf2ad && destination == 13 => Some(constant),
        // SUB.W of a register.
        _ if first & 0xffef == 0xebad && destination == 13 => None,
        _ => Some(0),
    }
}

/// Expands the 12-bit code of a constant in an instruction to the 32-bit constant (ThumbExpandImm in Arm's manual).
fn modified(bits: u32) -> u32 {
    let low = bits & 0xff;
    match bits >> 8 {
        0 => low,
        1 => low << 16 | low,
        2 => low << 24 | low << 8,
        3 => low << 24 | low << 16 | low << 8 | low,
        _ => (0x80 | bits & 0x7f).rotate_right(bits >> 7),
    }
}

/// For an instruction `MOVW` or `MOVT`: whether it loads the upper half of a register, the register, and the 16 bits. `None` for
/// others.
pub fn loads_half(first: u32, second: u32) -> Option<(bool, usize, u32)> {
    let is_top = match first & 0xfbf0 {
        0xf240 => false,
        0xf2c0 => true,
        _ => return None,
    };
    let value =
        (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff;
    Some((is_top, (second >> 8 & 15) as usize, value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_are_told_apart() {
        for (first, second, expected) in [
            // nop; bx lr; bx r3; blx r2
            (0xbf00, 0, Instruction::Other),
            (0x4770, 0, Instruction::Other),
            (0x4718, 0, Instruction::JumpRegister),
            // mov pc, r3; ldr.w pc, [r0, r1, lsl #2]; pop.w {pc} as a load; udf #254
            (0x469f, 0, Instruction::JumpRegister),
            (0xf850, 0xf021, Instruction::JumpRegister),
            (0xf85d, 0xfb04, Instruction::Other),
            (0xdefe, 0, Instruction::Trap),
            // cpsid i; msr basepri_max, r0; msr primask, r0
            (0xb672, 0, Instruction::Mask),
            (0xf380, 0x8812, Instruction::Mask),
            (0xf380, 0x8810, Instruction::Mask),
            (0x4790, 0, Instruction::CallRegister),
            // bl to itself; bl forwards by 0x1000; b.w forwards by 8
            (0xf7ff, 0xfffe, Instruction::Branch(-4)),
            (0xf001, 0xf800, Instruction::Branch(0x1000)),
            (0xf000, 0xb804, Instruction::Branch(8)),
            // beq.w backwards by 2; msr apsr_nzcvq, r0; dsb
            (0xf43f, 0xafff, Instruction::Branch(-2)),
            (0xf380, 0x8800, Instruction::Other),
            (0xf3bf, 0x8f4f, Instruction::Other),
            // vadd.f32 s0, s0, s1; vldr s0, [r0]; vmov r0, s0
            (0xee30, 0x0a20, Instruction::FloatUnit),
            (0xed90, 0x0a00, Instruction::FloatUnit),
            (0xee10, 0x0a10, Instruction::FloatUnit),
            // udiv r0, r0, r1; umull r0, r1, r2, r3
            (0xfbb0, 0xf0f1, Instruction::Other),
            (0xfba2, 0x0103, Instruction::Other),
        ] {
            assert_eq!(decode(first, second), expected, "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn what_lowers_the_stack_pointer() {
        for (first, second, expected) in [
            // push {r4, r5, r6, r7, lr}; push.w {r8-r11}; sub sp, #180; str r0, [sp, #-4]!; nop
            (0xb5f0, 0, Some(20)),
            (0xe92d, 0x0f00, Some(16)),
            (0xb0ad, 0, Some(180)),
            (0xf84d, 0x0d04, Some(4)),
            (0xbf00, 0, Some(0)),
            // sub.w sp, sp, #1024; subw sp, sp, #1284; vpush {d8}; sub.w sp, sp, r4; mov sp, r4
            (0xf5ad, 0x6d80, Some(1024)),
            (0xf2ad, 0x5d04, Some(1284)),
            (0xed2d, 0x8b02, Some(8)),
            (0xebad, 0x0d04, None),
            (0x46a5, 0, None),
            // add sp, #180; sub.w r4, sp, #8 (address of an aligned frame): neither lowers the stack pointer
            (0xb02d, 0, Some(0)),
            (0xf1ad, 0x0408, Some(0)),
        ] {
            assert_eq!(lowers(first, second), expected, "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn constants_of_instructions() {
        assert_eq!(modified(0x0ff), 0xff);
        assert_eq!(modified(0x1ab), 0x00ab_00ab);
        assert_eq!(modified(0xe80), 1024);
        // movw r1, #0x1234; movt r1, #0x0800
        assert_eq!(loads_half(0xf241, 0x2134), Some((false, 1, 0x1234)));
        assert_eq!(loads_half(0xf6c0, 0x0100), Some((true, 1, 0x0800)));
        assert_eq!(loads_half(0xbf00, 0), None);
    }
}
