//! Looks for the debug probe on USB: on Linux in the kernel's files, elsewhere through probe-rs.

use super::{Requirement, Skipped, There, missing};
use crate::flash;
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::path::Path;
use touchstone_device::is_st_link;
use touchstone_sim::harmless::one_line;

/// USB vendor number of STMicroelectronics, as in the kernel's file `idVendor`.
const VENDOR_ST: &str = "0483";

/// The udev rule that lets users access a probe, and how to install it. It covers the product numbers of all ST-LINKs that probe-rs
/// knows.
pub const INSTALL_RULE: &str = "\
sudo tee /etc/udev/rules.d/70-st-link.rules <<'RULE'
SUBSYSTEM==\"usb\", ATTRS{idVendor}==\"0483\", ATTRS{idProduct}==\"374[48abdef]\", MODE=\"0660\", TAG+=\"uaccess\"
SUBSYSTEM==\"usb\", ATTRS{idVendor}==\"0483\", ATTRS{idProduct}==\"375[23457]\", MODE=\"0660\", TAG+=\"uaccess\"
SUBSYSTEM==\"tty\", ATTRS{idVendor}==\"0483\", ATTRS{idProduct}==\"37[45][0-9a-f]\", MODE=\"0660\", TAG+=\"uaccess\"
RULE
sudo udevadm control --reload && sudo udevadm trigger
then disconnect the board and connect it again";

/// Looks for ST-LINK probes, and checks whether this user may access them.
pub fn examine(sysfs: &Path, dev: &Path, tell: &mut impl FnMut(&str, Requirement)) {
    let devices = sysfs.join("bus/usb/devices");
    let Ok(entries) = fs::read_dir(&devices) else {
        tell("probe", elsewhere(&devices));
        return;
    };
    let mut probes = 0;
    let mut folders: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    folders.sort();
    for folder in folders {
        let file =
            |name: &str| fs::read_to_string(folder.join(name)).map(|text| text.trim().to_owned());
        let (Ok(vendor), Ok(product)) = (file("idVendor"), file("idProduct")) else {
            continue;
        };
        let number = u16::from_str_radix(&product, 16);
        if vendor != VENDOR_ST || !number.is_ok_and(is_st_link) {
            continue;
        }
        probes += 1;
        let name = file("product").unwrap_or_else(|_| "ST-LINK".into());
        let serial = file("serial").unwrap_or_default();
        let about = one_line(&format!("{name} {vendor}:{product} {serial}"));
        tell("probe", There(about.trim().to_owned()));
        let place = file("busnum").and_then(|bus| Ok((bus, file("devnum")?)));
        tell(
            "permission",
            match place {
                Ok((bus, device)) => {
                    let node = dev.join(format!("bus/usb/{bus:0>3}/{device:0>3}"));
                    permission(&node)
                }
                Err(_) => Skipped("the kernel shows no device node for it".into()),
            },
        );
    }
    if probes == 0 {
        tell(
            "probe",
            missing(
                "no ST-LINK found on USB",
                "connect the board by its ST-LINK's USB connector, with a cable that carries data",
            ),
        );
    }
}

/// Checks whether this user may read and write a device node, by opening the node.
fn permission(node: &Path) -> Requirement {
    match OpenOptions::new().read(true).write(true).open(node) {
        Ok(_) => There(format!("{} may be used", node.display())),
        Err(error) if error.kind() == ErrorKind::PermissionDenied => missing(
            format!("this user has no permission for {}", node.display()),
            INSTALL_RULE,
        ),
        Err(error) => missing(
            format!("{}: {error}", node.display()),
            "connect the board again; in a container, pass the USB device to the container",
        ),
    }
}

/// Checks for a probe through probe-rs, on systems other than Linux and in containers without USB.
fn elsewhere(devices: &Path) -> Requirement {
    match flash::probes() {
        Some(probes) if !probes.is_empty() => There(probes.join(", ")),
        Some(_) => missing(
            "no debug probe found on USB",
            "connect the board by its ST-LINK's USB connector",
        ),
        None => missing(
            format!(
                "{} cannot be read, and probe-rs is not installed",
                devices.display()
            ),
            "connect the board; in a container, pass the USB devices to the container",
        ),
    }
}
