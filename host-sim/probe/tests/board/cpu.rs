//! A simulated processor with the Thumb instructions of the Armv7-M manual (DDI 0403) that a flash algorithm (the code that
//! programs the flash) uses. Chapter A7 of the manual describes the instructions, A5 their encoding. Any other instruction stops
//! the processor with a message.

use crate::memory::Memory;

/// Why the simulated processor stopped.
#[derive(Debug, PartialEq, Eq)]
pub enum Stop {
    /// The processor executed the breakpoint instruction BKPT.
    Breakpoint,
    /// A fault for which the program has no handler (it would lock up a real processor). Holds the message.
    Fault(String),
}

/// The registers of the simulated processor.
#[derive(Debug, Default)]
pub struct Cpu {
    /// General registers R0 to R12, stack pointer, link register, and the address of the next instruction.
    pub r: [u32; 16],
    /// The status register XPSR: flags and Thumb bit.
    pub xpsr: u32,
}

const NEGATIVE: u32 = 1 << 31;
const ZERO: u32 = 1 << 30;
const CARRY: u32 = 1 << 29;
const OVERFLOW: u32 = 1 << 28;

const SP: usize = 13;
const LR: usize = 14;
const PC: usize = 15;

fn field(code: u32, low: u32, width: u32) -> u32 {
    (code >> low) & ((1 << width) - 1)
}

fn register(code: u32, low: u32) -> usize {
    field(code, low, 3) as usize
}

/// Sign-extends a number of `bits` bits to 32 bits.
fn signed(value: u32, bits: u32) -> u32 {
    (((value << (32 - bits)) as i32) >> (32 - bits)) as u32
}

impl Cpu {
    /// Executes the instruction at the program counter.
    pub fn step(&mut self, memory: &mut Memory) -> Result<(), Stop> {
        let at = self.r[PC];
        let first = fetch(memory, at)?;
        if first >> 11 < 0b11101 {
            self.r[PC] = at + 2;
            return self.narrow(first, at, memory);
        }
        let second = fetch(memory, at + 2)?;
        self.r[PC] = at + 4;
        self.wide(first, second, at)
    }

    fn flag(&self, flag: u32) -> bool {
        self.xpsr & flag != 0
    }

    fn set(&mut self, flag: u32, to: bool) {
        self.xpsr = self.xpsr & !flag | if to { flag } else { 0 };
    }

    fn sign_and_zero(&mut self, result: u32) -> u32 {
        self.set(NEGATIVE, result >> 31 == 1);
        self.set(ZERO, result == 0);
        result
    }

    /// The function `AddWithCarry` of the Armv7-M manual: adds two values and a carry, sets all flags.
    fn add(&mut self, a: u32, b: u32, carry: bool) -> u32 {
        let whole = u64::from(a) + u64::from(b) + u64::from(carry);
        let result = whole as u32;
        self.set(CARRY, whole >> 32 == 1);
        self.set(OVERFLOW, (!(a ^ b) & (a ^ result)) >> 31 == 1);
        self.sign_and_zero(result)
    }

    fn subtract(&mut self, a: u32, b: u32) -> u32 {
        self.add(a, !b, true)
    }

    /// The function `Shift_C` of the Armv7-M manual: shifts a value by a fixed number of bits and sets the flags. `kind`: 0 LSL, 1
    /// LSR, 2 ASR.
    fn shift(&mut self, kind: u32, value: u32, by: u32) -> u32 {
        let (result, carry) = match (kind, by) {
            (0, 0) => return value,
            (0, _) => (value << by, value >> (32 - by) & 1),
            (1, 0) => (0, value >> 31),
            (1, _) => (value >> by, value >> (by - 1) & 1),
            (_, 0) => (((value as i32) >> 31) as u32, value >> 31),
            (_, _) => (((value as i32) >> by) as u32, value >> (by - 1) & 1),
        };
        self.set(CARRY, carry == 1);
        result
    }

    /// Value of a register as operand of the instruction at address `at`. The program counter reads as `at + 4`.
    fn operand(&self, register: usize, at: u32) -> u32 {
        match register {
            PC => at + 4,
            _ => self.r[register],
        }
    }

    /// The function `BXWritePC` of the Armv7-M manual: jumps to an address. Only Thumb code is supported.
    fn jump(&mut self, to: u32) -> Result<(), Stop> {
        self.r[PC] = to & !1;
        match to & 1 {
            1 => Ok(()),
            _ => Err(Stop::Fault(format!("a jump to {to:#010x} leaves Thumb"))),
        }
    }

    fn holds(&self, condition: u32) -> bool {
        let (n, z) = (self.flag(NEGATIVE), self.flag(ZERO));
        let (c, v) = (self.flag(CARRY), self.flag(OVERFLOW));
        let held = match condition >> 1 {
            0 => z,
            1 => c,
            2 => n,
            3 => v,
            4 => c && !z,
            5 => n == v,
            _ => n == v && !z,
        };
        held != (condition & 1 == 1)
    }

    fn narrow(&mut self, code: u32, at: u32, memory: &mut Memory) -> Result<(), Stop> {
        let (rd, rn, rm) = (register(code, 0), register(code, 3), register(code, 6));
        let (imm8, rd8) = (field(code, 0, 8), register(code, 8));
        match code >> 11 {
            kind @ 0..=2 => {
                let result = self.shift(kind, self.r[rn], field(code, 6, 5));
                self.r[rd] = self.sign_and_zero(result);
            }
            3 => {
                let other = match code >> 10 & 1 {
                    0 => self.r[rm],
                    _ => field(code, 6, 3),
                };
                self.r[rd] = match code >> 9 & 1 {
                    0 => self.add(self.r[rn], other, false),
                    _ => self.subtract(self.r[rn], other),
                };
            }
            4 => self.r[rd8] = self.sign_and_zero(imm8),
            5 => drop(self.subtract(self.r[rd8], imm8)),
            6 => self.r[rd8] = self.add(self.r[rd8], imm8, false),
            7 => self.r[rd8] = self.subtract(self.r[rd8], imm8),
            8 if code >> 10 & 1 == 0 => return self.logic(code, at),
            8 => return self.high(code, at),
            9 => self.r[rd8] = load(memory, ((at + 4) & !3) + imm8 * 4, 4)?,
            12..=15 => {
                let (store_it, bytes) = (code >> 11 & 1 == 0, [4, 1][(code >> 12 & 1) as usize]);
                let address = self.r[rn] + field(code, 6, 5) * bytes;
                self.access(memory, store_it, rd, address, bytes)?;
            }
            kind @ (16 | 17) => {
                let address = self.r[rn] + field(code, 6, 5) * 2;
                self.access(memory, kind == 16, rd, address, 2)?;
            }
            kind @ (18 | 19) => {
                self.access(memory, kind == 18, rd8, self.r[SP] + imm8 * 4, 4)?;
            }
            22 | 23 => return self.miscellaneous(code, memory),
            26 | 27 if code >> 8 & 0xf < 14 => {
                if self.holds(code >> 8 & 0xf) {
                    self.r[PC] = (at + 4).wrapping_add(signed(imm8 << 1, 9));
                }
            }
            28 => self.r[PC] = (at + 4).wrapping_add(signed(field(code, 0, 11) << 1, 12)),
            _ => return Err(unknown(code, at)),
        }
        Ok(())
    }

    fn access(
        &mut self,
        memory: &mut Memory,
        store_it: bool,
        register: usize,
        address: u32,
        bytes: u32,
    ) -> Result<(), Stop> {
        if store_it {
            return store(memory, address, bytes, self.r[register]);
        }
        self.r[register] = load(memory, address, bytes)?;
        Ok(())
    }

    /// Executes the 16-bit data processing instructions on two of the registers R0 to R7.
    fn logic(&mut self, code: u32, at: u32) -> Result<(), Stop> {
        let (rd, rm) = (register(code, 0), register(code, 3));
        let (a, b) = (self.r[rd], self.r[rm]);
        let result = match code >> 6 & 0xf {
            0 => a & b,
            1 => a ^ b,
            8 => {
                self.sign_and_zero(a & b);
                return Ok(());
            }
            10 => {
                self.subtract(a, b);
                return Ok(());
            }
            12 => a | b,
            13 => a.wrapping_mul(b),
            14 => a & !b,
            15 => !b,
            _ => return Err(unknown(code, at)),
        };
        self.r[rd] = self.sign_and_zero(result);
        Ok(())
    }

    /// Executes the 16-bit instructions ADD, CMP and MOV on all registers, and the jumps BX and BLX.
    fn high(&mut self, code: u32, at: u32) -> Result<(), Stop> {
        let rd = (field(code, 0, 3) | code >> 4 & 8) as usize;
        let rm = field(code, 3, 4) as usize;
        let other = self.operand(rm, at);
        match code >> 8 & 3 {
            0 => self.r[rd] = self.operand(rd, at).wrapping_add(other),
            1 => drop(self.subtract(self.r[rd], other)),
            2 => self.r[rd] = other,
            _ => {
                if code >> 7 & 1 == 1 {
                    self.r[LR] = (at + 2) | 1;
                }
                return self.jump(other);
            }
        }
        if rd == PC {
            self.r[PC] &= !1;
        }
        Ok(())
    }

    /// Executes the 16-bit instructions for the stack (PUSH, POP and others), hints such as NOP, and the breakpoint BKPT.
    fn miscellaneous(&mut self, code: u32, memory: &mut Memory) -> Result<(), Stop> {
        let at = self.r[PC] - 2;
        let listed = (0..8).filter(|register| code >> register & 1 == 1);
        match code >> 8 & 0xf {
            0 => {
                let by = field(code, 0, 7) * 4;
                match code >> 7 & 1 {
                    0 => self.r[SP] += by,
                    _ => self.r[SP] -= by,
                }
            }
            4 | 5 => {
                let all: Vec<usize> = listed.chain((code >> 8 & 1 == 1).then_some(LR)).collect();
                self.r[SP] -= 4 * all.len() as u32;
                for (place, register) in all.into_iter().enumerate() {
                    store(memory, self.r[SP] + 4 * place as u32, 4, self.r[register])?;
                }
            }
            12 | 13 => {
                let mut address = self.r[SP];
                for register in listed {
                    self.r[register] = load(memory, address, 4)?;
                    address += 4;
                }
                if code >> 8 & 1 == 1 {
                    let to = load(memory, address, 4)?;
                    self.r[SP] = address + 4;
                    return self.jump(to);
                }
                self.r[SP] = address;
            }
            14 => {
                // The processor halts at the breakpoint instruction, not behind it.
                self.r[PC] = at;
                return Err(Stop::Breakpoint);
            }
            15 if code & 0xf == 0 => {}
            _ => return Err(unknown(code, at)),
        }
        Ok(())
    }

    fn wide(&mut self, first: u32, second: u32, at: u32) -> Result<(), Stop> {
        let code = first << 16 | second;
        let (rn, rd) = (field(first, 0, 4) as usize, field(second, 8, 4) as usize);
        let imm12 = field(first, 10, 1) << 11 | field(second, 12, 3) << 8 | field(second, 0, 8);
        if first & 0xf800 == 0xf000 && second & 0x8000 != 0 {
            return self.branch(first, second, at);
        }
        if first & 0xfa00 == 0xf000 {
            let immediate = self.expanded(imm12, field(first, 4, 1) == 1);
            return self.processed(first, rd, self.operand(rn, at), rn, immediate, code, at);
        }
        if first & 0xfe00 == 0xea00 {
            let by = field(second, 12, 3) << 2 | field(second, 6, 2);
            let (kind, carry) = (field(second, 4, 2), self.flag(CARRY));
            if kind == 3 {
                return Err(unknown(code, at));
            }
            let other = self.shift(kind, self.r[field(second, 0, 4) as usize], by);
            if field(first, 4, 1) == 0 {
                self.set(CARRY, carry);
            }
            return self.processed(first, rd, self.operand(rn, at), rn, other, code, at);
        }
        if first & 0xfa00 != 0xf200 {
            return Err(unknown(code, at));
        }
        let imm16 = field(first, 0, 4) << 12 | imm12;
        self.r[rd] = match field(first, 4, 5) {
            0x00 => self.operand(rn, at).wrapping_add(imm12),
            0x04 => imm16,
            0x0a => self.operand(rn, at).wrapping_sub(imm12),
            0x0c => self.r[rd] & 0xffff | imm16 << 16,
            0x1c => {
                let low = field(second, 12, 3) << 2 | field(second, 6, 2);
                let width = field(second, 0, 5) + 1;
                self.r[rn] >> low & (u32::MAX >> (32 - width))
            }
            _ => return Err(unknown(code, at)),
        };
        Ok(())
    }

    fn branch(&mut self, first: u32, second: u32, at: u32) -> Result<(), Stop> {
        // DSB, DMB and ISB have no effect, because this processor executes everything in order.
        if first == 0xf3bf && second & 0xff00 == 0x8f00 {
            return Ok(());
        }
        if second & 0x9000 != 0x9000 {
            return Err(unknown(first << 16 | second, at));
        }
        let sign = field(first, 10, 1);
        let bit = |from: u32| !(field(second, from, 1) ^ sign) & 1;
        let offset = sign << 24
            | bit(13) << 23
            | bit(11) << 22
            | field(first, 0, 10) << 12
            | field(second, 0, 11) << 1;
        if second & 0x4000 != 0 {
            self.r[LR] = (at + 4) | 1;
        }
        self.r[PC] = (at + 4).wrapping_add(signed(offset, 25));
        Ok(())
    }

    /// The function `ThumbExpandImm_C` of the Armv7-M manual: the 32-bit constant that 12 bits of an instruction encode.
    fn expanded(&mut self, imm12: u32, flags: bool) -> u32 {
        let byte = imm12 & 0xff;
        match imm12 >> 8 {
            0 => byte,
            1 => byte << 16 | byte,
            2 => byte << 24 | byte << 8,
            3 => byte * 0x0101_0101,
            _ => {
                let value = (0x80 | imm12 & 0x7f).rotate_right(imm12 >> 7);
                if flags {
                    self.set(CARRY, value >> 31 == 1);
                }
                value
            }
        }
    }

    /// Executes a 32-bit data processing instruction whose second operand is a constant or a shifted register.
    #[expect(clippy::too_many_arguments, reason = "the fields of one instruction")]
    fn processed(
        &mut self,
        first: u32,
        rd: usize,
        a: u32,
        rn: usize,
        b: u32,
        code: u32,
        at: u32,
    ) -> Result<(), Stop> {
        let before = self.xpsr;
        let result = match (field(first, 5, 4), rn) {
            (0, _) => self.sign_and_zero(a & b),
            (1, _) => self.sign_and_zero(a & !b),
            (2, PC) => self.sign_and_zero(b),
            (2, _) => self.sign_and_zero(a | b),
            (3, PC) => self.sign_and_zero(!b),
            (4, _) => self.sign_and_zero(a ^ b),
            (8, _) => self.add(a, b, false),
            (13, _) => self.subtract(a, b),
            (14, _) => self.subtract(b, a),
            _ => return Err(unknown(code, at)),
        };
        // With the destination PC, the instructions are TST, TEQ, CMN and CMP, which set only the flags.
        if rd != PC {
            self.r[rd] = result;
        }
        if field(first, 4, 1) == 0 {
            self.xpsr = before;
        }
        Ok(())
    }
}

fn fetch(memory: &mut Memory, address: u32) -> Result<u32, Stop> {
    load(memory, address, 2)
}

fn load(memory: &mut Memory, address: u32, bytes: u32) -> Result<u32, Stop> {
    memory
        .load(address, bytes)
        .ok_or_else(|| Stop::Fault(format!("nothing to read at {address:#010x}")))
}

fn store(memory: &mut Memory, address: u32, bytes: u32, value: u32) -> Result<(), Stop> {
    memory
        .store(address, bytes, value)
        .ok_or_else(|| Stop::Fault(format!("nothing to write at {address:#010x}")))
}

fn unknown(code: u32, at: u32) -> Stop {
    Stop::Fault(format!(
        "instruction {code:#x} at {at:#010x} is not known here"
    ))
}
