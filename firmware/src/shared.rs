//! What passes between priorities.
//!
//! The current loop (priority 0) shares words in atomics with the control tick (priority 2), [`Down`] and [`Up`], and neither
//! ever waits. On one core a higher priority is never interrupted by a lower one, so two shapes are enough: the writer may be
//! interrupted by its reader, or the reader by its writer. The control tick shares everything else with the thread, which holds
//! it off for a few microseconds to look at it: [`Guarded`].

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// Masks the control interrupt, priority 2, and all below it.
const CONTROL_MASK: u8 = 2 << 4;

type Words<const N: usize> = [AtomicU32; N];

const fn zeros<const N: usize>() -> Words<N> {
    [const { AtomicU32::new(0) }; N]
}

fn store<const N: usize>(words: &Words<N>, values: &[u32; N]) {
    for (word, value) in words.iter().zip(values) {
        word.store(*value, Ordering::Relaxed);
    }
}

fn load<const N: usize>(words: &Words<N>) -> [u32; N] {
    let mut values = [0; N];
    for (value, word) in values.iter_mut().zip(words) {
        *value = word.load(Ordering::Relaxed);
    }
    values
}

/// From a lower priority to a higher one. The reader never sees half of a value: it is published by one store.
pub struct Down<const N: usize> {
    first: Words<N>,
    second: Words<N>,
    use_second: AtomicBool,
}

impl<const N: usize> Down<N> {
    /// All zeros.
    pub const fn new() -> Self {
        Self {
            first: zeros(),
            second: zeros(),
            use_second: AtomicBool::new(false),
        }
    }

    /// From one priority only.
    #[inline]
    pub fn put(&self, values: &[u32; N]) {
        let second = !self.use_second.load(Ordering::Relaxed);
        store(if second { &self.second } else { &self.first }, values);
        // On one core the order of the instructions is what an interrupt sees.
        compiler_fence(Ordering::SeqCst);
        self.use_second.store(second, Ordering::Relaxed);
    }

    /// From a higher priority than [`Self::put`]'s.
    #[inline]
    pub fn get(&self) -> [u32; N] {
        load(if self.use_second.load(Ordering::Relaxed) {
            &self.second
        } else {
            &self.first
        })
    }
}

/// From a higher priority to a lower one. The reader reads again if it was interrupted by the writer.
pub struct Up<const N: usize> {
    words: Words<N>,
    writes: AtomicU32,
}

/// The writer comes once a PWM period at most, and a read takes a hundredth of it: a second try always succeeds.
const TRIES: usize = 3;

impl<const N: usize> Up<N> {
    /// All zeros.
    pub const fn new() -> Self {
        Self {
            words: zeros(),
            writes: AtomicU32::new(0),
        }
    }

    /// From one priority only.
    #[inline]
    pub fn put(&self, values: &[u32; N]) {
        store(&self.words, values);
        compiler_fence(Ordering::SeqCst);
        self.writes.store(
            self.writes.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
    }

    /// From a lower priority than [`Self::put`]'s.
    #[inline]
    pub fn get(&self) -> [u32; N] {
        let mut values = [0; N];
        for _ in 0..TRIES {
            let before = self.writes.load(Ordering::Relaxed);
            compiler_fence(Ordering::SeqCst);
            values = load(&self.words);
            compiler_fence(Ordering::SeqCst);
            if self.writes.load(Ordering::Relaxed) == before {
                break;
            }
        }
        values
    }
}

impl<const N: usize> Default for Down<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Default for Up<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A value of the control tick's that the thread may look at, by holding the control tick off for as long.
pub struct Guarded<T>(UnsafeCell<T>);

// SAFETY: the control interrupt and a thread that masks it are the only users, one at a time (see the two methods).
unsafe impl<T: Send> Sync for Guarded<T> {}

impl<T> Guarded<T> {
    /// With a value.
    pub const fn new(value: T) -> Self {
        Self(UnsafeCell::new(value))
    }

    /// The value, in the control interrupt.
    ///
    /// # Safety
    /// Called once in each run of the control interrupt's handler and nowhere else.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub unsafe fn mine(&self) -> &mut T {
        // SAFETY: a handler does not interrupt itself, and the thread masks it while it has a reference.
        unsafe { &mut *self.0.get() }
    }

    /// The value, in the thread. Keep it short: a few microseconds are a few microseconds of lateness. Not nested.
    pub fn in_thread<R>(&self, look: impl FnOnce(&mut T) -> R) -> R {
        let before = basepri::read();
        basepri_max::write(CONTROL_MASK);
        cortex_m::asm::isb();
        compiler_fence(Ordering::SeqCst);
        // SAFETY: priorities 2 and below wait now, and those above do not use the value.
        let result = look(unsafe { &mut *self.0.get() });
        compiler_fence(Ordering::SeqCst);
        // SAFETY: back to what was.
        unsafe { basepri::write(before) };
        result
    }
}

/// One value from a lower priority to a higher one, taken once.
pub struct Slot<T> {
    value: UnsafeCell<Option<T>>,
    full: AtomicBool,
}

// SAFETY: `full` says who may touch the value: the giver while it is false, the taker while it is true.
unsafe impl<T: Send> Sync for Slot<T> {}

impl<T> Slot<T> {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            value: UnsafeCell::new(None),
            full: AtomicBool::new(false),
        }
    }

    /// From one priority only. `false` if the last one was not taken yet, which then stays.
    pub fn give(&self, value: T) -> bool {
        if self.full.load(Ordering::Acquire) {
            return false;
        }
        // SAFETY: the taker does not touch it before `full` is set, and there is one giver.
        unsafe { *self.value.get() = Some(value) };
        self.full.store(true, Ordering::Release);
        true
    }

    /// From a higher priority than [`Self::give`]'s, one only.
    #[inline]
    pub fn take(&self) -> Option<T> {
        if !self.full.load(Ordering::Acquire) {
            return None;
        }
        // SAFETY: the giver does not touch it before `full` is cleared, and there is one taker.
        let value = unsafe { (*self.value.get()).take() };
        self.full.store(false, Ordering::Release);
        value
    }
}

impl<T> Default for Slot<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// A value that belongs to one interrupt, given to it before it is enabled.
pub struct Owned<T>(UnsafeCell<Option<T>>);

// SAFETY: only the one interrupt touches the value after it was given (see `give` and `take`), so it moves between contexts once.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// Nothing yet.
    pub const fn empty() -> Self {
        Self(UnsafeCell::new(None))
    }

    /// Gives the value to the interrupt.
    ///
    /// # Safety
    /// The interrupt is not enabled yet, and nothing else calls [`Self::mine`].
    pub unsafe fn give(&self, value: T) {
        // SAFETY: nobody else has a reference, as the caller promises.
        unsafe { *self.0.get() = Some(value) };
    }

    /// The value, in the interrupt that it belongs to.
    ///
    /// # Safety
    /// Called once in each run of one interrupt handler and nowhere else.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub unsafe fn mine(&self) -> Option<&mut T> {
        // SAFETY: a handler does not interrupt itself, so this is the only reference.
        unsafe { (*self.0.get()).as_mut() }
    }
}

/// Keeps the largest of what one priority writes.
#[inline]
pub fn raise(most: &AtomicU32, value: u32) {
    if value > most.load(Ordering::Relaxed) {
        most.store(value, Ordering::Relaxed);
    }
}

/// Adds one, for one writer, and stays at the largest value.
#[inline]
pub fn count(counter: &AtomicU32) {
    counter.store(
        counter.load(Ordering::Relaxed).saturating_add(1),
        Ordering::Relaxed,
    );
}
