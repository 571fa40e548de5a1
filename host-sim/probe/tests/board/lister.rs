//! Simulated boards, each with its debug probe, that tests connect to the computer.

use std::fmt;
use std::sync::{Arc, Mutex};

use probe_rs::probe::list::{Accessibility, Lister, ProbeListItem, ProbeLister};
use probe_rs::probe::{
    DebugProbe, DebugProbeError, DebugProbeInfo, DebugProbeSelector, Probe, ProbeCreationError,
    ProbeFactory,
};

use crate::flash_memory::FlashMemory;
use crate::machine::Machine;
use crate::memory::Memory;
use crate::probe::SoftProbe;

/// A simulated problem with a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    None,
    /// The operating system reports, when it lists the probe, that this user may not open it.
    NoRights,
    /// The operating system refuses to open the probe for this user, but lists it without a hint.
    NoRightsWhenOpened,
    /// Another program has opened the probe.
    Busy,
    /// No chip answers on the wires of the probe.
    Silent,
}

/// A simulated board, with the serial number of its debug probe.
#[derive(Clone)]
pub struct Board {
    pub machine: Arc<Mutex<Machine>>,
    serial: &'static str,
    trouble: Trouble,
}

impl Board {
    /// A board with an STM32G474: 512 KiB of flash in two banks, 128 KiB of RAM.
    pub fn g474(serial: &'static str) -> Self {
        Self::of(serial, 0x469, FlashMemory::new(0x8_0000, true), 0x2_0000)
    }

    /// A board with an STM32G431: 128 KiB of flash, 32 KiB of RAM.
    pub fn g431(serial: &'static str) -> Self {
        Self::of(serial, 0x468, FlashMemory::new(0x2_0000, false), 0x8000)
    }

    fn of(serial: &'static str, device: u32, flash: FlashMemory, ram_bytes: usize) -> Self {
        let memory = Memory::new(device, flash, ram_bytes);
        Self {
            machine: Arc::new(Mutex::new(Machine::new(memory))),
            serial,
            trouble: Trouble::None,
        }
    }

    pub fn with(mut self, trouble: Trouble) -> Self {
        self.trouble = trouble;
        self
    }
}

/// Returns a probe-rs `Lister` that finds the probes of these simulated boards.
pub fn connected(boards: &[&Board]) -> Lister {
    let boards = boards.iter().map(|board| (*board).clone()).collect();
    Lister::with_lister(Box::new(Boards(boards)))
}

struct Boards(Vec<Board>);

impl fmt::Debug for Boards {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} boards", self.0.len())
    }
}

impl Boards {
    fn all(&self) -> impl Iterator<Item = (&Board, DebugProbeInfo)> {
        self.0.iter().map(|board| {
            let serial = Some(board.serial.to_owned());
            let info =
                DebugProbeInfo::new("STLINK-V3", 0x0483, 0x374e, serial, &Maker, None, false);
            (board, info)
        })
    }
}

impl ProbeLister for Boards {
    fn open(&self, selector: &DebugProbeSelector) -> Result<Probe, DebugProbeError> {
        let mut all = self.all();
        let (board, _) = all
            .find(|(_, info)| selector.matches_probe(info))
            .ok_or(ProbeCreationError::NotFound)?;
        let usb = |kind: std::io::ErrorKind| Err(ProbeCreationError::Usb(kind.into()).into());
        match board.trouble {
            Trouble::NoRightsWhenOpened => usb(std::io::ErrorKind::PermissionDenied),
            Trouble::Busy => usb(std::io::ErrorKind::ResourceBusy),
            Trouble::NoRights => panic!("opened without the right to"),
            trouble => Ok(Probe::new(SoftProbe::new(
                Arc::clone(&board.machine),
                trouble != Trouble::Silent,
            ))),
        }
    }

    fn list_with_access(&self, selector: Option<&DebugProbeSelector>) -> Vec<ProbeListItem> {
        self.all()
            .filter(|(_, info)| selector.is_none_or(|selector| selector.matches_probe(info)))
            .map(|(board, info)| ProbeListItem {
                info,
                accessibility: match board.trouble {
                    Trouble::NoRights => Accessibility::PermissionDenied,
                    _ => Accessibility::Accessible,
                },
            })
            .collect()
    }
}

/// A factory of simulated probes. The crate probe-rs needs one in a probe's description, only for its name.
#[derive(Debug)]
struct Maker;

impl fmt::Display for Maker {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("software")
    }
}

impl ProbeFactory for Maker {
    fn open(&self, _: &DebugProbeSelector) -> Result<Box<dyn DebugProbe>, DebugProbeError> {
        Err(ProbeCreationError::NotFound.into())
    }

    fn list_probes(&self) -> Vec<ProbeListItem> {
        Vec::new()
    }
}
