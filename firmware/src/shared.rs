//! Cells for data that code of different interrupt priorities shares.
//!
//! `touchstone_drive::exchange` has the data that the current loop (priority 0) and the control interrupt (priority 2) exchange in
//! every control period. All other shared data are in a [`SharedWithInterrupt`] cell: to access it, the main thread masks the control interrupt
//! for a few microseconds.

use core::cell::UnsafeCell;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// BASEPRI value that masks the control interrupt (priority 2) and all priorities below it.
const CONTROL_MASK: u8 = 2 << 4;

/// A token that only code of the main thread holds, never an interrupt. It cannot be sent to other threads.
#[derive(Debug, Clone, Copy)]
pub struct InThread(PhantomData<*const ()>);

impl InThread {
    /// Makes the token.
    ///
    /// # Safety
    /// Only code that runs in the main thread calls this, no interrupt.
    pub const unsafe fn new() -> Self {
        Self(PhantomData)
    }
}

/// A value that belongs to the control interrupt. The main thread masks that interrupt while it accesses the value.
pub struct SharedWithInterrupt<T> {
    value: UnsafeCell<T>,
    /// Whether the main thread has a reference to the value.
    taken: AtomicBool,
}

// SAFETY: the control interrupt and a thread that masks it are the only users, one at a time (see the two methods).
unsafe impl<T: Send> Sync for SharedWithInterrupt<T> {}

impl<T> SharedWithInterrupt<T> {
    /// A cell that holds this value.
    pub const fn new(value: T) -> Self {
        Self {
            value: UnsafeCell::new(value),
            taken: AtomicBool::new(false),
        }
    }

    /// Access to the value for the control interrupt.
    ///
    /// # Safety
    /// Called once in each run of the control interrupt's handler and nowhere else.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub unsafe fn mine(&self) -> &mut T {
        // SAFETY: a handler does not interrupt itself, and the thread masks it while it has a reference.
        unsafe { &mut *self.value.get() }
    }

    /// Calls `look` with the value, in the main thread. Keep `look` short: the control interrupt is delayed until it returns.
    ///
    /// # Panics
    /// `look` calls this function for the same value, which would make a second reference.
    pub fn in_thread<R>(&self, _in_thread: InThread, look: impl FnOnce(&mut T) -> R) -> R {
        let before = basepri::read();
        basepri_max::write(CONTROL_MASK);
        cortex_m::asm::isb();
        assert!(!self.taken.load(Ordering::Relaxed));
        self.taken.store(true, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        // SAFETY: this code runs in the main thread (`_in_thread`), and no other reference exists there (`taken`). Interrupts of
        // priority 2 and below are masked, and those above do not use the value.
        let result = look(unsafe { &mut *self.value.get() });
        compiler_fence(Ordering::SeqCst);
        self.taken.store(false, Ordering::Relaxed);
        // SAFETY: this restores the earlier value.
        unsafe { basepri::write(before) };
        result
    }
}

/// Value of `waiting` if no value waits. The indices 0 and 1 name a place.
const NOTHING: u8 = 2;

/// A box that passes the newest value from a lower interrupt priority to a higher one, which takes each value once. A new value
/// replaces one that was not taken yet.
pub struct Latest<T> {
    places: [UnsafeCell<Option<T>>; 2],
    /// Index of the value that the reader has not taken yet; [`NOTHING`] if there is none.
    waiting: AtomicU8,
    /// Index of the place that was written last.
    written: AtomicU8,
}

// SAFETY: the giver writes to the place that was not published last. The taker may interrupt the giver, but the giver cannot
// interrupt the taker. So the published place is always complete.
unsafe impl<T: Send> Sync for Latest<T> {}

impl<T: Copy> Latest<T> {
    /// A box that holds no value yet.
    pub const fn new() -> Self {
        Self {
            places: [const { UnsafeCell::new(None) }; 2],
            waiting: AtomicU8::new(NOTHING),
            written: AtomicU8::new(0),
        }
    }

    /// Puts a new value into the box.
    ///
    /// # Safety
    /// Only code of one interrupt priority calls this.
    pub unsafe fn give(&self, value: T) {
        let place = self.written.load(Ordering::Relaxed) ^ 1;
        // SAFETY: the taker does not read this place before it is published below, and there is only one giver.
        unsafe { *self.places[usize::from(place & 1)].get() = Some(value) };
        compiler_fence(Ordering::SeqCst);
        self.written.store(place, Ordering::Relaxed);
        self.waiting.store(place, Ordering::Release);
    }

    /// Takes the newest value; `None` if it was already taken.
    ///
    /// # Safety
    /// Only code of one interrupt priority calls this, a higher priority than that of [`Self::give`].
    #[inline]
    pub unsafe fn take(&self) -> Option<T> {
        let place = self.waiting.load(Ordering::Acquire);
        if place == NOTHING {
            return None;
        }
        self.waiting.store(NOTHING, Ordering::Relaxed);
        // SAFETY: the taker interrupts the giver, which at most was writing to the other place.
        unsafe { *self.places[usize::from(place & 1)].get() }
    }
}

impl<T: Copy> Default for Latest<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// A cell for a value that belongs to one interrupt. The value is put in before the interrupt is enabled.
pub struct Owned<T>(UnsafeCell<Option<T>>);

// SAFETY: only the one interrupt accesses the value after it was given (see `give` and `mine`), so the value moves between
// contexts once.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// A cell without a value.
    pub const fn empty() -> Self {
        Self(UnsafeCell::new(None))
    }

    /// Puts the value into the cell.
    ///
    /// # Safety
    /// The interrupt is not enabled yet, and no other code calls [`Self::mine`].
    pub unsafe fn give(&self, value: T) {
        // SAFETY: nobody else has a reference, as the caller promises.
        unsafe { *self.0.get() = Some(value) };
    }

    /// Access to the value for the interrupt that owns it; `None` if the cell is empty.
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

/// Raises `most` to `value` if `value` is larger. Only code of one interrupt priority may call this for the same `most`.
#[inline]
pub fn raise(most: &AtomicU32, value: u32) {
    if value > most.load(Ordering::Relaxed) {
        most.store(value, Ordering::Relaxed);
    }
}
