//! A virtual keyboard of the Linux kernel, created through `/dev/uinput`. The keyboard vanishes when the program ends.

use crate::{KeyPair, Keyboard, OPTION};
use evdev::uinput::VirtualDevice;
use evdev::{AttributeSet, KeyCode, KeyEvent};
use std::io::ErrorKind;
use touchstone_sim::error::{Error, Result};

/// Name by which the system lists the keyboard.
const NAME: &str = "Touchstone knob";

struct Kernel {
    device: VirtualDevice,
    keys: [(String, KeyCode); 2],
}

/// Makes a keyboard with these two keys.
///
/// # Errors
/// A name belongs to no key; there is no `/dev/uinput`, or it may not be opened.
pub fn open(keys: &KeyPair) -> Result<Box<dyn Keyboard>> {
    let keys = [named(&keys.up)?, named(&keys.down)?];
    let codes: AttributeSet<KeyCode> = keys.iter().map(|(_, code)| *code).collect();
    let device = VirtualDevice::builder()
        .and_then(|builder| builder.name(NAME).with_keys(&codes)?.build())
        .map_err(|error| refused(&error))?;
    Ok(Box::new(Kernel { device, keys }))
}

fn named(name: &str) -> Result<(String, KeyCode)> {
    match format!("KEY_{}", name.to_uppercase()).parse() {
        Ok(code) => Ok((name.to_owned(), code)),
        Err(_) => Err(Error::Option {
            option: OPTION.into(),
            problem: format!("there is no key {name}"),
            fix: "give a name of linux/input-event-codes.h without KEY_, such as volumeup, left, pagedown, kpplus, a or f13"
                .into(),
        }),
    }
}

fn refused(error: &std::io::Error) -> Error {
    let (problem, fix) = match error.kind() {
        ErrorKind::NotFound => (
            "there is no /dev/uinput".to_owned(),
            "load the kernel's module: sudo modprobe uinput",
        ),
        ErrorKind::PermissionDenied => (
            "you have no permission to write to /dev/uinput".to_owned(),
            "allow it until the next restart: sudo setfacl -m u:$USER:rw /dev/uinput; or permanently by a udev rule: KERNEL==\"uinput\", TAG+=\"uaccess\"",
        ),
        _ => (
            format!("/dev/uinput cannot create a keyboard: {error}"),
            "check that the kernel has uinput and that this is not a container",
        ),
    };
    Error::Option {
        option: OPTION.into(),
        problem,
        fix: fix.into(),
    }
}

impl Keyboard for Kernel {
    fn set(&mut self, key: &str, is_down: bool) -> std::io::Result<()> {
        for (name, code) in &self.keys {
            if name == key {
                return self.device.emit(&[*KeyEvent::new(*code, is_down.into())]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_the_kernels_names() {
        for (name, code) in [
            ("volumeup", 115),
            ("volumedown", 114),
            ("a", 30),
            ("f13", 183),
        ] {
            assert_eq!(named(name).unwrap().1.code(), code, "{name}");
        }
        let said = named("nosuchkey").unwrap_err().to_string();
        assert!(
            said.contains("nosuchkey") && said.contains("volumeup"),
            "{said}"
        );
    }

    #[test]
    fn what_is_missing_is_named() {
        for (kind, part) in [
            (ErrorKind::NotFound, "modprobe uinput"),
            (ErrorKind::PermissionDenied, "setfacl"),
            (ErrorKind::InvalidInput, "container"),
        ] {
            let said = refused(&kind.into()).to_string();
            assert!(
                said.starts_with("--keys: ") && said.contains(part),
                "{said}"
            );
        }
    }

    /// Presses keys on a keyboard of the kernel and reads them back, if the system permits it; otherwise the test passes.
    #[test]
    fn the_kernel_passes_presses_on() {
        let (up, down) = (KeyCode::KEY_F23, KeyCode::KEY_F24);
        let codes: AttributeSet<KeyCode> = [up, down].into_iter().collect();
        let made = VirtualDevice::builder()
            .and_then(|builder| builder.name("Touchstone test").with_keys(&codes)?.build());
        let mut device = match made {
            Ok(device) => device,
            Err(error) => {
                eprintln!("not run: {}", refused(&error));
                return;
            }
        };
        std::thread::sleep(std::time::Duration::from_millis(500));
        let node = device.enumerate_dev_nodes_blocking().unwrap();
        let path = node.flatten().next();
        let Some(mut read) = path.and_then(|path| evdev::Device::open(path).ok()) else {
            eprintln!("not run: the keyboard's node cannot be read");
            return;
        };
        let mut kernel = Kernel {
            device,
            keys: [("f23".into(), up), ("f24".into(), down)],
        };
        let keys: KeyPair = "f23,f24".parse().unwrap();
        keys.press(&mut kernel, 2).unwrap();
        keys.press(&mut kernel, -1).unwrap();
        let mut seen = Vec::new();
        while seen.len() < 6 {
            seen.extend(read.fetch_events().unwrap().filter_map(
                |event| match event.destructure() {
                    evdev::EventSummary::Key(_, code, value) => Some((code, value)),
                    _ => None,
                },
            ));
        }
        assert_eq!(
            seen,
            [(up, 1), (up, 0), (up, 1), (up, 0), (down, 1), (down, 0)]
        );
    }
}
