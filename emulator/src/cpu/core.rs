//! Counters of instructions and cycles, updated with every instruction, and the decision when the processor stops.

use super::decode::{Info, Kind, REFILL};

/// Decoded instructions of one code memory. It has an entry per half-word, `None` until the instruction there is first executed.
#[derive(Debug)]
struct Cache {
    base: u32,
    infos: Vec<Option<Info>>,
}

/// Reason why the processor stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The time slice is over, or something changed that may raise an interrupt.
    Slice,
    /// The processor stopped before a WFE (wait for event) instruction.
    WaitEvent,
    /// The processor stopped before a WFI (wait for interrupt) instruction.
    WaitInterrupt,
    /// The processor stopped before an instruction that is not modelled.
    Unsupported,
}

/// A function whose calls are counted.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Name of the function for reports.
    pub name: String,
    start: u32,
    /// The present call, if the function is running: return address, exception depth, and the cost counters at its start.
    call: Option<Call>,
    /// Number of calls.
    pub calls: u64,
    /// Largest cost of a single call, without the interrupts during the call.
    pub worst: Cost,
}

#[derive(Debug, Clone, Copy)]
struct Call {
    depth: usize,
    returns_to: u32,
    begin: Cost,
}

/// Cost of executed code: instructions, cycles and flash fetches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of instructions, including those that an IT block skips.
    pub instructions: u64,
    /// Number of cycles by the manual's table of instruction times, see [`super::decode`].
    pub cycles: u64,
    /// Number of double words that were fetched from flash: each that differs from the previous fetch, and each constant that an
    /// instruction reads from the program memory.
    pub fetches: u64,
}

impl Cost {
    /// The difference of each counter to its value in `earlier`.
    #[must_use]
    pub fn since(self, earlier: Self) -> Self {
        Self {
            instructions: self.instructions - earlier.instructions,
            cycles: self.cycles - earlier.cycles,
            fetches: self.fetches - earlier.fetches,
        }
    }

    /// The larger value of each of the three counters.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        Self {
            instructions: self.instructions.max(other.instructions),
            cycles: self.cycles.max(other.cycles),
            fetches: self.fetches.max(other.fetches),
        }
    }

    /// Cycles if the processor waits for each fetch: no cache, no prefetch, nothing in parallel. Real flash takes fewer cycles.
    /// Waits for reads of tables in flash are not included.
    #[must_use]
    pub const fn waiting(self) -> u64 {
        self.cycles + WAIT_STATES * self.fetches
    }
}

/// Wait states of the flash at 170 MHz, in voltage range 1 boosted (RM0440, table 29). The check against `registers.tsv` ensures
/// that the firmware sets this number.
pub const WAIT_STATES: u64 = 4;

/// Registers, memories and counters of the processor.
#[derive(Debug)]
pub struct Core {
    /// Time since power-on, in processor cycles.
    pub now: u64,
    /// Costs of the executed instructions, with cycles by the manual's table and without wait states.
    pub spent: Cost,
    /// Time in cycles at which the processor stops.
    pub limit: u64,
    /// True: the processor stops at the next instruction boundary.
    pub interrupted: bool,
    /// Reason why the processor stopped.
    pub stop: Stop,
    /// Whether the float unit was used since the last exception began.
    pub float_used: bool,
    /// The processor's event register, which the instruction WFE reads.
    pub event: bool,
    /// Factor on the cycles of every instruction, in 256ths: 256 means the manual's cycles. A larger value stands for wait states,
    /// or for a program that is far too slow.
    pub stretch: u64,
    /// End address of the last instruction or IT block; `None` if the present time slice has executed none yet.
    end: Option<u32>,
    /// Address at which the present IT (if-then) block begins; `u32::MAX` outside of a block.
    block_start: u32,
    /// Number of the double word of flash that was fetched last: its address divided by eight.
    fetched: u32,
    /// Decoded instructions of flash, CCM and RAM, in the order of their addresses.
    caches: [Cache; 3],
    /// Number of fetches of each double word of flash while [`Core::is_counting`]; empty unless a caller allocated it.
    pub by_place: Vec<u32>,
    /// Whether fetches are counted by address, because the current loop or the control interrupt runs.
    pub is_counting: bool,
    /// Functions whose calls are counted.
    pub watches: Vec<Watch>,
    /// Addresses where watched functions begin, and to which their calls return.
    watch_points: Vec<u32>,
    /// Nesting depth: number of exception handlers that are running, each inside the previous one.
    pub depth: usize,
    /// Cost of each nesting level of exceptions; level 0 is the main program.
    pub by_depth: [Cost; 8],
}

impl Core {
    /// A processor with memories for code (flash, CCM, RAM), each given by start address and size.
    #[must_use]
    pub fn new(memories: [(u32, usize); 3]) -> Self {
        let cache = |(base, bytes): (u32, usize)| Cache {
            base,
            infos: vec![None; bytes / 2],
        };
        Self {
            now: 0,
            spent: Cost::default(),
            limit: 0,
            interrupted: false,
            stop: Stop::Slice,
            float_used: false,
            event: false,
            stretch: 256,
            end: None,
            block_start: u32::MAX,
            fetched: u32::MAX,
            caches: memories.map(cache),
            by_place: Vec::new(),
            is_counting: false,
            watches: Vec::new(),
            watch_points: Vec::new(),
            depth: 0,
            by_depth: [Cost::default(); 8],
        }
    }

    /// Counts the calls and the cost of the function that begins at address `start`.
    pub fn watch(&mut self, name: &str, start: u32) {
        let (name, call, worst) = (name.to_owned(), None, Cost::default());
        self.watch_points.push(start);
        self.watches.push(Watch {
            name,
            start,
            call,
            calls: 0,
            worst,
        });
    }

    /// Sets the processor to its state after a reset; the time goes on.
    pub fn reset(&mut self) {
        self.end = None;
        self.block_start = u32::MAX;
        self.float_used = false;
        self.event = false;
        self.depth = 0;
        self.is_counting = false;
        self.interrupted = false;
        for watch in &mut self.watches {
            watch.call = None;
        }
    }

    #[inline]
    fn memory_of(&self, address: u32) -> usize {
        let [_, ccm, ram] = &self.caches;
        usize::from(address >= ccm.base) + usize::from(address >= ram.base)
    }

    /// The decoded instruction at an address; `None` if it has not been decoded yet. Outside the code memories it is
    /// [`Info::SIMPLE`].
    #[must_use]
    #[inline]
    pub fn known(&self, address: u32) -> Option<Info> {
        let cache = &self.caches[self.memory_of(address)];
        let at = address.wrapping_sub(cache.base) as usize / 2;
        match cache.infos.get(at) {
            Some(info) => *info,
            // The program executes no code outside the cached range.
            None => Some(Info::SIMPLE),
        }
    }

    /// Stores the decoded instruction of an address.
    pub fn learn(&mut self, address: u32, info: Info) {
        let memory = self.memory_of(address);
        let cache = &mut self.caches[memory];
        let at = address.wrapping_sub(cache.base) as usize / 2;
        if let Some(slot) = cache.infos.get_mut(at) {
            *slot = Some(info);
        }
    }

    #[inline]
    fn spend(&mut self, instructions: u64, cycles: u64) {
        self.spent.instructions += instructions;
        self.spent.cycles += cycles;
        let level = &mut self.by_depth[self.depth.min(7)];
        level.instructions += instructions;
        level.cycles += cycles;
        self.now += if self.stretch == 256 {
            cycles
        } else {
            cycles * self.stretch / 256
        };
    }

    #[inline]
    fn fetch(&mut self, address: u32, times: u64) {
        self.spent.fetches += times;
        self.by_depth[self.depth.min(7)].fetches += times;
        if self.is_counting {
            let at = (address - self.caches[0].base) as usize / 8;
            if let Some(count) = self.by_place.get_mut(at) {
                *count += times as u32;
            }
        }
    }

    /// Advances the time without an instruction, for an exception's entry or return.
    pub fn spend_cycles(&mut self, cycles: u64) {
        self.now += cycles;
    }

    /// Called before an instruction is executed: counts it. Returns whether the processor must stop before the instruction.
    #[inline]
    pub fn step(&mut self, address: u32, size: u32, info: Info) -> bool {
        if address < self.caches[1].base {
            let [first, last] = [address / 8, (address + size - 1) / 8];
            let fetches = u64::from(first != self.fetched) + u64::from(last != first);
            if fetches > 0 || info.reads_literal {
                self.fetch(address, fetches + u64::from(info.reads_literal));
                self.fetched = last;
            }
        }
        if let Some(end) = self.end.take() {
            if address < end && address >= self.block_start {
                // This instruction is inside an IT block, in which the processor does not stop. The IT instruction was already
                // charged with all instructions of the block, one cycle each, executed or not.
                self.spend(0, u64::from(info.cycles) - 1);
                self.end = Some(end);
                return false;
            }
            self.block_start = u32::MAX;
            if end != address {
                self.spend(0, REFILL);
            }
        }
        if self.interrupted || self.now >= self.limit {
            self.stop = Stop::Slice;
            return true;
        }
        let mut end = Some(address + size);
        match info.kind {
            Kind::Plain => {}
            Kind::IfThen { count, bytes } => {
                self.spend(u64::from(count), u64::from(count));
                self.block_start = address + size;
                end = Some(address + size + u32::from(bytes));
            }
            Kind::Mask => self.interrupted = true,
            Kind::Float => self.float_used = true,
            Kind::SendEvent => self.event = true,
            Kind::WaitEvent | Kind::WaitInterrupt => {
                self.spend(1, 1);
                self.stop = match info.kind {
                    Kind::WaitEvent => Stop::WaitEvent,
                    _ => Stop::WaitInterrupt,
                };
                return true;
            }
            Kind::ReadIpsr => {
                self.stop = Stop::Unsupported;
                return true;
            }
        }
        self.spend(1, u64::from(info.cycles));
        self.end = end;
        false
    }

    /// Whether a watched function may begin at this address, or one of its calls return to it.
    #[inline]
    #[must_use]
    pub fn may_be_watched(&self, address: u32) -> bool {
        self.watch_points.contains(&address)
    }

    /// Updates the watched functions when the processor reaches an address: starts or ends a call. `link` is the link register's
    /// value, the call's return address.
    pub fn watch_at(&mut self, address: u32, link: u32) {
        let spent = self.by_depth[self.depth.min(7)];
        let depth = self.depth;
        for watch in &mut self.watches {
            match watch.call {
                Some(call) if call.returns_to == address && call.depth == depth => {
                    watch.calls += 1;
                    watch.worst = watch.worst.worst(spent.since(call.begin));
                    watch.call = None;
                }
                None if watch.start == address => {
                    if !self.watch_points.contains(&(link & !1)) {
                        self.watch_points.push(link & !1);
                    }
                    watch.call = Some(Call {
                        depth,
                        returns_to: link & !1,
                        begin: spent,
                    });
                }
                _ => {}
            }
        }
    }
}
