//! Injects faults into any device at a chosen call. To the caller they look like the device's own faults.

use super::{Applied, DataSheet, DeviceStanding, HapticDevice, HapticFault, Sensed};
use std::time::Duration;

/// The calls of a device into which a fault can be injected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceCall {
    /// The call [`HapticDevice::engage`], which switches the motors on.
    Engage,
    /// The call [`HapticDevice::sense`], which reads the position.
    Sense,
    /// The call [`HapticDevice::command`], which commands a force.
    Command,
    /// The call [`HapticDevice::standing`], which requests the device's state.
    Standing,
    /// The call [`HapticDevice::release`], which switches the motors off and closes the device.
    Release,
}

/// The fault that is injected into a call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaultKind {
    /// The device is disconnected: this call and every later one fail, and no force acts.
    Unplugged,
    /// Only this call fails; the last commanded force still acts.
    Fails,
    /// The device is in use by another program.
    Held,
    /// From this call on the device repeats its last position, marked as old.
    Stale,
    /// From this call on the motors give half of the commanded force, and the device reports them as saturated.
    Saturated,
    /// The call takes longer by this duration.
    Slow(Duration),
    /// From this call on one coordinate is wrong by 20 mm.
    Jumps,
    /// One coordinate of the position is NaN.
    NotANumber,
    /// The device's own safety switches its motors off.
    SwitchedOff(super::SwitchOff),
}

/// A fault to inject at one call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultInjection {
    /// The function whose call gets the fault.
    pub call: DeviceCall,
    /// Number of the call of that function, from 0.
    pub at: u64,
    /// The fault to inject.
    pub kind: FaultKind,
}

/// A device with an injected fault.
#[derive(Debug)]
pub struct Injected<D> {
    inner: D,
    injection: Option<FaultInjection>,
    calls: [u64; 5],
    gone: bool,
    halved: bool,
    last: Option<Sensed>,
    repeats: bool,
    shift_m: f64,
    off: Option<super::SwitchOff>,
}

impl<D: HapticDevice> Injected<D> {
    /// Wraps a device. Without an injection it behaves as that device, bit for bit.
    pub fn new(inner: D, injection: Option<FaultInjection>) -> Self {
        Self {
            inner,
            injection,
            calls: [0; 5],
            gone: false,
            halved: false,
            last: None,
            repeats: false,
            shift_m: 0.0,
            off: None,
        }
    }

    /// The wrapped device.
    pub fn inner(&mut self) -> &mut D {
        &mut self.inner
    }

    /// Counts a call. Returns the fault to inject into it, if any.
    ///
    /// # Errors
    /// The injected fault makes this call fail.
    fn hit(&mut self, call: DeviceCall) -> Result<Option<FaultKind>, HapticFault> {
        let count = &mut self.calls[call as usize];
        let number = *count;
        *count += 1;
        let kind = self
            .injection
            .filter(|what| what.call == call && what.at == number)
            .map(|what| what.kind);
        match kind {
            Some(FaultKind::Unplugged) => {
                self.gone = true;
                // The device loses its supply, so no force acts.
                let _ = self.inner.command([0.0; 3]);
            }
            Some(FaultKind::Fails) => return Err(HapticFault::Lost(name(call), "injected".into())),
            Some(FaultKind::Held) => return Err(HapticFault::HeldElsewhere),
            Some(FaultKind::Stale) => self.repeats = true,
            Some(FaultKind::Saturated) => self.halved = true,
            Some(FaultKind::Jumps) => self.shift_m = 0.02,
            Some(FaultKind::Slow(time)) => std::thread::sleep(time),
            Some(FaultKind::SwitchedOff(cause)) => {
                self.off = Some(cause);
                let _ = self.inner.command([0.0; 3]);
            }
            Some(FaultKind::NotANumber) | None => {}
        }
        if self.gone {
            return Err(HapticFault::Lost(name(call), "unplugged".into()));
        }
        Ok(kind)
    }
}

fn name(call: DeviceCall) -> &'static str {
    match call {
        DeviceCall::Engage => "switching on",
        DeviceCall::Sense => "reading the position",
        DeviceCall::Command => "commanding the force",
        DeviceCall::Standing => "reading the state",
        DeviceCall::Release => "switching off",
    }
}

impl<D: HapticDevice> HapticDevice for Injected<D> {
    fn sheet(&self) -> &DataSheet {
        self.inner.sheet()
    }

    fn engage(&mut self) -> Result<(), HapticFault> {
        self.hit(DeviceCall::Engage)?;
        self.inner.engage()
    }

    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        let kind = self.hit(DeviceCall::Sense)?;
        if let (true, Some(last)) = (self.repeats, self.last) {
            return Ok(Sensed {
                fresh: false,
                ..last
            });
        }
        let mut sensed = self.inner.sense()?;
        sensed.position_m[0] += self.shift_m;
        self.last = Some(sensed);
        if kind == Some(FaultKind::NotANumber) {
            sensed.position_m[1] = f64::NAN;
        }
        Ok(sensed)
    }

    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        self.hit(DeviceCall::Command)?;
        if self.off.is_some() {
            return self.inner.command([0.0; 3]);
        }
        if self.halved {
            let half = force_n.map(|f| 0.5 * f);
            self.inner.command(half)?;
            return Ok(Applied::Saturated(Some(half)));
        }
        self.inner.command(force_n)
    }

    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        self.hit(DeviceCall::Standing)?;
        let standing = self.inner.standing()?;
        Ok(DeviceStanding {
            motors_on: standing.motors_on && self.off.is_none(),
            switched_off: self.off.or(standing.switched_off),
            ..standing
        })
    }

    fn release(&mut self) -> Result<(), HapticFault> {
        let hit = self.hit(DeviceCall::Release);
        let released = self.inner.release();
        hit.map(|_| ())?;
        released
    }
}
