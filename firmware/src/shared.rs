//! What passes between priorities.
//!
//! What the current loop (priority 0) and the control tick (priority 2) exchange in every tick is in `touchstone_drive::exchange`.
//! The control tick shares everything else with the thread, which holds it off for a few microseconds to look at it: [`Guarded`].

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// Masks the control interrupt, priority 2, and all below it.
const CONTROL_MASK: u8 = 2 << 4;

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
