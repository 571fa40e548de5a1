//! Finds every function that can run when a given function is called.
//!
//! Calls and jumps with a fixed target are followed. A call through a register cannot be followed, and is reported.

use std::collections::BTreeSet;

use super::instruction::{Instruction, decode};
use super::program::ProgramCode;

/// The functions that a given function reaches: it calls them directly or through other functions.
#[derive(Debug, Default)]
pub struct Reach {
    /// Names of the reached functions, including the starting function.
    pub functions: BTreeSet<String>,
    /// Size of all reached functions in bytes, with their tables of constants.
    pub bytes: u32,
    /// Number of instructions in all reached functions.
    pub instructions: usize,
    /// Instructions of the float unit, each as text with function and address.
    pub float_unit: Vec<String>,
    /// Calls and jumps whose target is unknown, each as text.
    pub unknown: Vec<String>,
    /// Places at which the code masks interrupts, each as text.
    pub masks: Vec<String>,
    /// Trap instructions, which stop the processor where execution must never get, each as text.
    pub traps: Vec<String>,
}

impl ProgramCode {
    /// Follows all calls from the first function whose name contains the given text. `None` if there is no such function, or if
    /// code that it reaches cannot be read.
    pub fn reach(&self, name: &str) -> Option<Reach> {
        let mut starts = self.starts();
        self.reach_from(starts.find(|start| {
            self.function_name(*start)
                .is_some_and(|whole| whole.contains(name))
        })?)
    }

    /// Follows all calls from the function at an address. `None` if no function begins there, or if code that it reaches cannot be
    /// read.
    pub fn reach_from(&self, address: u32) -> Option<Reach> {
        let mut reach = Reach::default();
        let mut waiting = vec![address];
        let mut seen: BTreeSet<u32> = waiting.iter().copied().collect();
        while let Some(start) = waiting.pop() {
            let (name, size) = self.function(start)?;
            reach.functions.insert(name.to_owned());
            reach.bytes += size;
            for goal in self.goals(start, name, size, &mut reach)? {
                if seen.insert(goal) {
                    waiting.push(goal);
                }
            }
        }
        Some(reach)
    }

    /// Reads one function and adds it to `reach`. Returns the addresses of the functions that it calls or jumps to; `None` if its
    /// code cannot be read.
    fn goals(&self, start: u32, name: &str, size: u32, reach: &mut Reach) -> Option<Vec<u32>> {
        if let Some(goal) = self.bridge(start) {
            reach.instructions += 3;
            return Some(vec![goal]);
        }
        let mut goals = Vec::new();
        let mut is_known = true;
        self.instructions(start, |at, first, second| {
            let place = || format!("{name} at {at:#x}");
            reach.instructions += 1;
            match decode(first, second) {
                Instruction::Branch(far) => {
                    let goal = (at + 4).wrapping_add_signed(far);
                    if self.function(goal).is_some() {
                        goals.push(goal);
                    } else if !(start..start + size).contains(&goal) {
                        reach.unknown.push(place());
                    }
                }
                Instruction::CallRegister | Instruction::JumpRegister => {
                    reach.unknown.push(place())
                }
                Instruction::FloatUnit => reach.float_unit.push(place()),
                Instruction::Trap => reach.traps.push(place()),
                Instruction::Mask => reach.masks.push(place()),
                Instruction::Other => {}
            }
            is_known &= self.half(at).is_some();
        });
        if !is_known {
            return None;
        }
        Some(goals)
    }
}
