//! Computes from a program's machine code the largest depth of the stack below a function.
//!
//! A function's frame is the sum of everything in it that lowers the stack pointer. This sum is never too small. It may be too
//! large, because a compiler may lower the stack pointer on several paths. A jump to another function counts as a call. Recursion,
//! and frames whose size is only known at run time, have no bound and are reported.
//!
//! A call through a register may lead to any function whose address occurs in the program's data or is computed in the program's
//! code. The caller of [`Depths::nested`] gives the largest number of such calls that are nested in each other.

use std::collections::{BTreeMap, BTreeSet};

use super::instruction::{Instruction, decode, loads_half, lowers};
use super::program::{ProgramCode, word};

/// Stack use of a single function.
#[derive(Debug, Default, Clone)]
struct Frame {
    bytes: u32,
    calls: BTreeSet<u32>,
    calls_by_register: bool,
    /// Whether the stack pointer is set from a register, to align the frame or for a size that is only known at run time.
    is_variable: bool,
}

/// A function's address, and the largest number of nested calls through registers below the function.
type Question = (u32, u32);

/// The largest stack depth below each function of a program.
pub struct Depths<'p> {
    program: &'p ProgramCode,
    frames: BTreeMap<u32, Frame>,
    /// Functions whose address is taken, so that a call through a register may lead to them.
    taken: BTreeSet<u32>,
    /// For each function and number of nested register calls: bytes of stack, and the next function on the deepest path.
    known: BTreeMap<Question, (u32, Option<Question>)>,
    /// Functions and calls whose stack depth could not be bounded.
    pub unbounded: BTreeSet<String>,
}

impl<'p> Depths<'p> {
    /// Reads the stack use of all functions of a program.
    pub fn new(program: &'p ProgramCode) -> Self {
        let mut frames = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for start in program.starts() {
            let size = program.function(start).map_or(0, |(_, size)| size);
            let mut frame = Frame::default();
            // The target of a veneer counts as called. It does not become a possible target of other calls through registers.
            if let Some(goal) = program.bridge(start) {
                frame.calls.insert(goal);
                frames.insert(start, frame);
                continue;
            }
            let mut lower_halves = [0; 16];
            program.instructions(start, |at, first, second| {
                match lowers(first, second) {
                    Some(bytes) => frame.bytes += bytes,
                    None => frame.is_variable = true,
                }
                match decode(first, second) {
                    Instruction::Branch(far) => {
                        let goal = (at + 4).wrapping_add_signed(far);
                        // A jump to the function's own beginning is a loop; a call of it is recursion.
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
            // Only the processor calls the functions in the vector table, so no call through a register leads to them.
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

    /// Bytes of stack that a function needs together with all that it calls, if at most `nested` calls through registers are nested
    /// in each other.
    pub fn nested(&mut self, start: u32, nested: u32) -> u32 {
        self.below(start, nested, &mut Vec::new())
    }

    /// Leaves out, from now on, the functions whose names contain `text`, because they have already returned.
    pub fn leave_out(&mut self, text: &str) {
        let program = self.program;
        self.frames.retain(|start, _| {
            !program
                .function(*start)
                .is_some_and(|(name, _)| name.contains(text))
        });
        self.known.clear();
    }

    /// The deepest path of calls from a function: the name of each function on the path, and the bytes of its own frame. Call
    /// [`Depths::nested`] with the same arguments first.
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

    /// The name of the function at an address, in a form for people.
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
                // A function that is called through a register begins a new path; `nested` bounds the number of such calls. Tasks
                // (`poll`) are only called by the outermost such call, in the executor.
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
