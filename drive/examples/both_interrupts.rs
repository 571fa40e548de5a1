//! What firmware's two interrupts and its set-up use of this crate, and nothing else.
//!
//! It is a library, so that it builds without an operating system; `cargo xtask float-free` looks at the code that the
//! compiler makes of it.
#![no_std]

use touchstone_drive::mailbox::{CommandWords, ReportWords};
use touchstone_drive::{
    CompactRecord, ControlInput, ControlOutput, CurrentCommand, CurrentConfig, CurrentLoop,
    CurrentOutput, CurrentReport, CurrentSample, Device, DeviceSettings, Hardware, ResetFlags,
    ResetReason, Ring, SettingsError,
};

/// Validates settings and computes everything.
///
/// # Errors
/// Same as [`Device::new`].
#[inline(never)]
pub fn set_up(settings: &DeviceSettings, hardware: &Hardware) -> Result<Device, SettingsError> {
    Device::new(settings, hardware)
}

/// Other settings.
///
/// # Errors
/// Same as [`Device::configure`].
#[inline(never)]
pub fn configure(
    device: &mut Device,
    settings: &DeviceSettings,
    hardware: &Hardware,
) -> Result<(), SettingsError> {
    device.configure(settings, hardware)
}

/// Reports the start.
#[inline(never)]
pub fn started(device: &mut Device, flags: &ResetFlags) {
    device.started(ResetReason::of(flags));
}

/// The control interrupt.
#[inline(never)]
pub fn control(device: &mut Device, ring: &mut Ring, input: &ControlInput) -> ControlOutput {
    let output = device.tick(input);
    ring.push(&output.record);
    output
}

/// The mailbox from the control tick to the current loop.
#[inline(never)]
pub fn down(output: &ControlOutput) -> CommandWords {
    output.mailbox().to_words()
}

/// The current interrupt, from mailbox to mailbox.
#[inline(never)]
pub fn current(
    current: &mut CurrentLoop,
    sample: &CurrentSample,
    words: &CommandWords,
) -> (CurrentOutput, ReportWords) {
    let command = CurrentCommand::from_words(words);
    let output = current.tick(&CurrentSample { command, ..*sample });
    (output, current.report().to_words())
}

/// Gives the current loop other coefficients.
#[inline(never)]
pub fn reconfigure(current: &mut CurrentLoop, config: &CurrentConfig) {
    current.reconfigure(*config);
}

/// The mailbox from the current loop to the control tick.
#[inline(never)]
pub fn up(words: &ReportWords) -> CurrentReport {
    CurrentReport::from_words(words)
}

/// A record of the last second before a fault.
#[inline(never)]
pub fn oldest(ring: &mut Ring, index: usize) -> Option<CompactRecord> {
    let record = ring.get(index).map(CompactRecord::from_bytes);
    ring.thaw();
    record
}
