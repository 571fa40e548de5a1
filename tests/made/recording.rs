//! Generates recordings of a hand's motion as CSV text. Checks that each is read, or refused with a one-line message.

use super::choices::Choices;
use std::fmt::Write as _;
use std::path::Path;
use touchstone_sim::scene::Recording;

/// Makes a random recording: a header and rows, most of them valid, now and then an invalid one.
pub fn made(seeded: &mut impl Choices) -> String {
    let times = ["time_s", "t_ms", "Time [us]", "seconds", "time", "°"];
    let angles = [
        "angle_rad",
        "Winkel in °",
        "q[deg]",
        "turn_rev",
        "omega [rad/s]",
    ];
    let ends = ["\n", "\r\n", "\r"];
    let (end, odd) = (ends[seeded.below(3)], seeded.below(30) + 1);
    let mut text = format!(
        "{},{}{}{end}",
        seeded.of(&times),
        seeded.of(&angles),
        seeded.of(&["", "", "", "", "", "", ",x", ",\"a"])
    );
    let mut time = [0.0, 0.0, 0.0, 1.7e9, -1e300][seeded.below(5)];
    for _ in 0..seeded.below(20) {
        time += [1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0, 1e-12, 3600.0][seeded.below(8)];
        let angle = seeded.below(1000) as f64 / 500.0 - 1.0;
        let _ = match seeded.below(10 * odd) {
            0 => write!(text, "{time}{end}"),
            1 => write!(
                text,
                "{time},{},{angle}{end}",
                seeded.of(&["NaN", "inf", "", "1e308", "\u{feff}", "0x1"])
            ),
            2 => write!(text, "# {time}{end}"),
            3 => write!(text, "{end}{end}"),
            4 => write!(text, "\"{time}\",\"{angle}\"{end}"),
            _ => write!(text, "{time},{angle}{end}"),
        };
    }
    text
}

/// Whether a recording is accepted. For an accepted one, also computes the remarks that the program prints on it.
pub fn is_read(text: &str) -> bool {
    match Recording::parse(text, Path::new("m.csv")) {
        Ok(recording) => {
            let _ = recording.odd();
            true
        }
        Err(error) => {
            let error = error.to_string();
            assert!(
                !error.contains('\n') && error.len() < 500,
                "{error}\n{text}"
            );
            false
        }
    }
}
