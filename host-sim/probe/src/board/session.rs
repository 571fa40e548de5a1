//! The connection to the microcontroller behind a probe. Checks that the chip answers, that it is the expected type, and that its
//! flash can be written.

use probe_rs::probe::Probe;
use probe_rs::{Error, MemoryInterface, Permissions, Session};

use super::fault::{Fault, chain};

/// Number of the only processor core of an STM32G4.
pub(super) const CORE: usize = 0;

/// Address of the register `DBGMCU_IDCODE` (reference manual RM0440). `DEVICE` is the mask of the device number in it, `DEVICES`
/// lists the device numbers of the supported chips.
const IDCODE: u64 = 0xe004_2000;
const DEVICE: u32 = 0xfff;
const DEVICES: [(u32, &str, &[&str]); 3] = [
    (0x468, "STM32G431 or G441", &["STM32G431", "STM32G441"]),
    (
        0x469,
        "STM32G471 to G484",
        &[
            "STM32G471",
            "STM32G473",
            "STM32G474",
            "STM32G483",
            "STM32G484",
        ],
    ),
    (0x479, "STM32G491 or G4A1", &["STM32G491", "STM32G4A1"]),
];
/// Address of the register `FLASH_OPTR` (reference manual RM0440). `PROTECTION` is the mask of the read protection in it,
/// `UNPROTECTED` the value for no protection (level 0).
const OPTIONS: u64 = 0x4002_2020;
const PROTECTION: u32 = 0xff;
const UNPROTECTED: u32 = 0xaa;

/// The microcontroller of a board, connected through a probe.
#[derive(Debug)]
pub struct Attached {
    pub(super) session: Session,
    /// Name of the probe in error messages.
    pub(super) place: String,
    /// Name of the microcontroller in error messages.
    pub(super) chip: String,
}

/// Connects to the microcontroller through an open probe, and checks that it is of the type `chip`.
///
/// The crate probe-rs halts the processor for some milliseconds, to remove breakpoints that another program may have left.
///
/// # Errors
/// The microcontroller does not answer, is of another type, or is protected against reading.
pub fn attach((probe, place): (Probe, String), chip: &str) -> Result<Attached, Fault> {
    let session = probe
        .attach(chip, Permissions::default())
        .map_err(|error| unreached(&place, chip, &error))?;
    let mut attached = Attached {
        session,
        place,
        chip: chip.to_owned(),
    };
    attached.is_the_chip()?;
    attached.is_unlocked()?;
    Ok(attached)
}

impl Attached {
    /// Reads a 32-bit word from an address of the microcontroller.
    pub(super) fn word(&mut self, address: u64) -> Result<u32, Fault> {
        let read = |session: &mut Session| session.core(CORE)?.read_word_32(address);
        read(&mut self.session).map_err(|error| self.broken(&error))
    }

    /// Fills `bytes` from the microcontroller's memory, beginning at `address`.
    pub(super) fn bytes(&mut self, address: u64, bytes: &mut [u8]) -> Result<(), Fault> {
        let read = |session: &mut Session, bytes| session.core(CORE)?.read(address, bytes);
        read(&mut self.session, bytes).map_err(|error| self.broken(&error))
    }

    /// Makes the error for a lost connection to the probe or to the chip.
    pub(super) fn broken(&self, error: &(dyn std::error::Error + 'static)) -> Fault {
        Fault::of(
            &self.place,
            format!("lost the {}: {}", self.chip, chain(error)),
            "check cable and supply, and try again",
        )
    }

    fn is_the_chip(&mut self) -> Result<(), Fault> {
        let device = self.word(IDCODE)? & DEVICE;
        let known = DEVICES.iter().find(|(number, ..)| *number == device);
        let is_it =
            known.is_some_and(|(.., names)| names.iter().any(|name| self.chip.starts_with(name)));
        if is_it {
            return Ok(());
        }
        let there = known.map_or_else(
            || format!("a chip with the device number {device:#05x}"),
            |(number, name, _)| format!("an {name} (device number {number:#05x})"),
        );
        Err(Fault::of(
            &self.place,
            format!(
                "the probe is connected to {there}, not to the {} of this board",
                self.chip
            ),
            "name the board that is connected: --board BOARD",
        ))
    }

    /// Checks that the microcontroller does not protect its flash against a probe.
    fn is_unlocked(&mut self) -> Result<(), Fault> {
        match self.word(OPTIONS)? & PROTECTION {
            UNPROTECTED => Ok(()),
            level => Err(Fault::of(
                &self.chip,
                format!("its flash is protected against reading (RDP {level:#04x}, level 1)"),
                "remove the protection with the maker's STM32CubeProgrammer, which erases the flash",
            )),
        }
    }
}

fn unreached(place: &str, chip: &str, error: &Error) -> Fault {
    match error {
        Error::ChipNotFound(_) => Fault::of(
            chip,
            format!("is not known: {}", chain(error)),
            "report this as a bug",
        ),
        _ => Fault::of(
            place,
            format!("no {chip} answers the probe: {}", chain(error)),
            "switch on the board's supply and try again; a permanently locked chip (RDP level 2) never answers",
        ),
    }
}
