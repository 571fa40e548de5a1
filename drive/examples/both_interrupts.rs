//! All calls that firmware makes into this crate: in its set-up, in the control interrupt and in the PWM interrupt.
//!
//! The example is a library, so that it builds without an operating system. `cargo xtask float-free` checks that the compiled code
//! has no floating-point operations.
#![no_std]

use touchstone_drive::mailbox::{CommandWords, ReportWords};
use touchstone_drive::{
    CompactRecord, ControlInput, ControlOutput, CurrentCommand, CurrentConfig, CurrentLoop,
    CurrentOutput, CurrentReport, CurrentSample, Device, DeviceSettings, Hardware, ResetFlags,
    ResetReason, Ring, SettingsError,
};

/// Validates the settings and computes all coefficients that the device needs from them.
///
/// # Errors
/// Same as [`Device::new`].
#[inline(never)]
pub fn set_up(settings: &DeviceSettings, hardware: &Hardware) -> Result<Device, SettingsError> {
    Device::new(settings, hardware)
}

/// Gives the device other settings, which are used from the next calibration on.
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

/// Reports to the device why the processor started.
#[inline(never)]
pub fn started(device: &mut Device, flags: &ResetFlags) {
    device.started(ResetReason::of(flags));
}

/// The control interrupt: runs one control period (tick) and stores its record in the ring of the last second.
#[inline(never)]
pub fn control(device: &mut Device, ring: &mut Ring, input: &ControlInput) -> ControlOutput {
    let output = device.tick(input);
    ring.push(&output.record);
    output
}

/// Packs a control period's command to the current loop into words for the mailbox that the loop reads.
#[inline(never)]
pub fn down(output: &ControlOutput) -> CommandWords {
    output.mailbox().to_words()
}

/// The PWM interrupt: runs the current loop for one PWM period. Reads the command from one mailbox, writes the report to the other.
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

/// Sets other coefficients of the current loop, after a change of the settings.
#[inline(never)]
pub fn reconfigure(current: &mut CurrentLoop, config: &CurrentConfig) {
    current.reconfigure(*config);
}

/// Unpacks the report that the current loop put into the mailbox for the control interrupt.
#[inline(never)]
pub fn up(words: &ReportWords) -> CurrentReport {
    CurrentReport::from_words(words)
}

/// Reads a record from the ring that holds the last second before a fault; index 0 is the oldest.
#[inline(never)]
pub fn oldest(ring: &mut Ring, index: usize) -> Option<CompactRecord> {
    let record = ring.get(index).map(CompactRecord::from_bytes);
    ring.thaw();
    record
}
