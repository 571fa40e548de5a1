//! The error with which a command ends that had switched a device's motors on.

use touchstone_device::haptic::HapticFault;
use touchstone_device::servo::Ending;
use touchstone_sim::error::{Error, Result};

/// Checks how a servo loop ended and whether the device was released. `place` is the device's name in the error.
///
/// # Errors
/// A fault, a failed release, or both in one error: after a failed release the motors may still be on, whatever else went wrong.
pub fn ended(
    ending: &Ending,
    release: &std::result::Result<(), HapticFault>,
    place: &str,
) -> Result<()> {
    match (ending, release) {
        (Ending::Asked, Ok(())) => Ok(()),
        (Ending::Fault(fault), Ok(())) => Err(fault.at(place)),
        (Ending::Asked, Err(left_on)) => Err(may_be_on(place, "", left_on, left_on.fix())),
        (Ending::Fault(fault), Err(left_on)) => Err(may_be_on(
            place,
            &format!("{fault}; "),
            left_on,
            fault.fix(),
        )),
    }
}

fn may_be_on(place: &str, before: &str, left_on: &HapticFault, fix: &str) -> Error {
    Error::device(
        place,
        format!("{before}the motors may still be on: {left_on}"),
        format!("switch its supply off; then {fix}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_release_is_told_with_and_without_a_fault() {
        let lost = || HapticFault::Lost("dhdStop", "no device".into());
        let faulty = Ending::Fault(HapticFault::Stale(0.006));
        for (ending, release, parts) in [
            (&faulty, Ok(()), &["no new position for 6.0 ms; check"][..]),
            (
                &Ending::Asked,
                Err(lost()),
                &[
                    "omega.3: the motors may still be on: dhdStop failed: no device",
                    "; switch its supply off; then check its supply",
                ],
            ),
            (
                &faulty,
                Err(lost()),
                &[
                    "no new position for 6.0 ms; the motors may still be on: dhdStop failed",
                    "; switch its supply off; then check the cable",
                ],
            ),
        ] {
            let said = ended(ending, &release, "omega.3")
                .expect_err("it failed")
                .to_string();
            for part in parts {
                assert!(said.contains(part), "{part}: {said}");
            }
        }
        assert!(ended(&Ending::Asked, &Ok(()), "omega.3").is_ok());
    }
}
