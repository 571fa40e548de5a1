//! The deepest stack below a function, read off the program.
//!
//! A function's frame is the sum of everything in it that lowers the stack pointer: too much rather than too little, as a
//! compiler may put two of them on different paths. A jump to another function counts as a call. What cannot be bounded is
//! reported: recursion, and frames of a size that is only known at run time.
//!
//! A call through a register may lead to any function whose address appears in the program's data or is made in its code.
//! [`Depths::nested`] says how many such calls may be inside each other.

use std::collections::{BTreeMap, BTreeSet};

use super::elf::{Instruction, Program, decode, is_wide, word};

/// What a function does to the stack, by itself.
#[derive(Debug, Default, Clone)]
struct Frame {
    bytes: u32,
    calls: BTreeSet<u32>,
    calls_by_register: bool,
    /// The stack pointer is set from a register: an alignment of the frame, or a size known at run time only.
    is_variable: bool,
}

/// A function, and how many calls through registers may be inside each other below it.
type Question = (u32, u32);

/// The deepest stack below functions.
pub struct Depths<'p> {
    program: &'p Program,
    frames: BTreeMap<u32, Frame>,
    /// Functions whose address is taken.
    taken: BTreeSet<u32>,
    /// Bytes below a question, and which one is next on the deepest path.
    known: BTreeMap<Question, (u32, Option<Question>)>,
    /// What could not be bounded.
    pub unbounded: BTreeSet<String>,
}

/// Bytes that an instruction lowers the stack pointer by; `None` if that is known at run time only.
fn lowers(first: u32, second: u32) -> Option<u32> {
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
        // PUSH.W, and STR with the same effect.
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

/// The constant that 12 bits of an instruction stand for (Arm ARM, ThumbExpandImm).
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

/// The 16 bits that MOVW and MOVT load, and the register.
fn loads_half(first: u32, second: u32) -> Option<(bool, usize, u32)> {
    let is_top = match first & 0xfbf0 {
        0xf240 => false,
        0xf2c0 => true,
        _ => return None,
    };
    let value =
        (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff;
    Some((is_top, (second >> 8 & 15) as usize, value))
}

impl<'p> Depths<'p> {
    /// Reads all functions.
    pub fn new(program: &'p Program) -> Self {
        let mut frames = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for start in program.starts() {
            let size = program.function(start).map_or(0, |(_, size)| size);
            let mut frame = Frame::default();
            let mut lower_halves = [0; 16];
            program.instructions(start, |at, first, second| {
                match lowers(first, second) {
                    Some(bytes) => frame.bytes += bytes,
                    None => frame.is_variable = true,
                }
                match decode(first, second) {
                    Instruction::Branch(far) => {
                        let goal = (at + 4).wrapping_add_signed(far);
                        // A jump to the function's own beginning is a loop; a call of it, recursion.
                        let is_call = second & 0x4000 != 0;
                        if goal != start || is_call {
                            frame.calls.insert(goal);
                        }
                    }
                    Instruction::CallRegister | Instruction::JumpRegister => {
                        frame.calls_by_register = true;
                    }
                    _ => {}
                }
                if let Some((is_top, register, value)) = loads_half(first, second) {
                    if is_top {
                        taken.insert(value << 16 | lower_halves[register]);
                    } else {
                        lower_halves[register] = value;
                    }
                }
            });
            frame.calls.retain(|goal| {
                program.function(*goal).is_some()
                    && (*goal == start || !(start..start + size).contains(goal))
            });
            frames.insert(start, frame);
        }
        // Words in data, and the constants between functions.
        for part in &program.parts {
            // What the vector table names is called by the processor only.
            if part.name == ".vector_table" {
                continue;
            }
            taken.extend(
                (0..part.content.len())
                    .step_by(if part.is_code { 2 } else { 4 })
                    .filter_map(|at| word(&part.content, at)),
            );
        }
        let taken = taken
            .into_iter()
            .filter(|address| address & 1 == 1 && frames.contains_key(&(address & !1)))
            .map(|address| address & !1)
            .collect();
        Self {
            program,
            frames,
            taken,
            known: BTreeMap::new(),
            unbounded: BTreeSet::new(),
        }
    }

    /// Bytes of stack below a function, its own frame included, where up to `nested` calls through registers may be inside each
    /// other.
    pub fn nested(&mut self, start: u32, nested: u32) -> u32 {
        self.below(start, nested, &mut Vec::new())
    }

    /// From now on without the functions whose name contains a text: they are over before what is asked for.
    pub fn leave_out(&mut self, text: &str) {
        let program = self.program;
        self.frames.retain(|start, _| {
            !program
                .function(*start)
                .is_some_and(|(name, _)| name.contains(text))
        });
        self.known.clear();
    }

    /// The deepest path below a function that was asked for: each function's own frame and name.
    pub fn path(&self, start: u32, nested: u32) -> Vec<(u32, String)> {
        let mut path = Vec::new();
        let mut next = Some((start, nested));
        while let Some(key) = next {
            let own = self.frames.get(&key.0).map_or(0, |frame| frame.bytes);
            path.push((own, self.name(key.0)));
            next = self.known.get(&key).and_then(|known| known.1);
        }
        path
    }

    /// The name of a function for people.
    fn name(&self, start: u32) -> String {
        self.program
            .function(start)
            .map_or_else(|| format!("{start:#x}"), |(name, _)| name.to_owned())
    }

    fn below(&mut self, start: u32, nested: u32, path: &mut Vec<u32>) -> u32 {
        if let Some((bytes, _)) = self.known.get(&(start, nested)) {
            return *bytes;
        }
        if path.contains(&start) {
            let name = self.name(start);
            self.unbounded.insert(format!("recursion: {name}"));
            return 0;
        }
        let Some(frame) = self.frames.get(&start).cloned() else {
            return 0;
        };
        if frame.is_variable {
            let name = self.name(start);
            self.unbounded
                .insert(format!("a frame of a variable size: {name}"));
        }
        path.push(start);
        let (mut deepest, mut next) = (0, None);
        for goal in &frame.calls {
            let bytes = self.below(*goal, nested, path);
            if bytes > deepest {
                (deepest, next) = (bytes, Some((*goal, nested)));
            }
        }
        path.pop();
        if frame.calls_by_register && nested > 0 {
            for goal in self.taken.clone() {
                // Whatever is called through a register begins a path of its own, with one such call less to come. Only the
                // executor, which is the outermost, calls a task.
                if nested > 1 || !self.name(goal).contains("poll") {
                    let bytes = self.below(goal, nested - 1, &mut Vec::new());
                    if bytes > deepest {
                        (deepest, next) = (bytes, Some((goal, nested - 1)));
                    }
                }
            }
        }
        let bytes = frame.bytes + deepest;
        self.known.insert((start, nested), (bytes, next));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            // add sp, #180; sub.w r4, sp, #8 (an aligned frame's beginning): not by themselves
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
