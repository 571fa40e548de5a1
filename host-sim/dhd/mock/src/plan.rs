//! The mock's plan of faults. Each line is one of the following. CALL is a function of the library, AT the number of the first
//! affected call of this function, counted from 0, TIMES the number of affected calls:
//!
//! ```text
//! fail CALL AT TIMES ERROR   these calls return -1 with this error number
//! unplug CALL AT             from this call on the device is gone
//! stale AT TIMES             the position is not read again: the call returns 1
//! freeze AT TIMES            the same, but the call returns 0 as for a new position
//! nan AT                     a coordinate is NaN
//! saturate AT TIMES          the motors give half the force: the call returns 2
//! slow CALL AT MS            the call takes this time, in ms
//! off AT CAUSE               at this dhdGetStatus the device has switched itself off
//! held                       another program has the device open
//! absent | uncalibrated      there is no device, or it is not calibrated
//! type N                     the number that dhdGetSystemType returns
//! status N                   how many words dhdGetStatus writes (17 without this line)
//! own-clock                  time passes only in calls and waits
//! ```

/// One line of the plan of faults.
#[derive(Debug, Clone, PartialEq)]
pub enum Planned {
    Fail(String, u64, u64, i32),
    Unplug(String, u64),
    Stale(u64, u64),
    Freeze(u64, u64),
    NotANumber(u64),
    Saturate(u64, u64),
    Slow(String, u64, f64),
    Off(u64, i32),
    Held,
    Absent,
    Uncalibrated,
    Type(i32),
    StatusWords(usize),
    OwnClock,
}

/// Parses a line of the plan of faults; `None` for a text that is no such line.
pub fn parse(line: &str) -> Option<Planned> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words.get(i)?.parse::<u64>().ok();
    let name = |i: usize| words.get(i).map(|word| (*word).to_owned());
    let signed = |i: usize| words.get(i)?.parse::<i32>().ok();
    Some(match *words.first()? {
        "fail" => Planned::Fail(name(1)?, number(2)?, number(3)?, signed(4)?),
        "unplug" => Planned::Unplug(name(1)?, number(2)?),
        "stale" => Planned::Stale(number(1)?, number(2)?),
        "freeze" => Planned::Freeze(number(1)?, number(2)?),
        "nan" => Planned::NotANumber(number(1)?),
        "saturate" => Planned::Saturate(number(1)?, number(2)?),
        "slow" => Planned::Slow(name(1)?, number(2)?, number(3)? as f64 * 1e-3),
        "off" => Planned::Off(number(1)?, signed(2)?),
        "held" => Planned::Held,
        "absent" => Planned::Absent,
        "uncalibrated" => Planned::Uncalibrated,
        "type" => Planned::Type(signed(1)?),
        "status" => Planned::StatusWords(usize::try_from(number(1)?).ok()?),
        "own-clock" => Planned::OwnClock,
        _ => return None,
    })
}

/// Whether call `number` is one of the `times` calls that begin with call `at`.
pub fn among(number: u64, at: u64, times: u64) -> bool {
    number >= at && number - at < times
}
