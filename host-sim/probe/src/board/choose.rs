//! Chooses the debug probe: the one that the user names, or the only connected one.

use std::io::ErrorKind;

use probe_rs::probe::list::{Accessibility, Lister, ProbeListItem};
use probe_rs::probe::{DebugProbeError, DebugProbeSelector, Probe, ProbeCreationError};

use super::fault::{Fault, NO_RIGHTS, chain, system};

/// What an error message names as its subject if the error concerns no single probe.
const PROBE: &str = "probe";
/// The command-line option by which the user names a probe.
const OPTION: &str = "--probe";

/// A debug probe that is connected by USB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectedProbe {
    /// The text by which the option `--probe` names the probe: `VID:PID:SERIAL`, or `VID:PID-INTERFACE:SERIAL` if the probe has
    /// an interface number; without `:SERIAL` if the probe has no serial number.
    pub selector: String,
    /// The name that the probe reports.
    pub name: String,
    /// Whether the operating system lets this user open the probe.
    pub usable: bool,
}

impl ConnectedProbe {
    fn of(item: &ProbeListItem) -> Self {
        let info = &item.info;
        let mut selector = format!("{:04x}:{:04x}", info.vendor_id, info.product_id);
        if let Some(interface) = info.interface {
            selector += &format!("-{interface}");
        }
        if let Some(serial) = &info.serial_number {
            selector += &format!(":{serial}");
        }
        Self {
            selector,
            name: info.identifier.clone(),
            usable: item.accessibility == Accessibility::Accessible,
        }
    }
}

/// Lists all debug probes that are connected to this computer.
pub fn found(lister: &Lister) -> Vec<ConnectedProbe> {
    let items = lister.list_all_with_access();
    items.iter().map(ConnectedProbe::of).collect()
}

/// Opens the probe that the user names (`wanted`), or the only connected one. Returns the probe and its name for messages.
///
/// # Errors
/// `wanted` is not a probe's name, no probe or more than one fits, or the operating system does not let the probe be opened.
pub fn open(lister: &Lister, wanted: Option<&str>) -> Result<(Probe, String), Fault> {
    let selector = wanted.map(parsed).transpose()?;
    let items = lister.list_with_access(selector.as_ref());
    let item = match &items[..] {
        [] => return Err(none(lister, wanted)),
        [item] => item,
        several => return Err(too_many(several)),
    };
    let found = ConnectedProbe::of(item);
    let place = format!("{PROBE} {}", found.selector);
    if !found.usable {
        return Err(Fault::of(
            place,
            "cannot be opened: this user has no permission",
            NO_RIGHTS,
        ));
    }
    // Opened through the lister, which knows the probe's driver.
    match lister.open(DebugProbeSelector::from(&item.info)) {
        Ok(probe) => Ok((probe, place)),
        Err(error) => Err(not_opened(place, &error)),
    }
}

fn parsed(wanted: &str) -> Result<DebugProbeSelector, Fault> {
    wanted.parse().map_err(|_| {
        Fault::asked(
            OPTION,
            format!("\"{wanted}\" is not the name of a probe"),
            "give VID:PID or VID:PID:SERIAL, the numbers in hexadecimal, such as 0483:374e",
        )
    })
}

fn none(lister: &Lister, wanted: Option<&str>) -> Fault {
    let others = found(lister);
    let connect =
        "connect the board by its ST-LINK's USB connector, with a cable that carries data";
    match wanted {
        Some(wanted) if !others.is_empty() => Fault::of(
            format!("{PROBE} {wanted}"),
            format!("is not connected, but {} is", named(&others)),
            "choose the connected one, or connect the other",
        ),
        Some(wanted) => Fault::of(format!("{PROBE} {wanted}"), "is not connected", connect),
        None => Fault::of(PROBE, "no debug probe is connected by USB", connect),
    }
}

fn too_many(items: &[ProbeListItem]) -> Fault {
    let all: Vec<ConnectedProbe> = items.iter().map(ConnectedProbe::of).collect();
    Fault::of(
        PROBE,
        format!("there are {}: {}", all.len(), named(&all)),
        format!("choose one: {OPTION} {}", all[0].selector),
    )
}

fn named(probes: &[ConnectedProbe]) -> String {
    let names = probes
        .iter()
        .map(|probe| format!("{} ({})", probe.selector, probe.name));
    names.collect::<Vec<_>>().join(", ")
}

fn not_opened(place: String, error: &DebugProbeError) -> Fault {
    use DebugProbeError::ProbeCouldNotBeCreated;
    let problem = format!("cannot be opened: {}", chain(error));
    match (system(error), error) {
        (Some(ErrorKind::PermissionDenied), _) => Fault::of(place, problem, NO_RIGHTS),
        (Some(ErrorKind::ResourceBusy), _)
        | (None, ProbeCouldNotBeCreated(ProbeCreationError::CouldNotOpen)) => Fault::of(
            place,
            problem,
            "end the other program that uses it; if there is none, run `touchstone doctor`",
        ),
        _ => Fault::of(
            place,
            problem,
            "connect it again; a very old ST-LINK needs a firmware update by its maker's tool",
        ),
    }
}
