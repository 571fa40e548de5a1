//! Data that passes between priorities.
//!
//! `touchstone_drive::exchange` has what the current loop (priority 0) and the control tick (priority 2) exchange in
//! every tick. The control tick shares everything else with the thread, which delays the tick by a few microseconds to
//! read it: [`Guarded`].

use core::cell::UnsafeCell;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// Masks the control interrupt, priority 2, and all below it.
const CONTROL_MASK: u8 = 2 << 4;

/// Says that the code that has it runs in the thread, and in no interrupt: it never leaves the thread.
#[derive(Debug, Clone, Copy)]
pub struct InThread(PhantomData<*const ()>);

impl InThread {
    /// In the thread.
    ///
    /// # Safety
    /// No interrupt calls this.
    pub const unsafe fn new() -> Self {
        Self(PhantomData)
    }
}

/// A value of the control tick's that the thread may look at, by holding the control tick off for as long.
pub struct Guarded<T> {
    value: UnsafeCell<T>,
    /// The thread has a reference.
    taken: AtomicBool,
}

// SAFETY: the control interrupt and a thread that masks it are the only users, one at a time (see the two methods).
unsafe impl<T: Send> Sync for Guarded<T> {}

impl<T> Guarded<T> {
    /// A cell that holds this value.
    pub const fn new(value: T) -> Self {
        Self {
            value: UnsafeCell::new(value),
            taken: AtomicBool::new(false),
        }
    }

    /// The value, in the control interrupt.
    ///
    /// # Safety
    /// Called once in each run of the control interrupt's handler and nowhere else.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub unsafe fn mine(&self) -> &mut T {
        // SAFETY: a handler does not interrupt itself, and the thread masks it while it has a reference.
        unsafe { &mut *self.value.get() }
    }

    /// The value, in the thread. Keep it short: a few microseconds are a few microseconds of lateness.
    ///
    /// # Panics
    /// Must not be called within itself: two references to the value would exist.
    pub fn in_thread<R>(&self, _in_thread: InThread, look: impl FnOnce(&mut T) -> R) -> R {
        let before = basepri::read();
        basepri_max::write(CONTROL_MASK);
        cortex_m::asm::isb();
        assert!(!self.taken.load(Ordering::Relaxed));
        self.taken.store(true, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        // SAFETY: this is the thread, as `_in_thread` says, which has no other reference, as `taken` says. Priorities 2 and below
        // wait now, and those above do not use the value.
        let result = look(unsafe { &mut *self.value.get() });
        compiler_fence(Ordering::SeqCst);
        self.taken.store(false, Ordering::Relaxed);
        // SAFETY: back to what was.
        unsafe { basepri::write(before) };
        result
    }
}

/// Marks an empty box; other numbers name the place of the last value.
const NOTHING: u8 = 2;

/// Passes the last value from a lower priority to a higher one, which takes it once. A new value replaces one that was
/// not taken yet.
pub struct Latest<T> {
    places: [UnsafeCell<Option<T>>; 2],
    /// Where the value is that was not taken yet.
    waiting: AtomicU8,
    /// Where the last one was written.
    written: AtomicU8,
}

// SAFETY: the giver writes the place that was not published last, so that the taker, which may interrupt it but is not interrupted
// by it, finds the other one whole.
unsafe impl<T: Send> Sync for Latest<T> {}

impl<T: Copy> Latest<T> {
    /// An empty box.
    pub const fn new() -> Self {
        Self {
            places: [const { UnsafeCell::new(None) }; 2],
            waiting: AtomicU8::new(NOTHING),
            written: AtomicU8::new(0),
        }
    }

    /// A new value.
    ///
    /// # Safety
    /// From one priority only.
    pub unsafe fn give(&self, value: T) {
        let place = self.written.load(Ordering::Relaxed) ^ 1;
        // SAFETY: the taker has no business with this place before it is published below, and there is one giver.
        unsafe { *self.places[usize::from(place & 1)].get() = Some(value) };
        compiler_fence(Ordering::SeqCst);
        self.written.store(place, Ordering::Relaxed);
        self.waiting.store(place, Ordering::Release);
    }

    /// The last value, if there is a new one.
    ///
    /// # Safety
    /// From one priority only, higher than [`Self::give`]'s.
    #[inline]
    pub unsafe fn take(&self) -> Option<T> {
        let place = self.waiting.load(Ordering::Acquire);
        if place == NOTHING {
            return None;
        }
        self.waiting.store(NOTHING, Ordering::Relaxed);
        // SAFETY: the giver is interrupted by this and at most writes the other place.
        unsafe { *self.places[usize::from(place & 1)].get() }
    }
}

impl<T: Copy> Default for Latest<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// A value that belongs to one interrupt, which gets it before it is enabled.
pub struct Owned<T>(UnsafeCell<Option<T>>);

// SAFETY: only the one interrupt touches the value after it was given (see `give` and `take`), so it moves between contexts once.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// An empty cell.
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

/// Keeps the largest value that one priority writes.
#[inline]
pub fn raise(most: &AtomicU32, value: u32) {
    if value > most.load(Ordering::Relaxed) {
        most.store(value, Ordering::Relaxed);
    }
}
