//! Exchange of command and report between the current loop and the control interrupt. The words are atomics, and neither side ever
//! waits.
//!
//! On one core a lower priority never interrupts a higher one, so two forms of mailbox are enough. In [`CommandBox`] the reader may
//! interrupt the writer; in [`ReportBox`] the writer may interrupt the reader. The functions are in this crate and not in the
//! firmware, because this crate is compiled for speed.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, compiler_fence};

use crate::current::{CurrentCommand, CurrentReport};
use crate::mailbox::{CommandWords, ReportWords};

const COMMAND_WORDS: usize = size_of::<CommandWords>() / 4;
const REPORT_WORDS: usize = size_of::<ReportWords>() / 4;

/// Passes a command from the control interrupt to the current loop. If the loop interrupts the writing, it reads the previous
/// command.
#[derive(Debug)]
pub struct CommandBox(Down<COMMAND_WORDS>);

impl CommandBox {
    /// A mailbox that holds the default command: bridge off.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "for a static")]
    pub const fn new() -> Self {
        Self(Down::new())
    }

    /// Writes a command. Only the control interrupt may call it.
    #[inline(never)]
    pub fn put(&self, command: &CurrentCommand) {
        self.0.put(&command.to_words());
    }

    /// Reads the last command. Only the current loop may call it.
    #[inline(never)]
    #[must_use]
    pub fn get(&self) -> CurrentCommand {
        CurrentCommand::from_words(&self.0.get())
    }
}

/// Passes a report from the current loop to the control interrupt; the writer may interrupt the reader.
#[derive(Debug)]
pub struct ReportBox(Up<REPORT_WORDS>);

impl ReportBox {
    /// A mailbox that holds the default report.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "for a static")]
    pub const fn new() -> Self {
        Self(Up::new())
    }

    /// Writes a report. Only the current loop may call it.
    #[inline(never)]
    pub fn put(&self, report: &CurrentReport) {
        self.0.put(&report.to_words());
    }

    /// Reads the last report. Only the control interrupt may call it.
    #[inline(never)]
    #[must_use]
    pub fn get(&self) -> CurrentReport {
        CurrentReport::from_words(&self.0.get())
    }
}

type Words<const N: usize> = [AtomicU32; N];

const fn zeros<const N: usize>() -> Words<N> {
    [const { AtomicU32::new(0) }; N]
}

#[inline(always)]
fn store<const N: usize>(words: &Words<N>, values: &[u32; N]) {
    for (word, value) in words.iter().zip(values) {
        word.store(*value, Ordering::Relaxed);
    }
}

#[inline(always)]
fn load<const N: usize>(words: &Words<N>) -> [u32; N] {
    let mut values = [0; N];
    for (value, word) in values.iter_mut().zip(words) {
        *value = word.load(Ordering::Relaxed);
    }
    values
}

/// Passes words from a lower interrupt priority to a higher one. The reader never reads a half-written value, because one store
/// publishes the whole value.
#[derive(Debug)]
struct Down<const N: usize> {
    first: Words<N>,
    second: Words<N>,
    use_second: AtomicBool,
}

impl<const N: usize> Down<N> {
    /// A mailbox that holds zeros.
    const fn new() -> Self {
        Self {
            first: zeros(),
            second: zeros(),
            use_second: AtomicBool::new(false),
        }
    }

    /// Writes a value. All callers must run at the same interrupt priority.
    #[inline(always)]
    fn put(&self, values: &[u32; N]) {
        let second = !self.use_second.load(Ordering::Relaxed);
        store(if second { &self.second } else { &self.first }, values);
        // On one core an interrupt reads memory in the order of the instructions.
        compiler_fence(Ordering::SeqCst);
        self.use_second.store(second, Ordering::Relaxed);
    }

    /// Reads the last value. The caller must run at a higher interrupt priority than callers of [`Self::put`].
    #[inline(always)]
    fn get(&self) -> [u32; N] {
        load(if self.use_second.load(Ordering::Relaxed) {
            &self.second
        } else {
            &self.first
        })
    }
}

/// Passes words from a higher interrupt priority to a lower one. The reader first announces which of two places it reads, and the
/// writer then writes the other place. So no value is ever a mix of two, however often the reader is interrupted, and neither side
/// has to retry.
#[derive(Debug)]
struct Up<const N: usize> {
    first: Words<N>,
    second: Words<N>,
    /// Whether the last value is in the field `second`; `reads_second`: whether the reader has announced that it reads `second`.
    last_is_second: AtomicBool,
    reads_second: AtomicBool,
}

impl<const N: usize> Up<N> {
    /// A mailbox that holds zeros.
    const fn new() -> Self {
        Self {
            first: zeros(),
            second: zeros(),
            last_is_second: AtomicBool::new(false),
            reads_second: AtomicBool::new(false),
        }
    }

    /// Writes a value. All callers must run at the same interrupt priority.
    #[inline(always)]
    fn put(&self, values: &[u32; N]) {
        let second = !self.reads_second.load(Ordering::Relaxed);
        store(if second { &self.second } else { &self.first }, values);
        compiler_fence(Ordering::SeqCst);
        self.last_is_second.store(second, Ordering::Relaxed);
    }

    /// Reads the last value. All callers must run at the same interrupt priority, lower than that of the callers of [`Self::put`].
    #[inline(always)]
    fn get(&self) -> [u32; N] {
        self.get_interrupted(|| ())
    }

    /// Same as `get`, but calls `interrupt` between any two steps, to simulate an interrupt at that point.
    #[inline(always)]
    fn get_interrupted(&self, mut interrupt: impl FnMut()) -> [u32; N] {
        let second = self.last_is_second.load(Ordering::Relaxed);
        interrupt();
        self.reads_second.store(second, Ordering::Relaxed);
        // On one core an interrupt reads memory in the order of the instructions. From here on the announced place holds a
        // complete value, and the writer leaves it alone. A write between the two lines above makes the value older or newer, but
        // never mixed.
        compiler_fence(Ordering::SeqCst);
        let words = if second { &self.second } else { &self.first };
        let mut values = [0; N];
        for (value, word) in values.iter_mut().zip(words) {
            interrupt();
            *value = word.load(Ordering::Relaxed);
        }
        compiler_fence(Ordering::SeqCst);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::current::CurrentMode;

    #[test]
    fn what_is_put_is_what_comes_out_and_the_last_counts() {
        let (commands, reports) = (CommandBox::new(), ReportBox::new());
        assert_eq!(commands.get(), CurrentCommand::default());
        assert_eq!(reports.get(), CurrentReport::default());
        for tick in 1..=3 {
            let command = CurrentCommand {
                tick,
                mode: CurrentMode::Drive,
                ..CurrentCommand::default()
            };
            commands.put(&command);
            assert_eq!(commands.get(), command);
            let report = CurrentReport {
                periods: 20 * tick,
                ..CurrentReport::default()
            };
            reports.put(&report);
            assert_eq!(reports.get(), report);
        }
    }
    /// Checks that no read mixes two reports. Zero to two writes fall between any two steps of a read, in every combination; the
    /// base-3 digits of a number select the combination.
    #[test]
    fn no_report_is_torn_however_often_its_reading_is_interrupted() {
        const WORDS: usize = 6;
        for pattern in 0..3_u32.pow(WORDS as u32 + 1) {
            let up = Up::<WORDS>::new();
            let mut written = 0;
            let mut put = |times| {
                for _ in 0..times {
                    written += 1;
                    up.put(&[written; WORDS]);
                }
            };
            // Either of the two places may hold the last value at the start.
            put(1 + pattern % 2);
            let _ = up.get();
            put(pattern % 3);
            let mut left = pattern;
            let values = up.get_interrupted(|| {
                put(left % 3);
                left /= 3;
            });
            assert!(
                values.iter().all(|value| *value == values[0]),
                "{pattern}: {values:?}"
            );
            assert_ne!(values[0], 0);
        }
    }
}
