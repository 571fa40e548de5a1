//! Tests of recordings in the file forms that users have. Some forms must read alike, some are refused with the line, and some get
//! a warning that quotes the suspicious number.

use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::scene::{Curve, Recording};

fn read(text: &str) -> Result<Recording, String> {
    Recording::parse(text, Path::new("m.csv")).map_err(|error| error.to_string())
}

/// CSV text of one second of a sine of amplitude 0.3 rad at 1 kHz. `row` writes the line of one sample.
fn sine(header: &str, row: impl Fn(usize, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for n in 0..1000 {
        let angle = 0.3 * libm::sin(std::f64::consts::TAU * n as f64 / 1000.0);
        let _ = writeln!(text, "{}", row(n, angle));
    }
    text
}

#[test]
fn usual_headers_are_understood() {
    let plain = read(&sine("time_s,angle_rad", |n, x| {
        format!("{},{x}", n as f64 / 1e3)
    }))
    .unwrap();
    let seconds = |n: usize, x: f64| format!("{},{x},0", n as f64 / 1e3);
    let degrees = |n: usize, x: f64| format!("{},{},0", n as f64 / 1e3, x.to_degrees());
    for (text, header) in [
        ("rad", "time [s],angle [rad],omega [rad/s]"),
        ("rad", "Time (s),Angle (rad),Velocity (rad/s)"),
        ("rad", "time_s,angle_rad,velocity_rad_per_s"),
        ("rad", "time_s,angle_rad,axis_s"),
        ("rad", "seconds,angle in radians,note"),
        ("rad", "t(s),q[rad],tau[N·m]"),
        ("deg", "Zeit in s,Winkel in °,Moment"),
        ("deg", "time [s],angle [°],speed [°/s]"),
        ("deg", "time [s],angle [deg],speed [deg/s]"),
        (
            "deg",
            "elapsed seconds,angle in degrees,acceleration [deg/s²]",
        ),
    ] {
        let text = if text == "rad" {
            sine(header, seconds)
        } else {
            sine(header, degrees)
        };
        let found = read(&text).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert_eq!(found.times_s(), plain.times_s(), "{header}");
        let off = found
            .angles_rad()
            .iter()
            .zip(plain.angles_rad())
            .map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{header}");
        assert_eq!(found.odd(), Vec::<String>::new(), "{header}");
    }
    for header in ["stamp [ns],angle [rad]", "elapsed nanoseconds,angle [rad]"] {
        let found = read(&sine(header, |n, x| format!("{},{x}", n * 1_000_000))).unwrap();
        assert!((found.length_s() - 0.999).abs() < 1e-12, "{header}");
        assert_eq!(found.odd(), Vec::<String>::new(), "{header}");
    }
    let error = read(&sine("omega [rad/s],angle [rad],x", seconds)).unwrap_err();
    assert!(
        error.starts_with("m.csv:1: time: no column with a time unit"),
        "{error}"
    );
}

#[test]
fn rows_of_another_length_are_refused_by_their_line() {
    for (text, expected) in [
        (
            "time_ms,angle_deg\n0,0,000\n1,0,126\n",
            "m.csv:2: row: 3 cells, where the header has 2",
        ),
        (
            "time_s,note,angle_rad\n0,free,0\n1,a, b,1\n",
            "m.csv:3: row: 4 cells, where the header has 3",
        ),
        (
            "time_s,angle_rad,x\n0,1,2\n1,1\n",
            "m.csv:3: row: 2 cells, where the header has 3",
        ),
        (
            "time_s,angle_rad\n0,1\n\n# x\n1,2,,3\n",
            "m.csv:5: row: 4 cells, where the header has 2",
        ),
        (
            "time_s,angle_rad\ns,rad\n0,1\n1,2\n",
            "m.csv:2: time_s: \"s\" is not a number",
        ),
        (
            "time_s,angle_rad\n0,1\n1,2\ntime_s,angle_rad\n0,1\n",
            "m.csv:4: time_s: \"time_s\" is not a number",
        ),
        (
            "time_s,angle_rad\n0,1\n1,1e7\n",
            "m.csv:3: angle_rad: 10000000 is above 1000000 rad",
        ),
        (
            "time_s,angle_rad\n0,1\n1e-11,2\n4e-11,1\n",
            "m.csv:1: time_s: the recording takes 4e-11 s",
        ),
        (
            "t_ms,angle_rad\n65534,0\n65535,1\n0,1\n",
            "m.csv:4: t_ms: 0 comes after 65535, but times must rise; if a counter wrapped, add its range",
        ),
        (
            "time_s,angle_rad\n-1e308,1\n1e308,2\n",
            "m.csv:1: time_s: the recording takes inf s",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.starts_with(expected), "{error}");
    }
    // Spreadsheets may write a comma at the end of every row.
    let found = read("time_s,angle_rad\n0,1,\n1,2,,\n").unwrap();
    assert_eq!(found.angles_rad(), [1.0, 2.0]);
}

#[test]
fn what_is_odd_is_noted_by_its_number() {
    let at = |n: usize| n as f64 / 1e3;
    let angle = "time_s,angle_rad";
    for (text, expected) in [
        (
            sine(angle, |n, x| {
                format!("{},{x}", at(n) + if n < 500 { 0.0 } else { 3500.0 })
            }),
            "a gap of 3500.001 s after 0.499 s",
        ),
        (
            sine(angle, |n, x| format!("{:.3},{x}", 1.7e9 + at(n))),
            "times begin at 1700000000.000 s",
        ),
        (
            sine("time_ms,angle_rad", |n, x| {
                format!("{:.1},{x}", 1.7e12 + n as f64)
            }),
            "times begin at 1700000000.000 s",
        ),
        (
            sine(angle, |n, x| {
                format!("{},{x}", at(n) + if n < 900 { 0.0 } else { 0.2 })
            }),
            "a gap of 0.201 s after 0.899 s",
        ),
        (
            sine(angle, |n, x| {
                format!("{},{x}", at(n - n % 16) + (n % 16) as f64 * 1e-6)
            }),
            "in bursts, 1.000e-6 s apart where ",
        ),
        (
            sine(angle, |n, x| {
                format!("{},{x}", at(n - n % 8) + (n % 8) as f64 * 1e-4)
            }),
            "in bursts, 1.000e-4 s apart",
        ),
        (
            sine("time_s,angle_deg", |n, x| {
                format!("{},{}", at(n), (x.to_degrees() + 360.0) % 360.0)
            }),
            "by a whole turn between two samples",
        ),
        (
            sine(angle, |n, _| {
                format!("{},{}", at(n), (n as f64 * 0.02) % std::f64::consts::TAU)
            }),
            "two samples, 3 times",
        ),
        (
            sine(angle, |n, x| {
                format!("{},{}", at(n), if n == 500 { 1e3 } else { x })
            }),
            "is faster than a hand",
        ),
        (
            sine(angle, |n, x| format!("{},{}", at(n), x.to_degrees())),
            "such as degrees",
        ),
        // A motion too slow to be detected by its speed.
        (
            sine(angle, |n, x| format!("{},{}", 10.0 * at(n), x.to_degrees())),
            "a range of 34.4 rad is 5.5 turns: check whether angle_rad is in another unit",
        ),
        (
            sine("stamp_ns,angle_rad", |n, x| {
                format!("{},{x}", 1_764_000_000_000_000_000 + n as u64 * 1_000_000)
            }),
            "times begin at 1764000000.000 s",
        ),
        (
            sine("time_ms,angle_rad", |n, x| {
                format!("{},{x}", 0.01 * n as f64)
            }),
            "is faster than a hand",
        ),
    ] {
        let notes = read(&text).unwrap().odd();
        assert!(
            notes.iter().any(|note| note.contains(expected)),
            "{expected}: {notes:?}"
        );
    }
    // A sensor's step between two samples of a burst must not count as a high speed.
    let steps = sine(angle, |n, x| {
        format!(
            "{},{}",
            at(n - n % 16) + (n % 16) as f64 * 1e-6,
            (x / 1e-3).round() * 1e-3
        )
    });
    assert_eq!(read(&steps).unwrap().odd().len(), 1);
}

#[test]
fn the_cost_does_not_depend_on_how_samples_bunch() {
    for apart_s in [200e-6, 20e-6, 1e-6, 1e-9] {
        let times: Vec<f64> = (0..2000)
            .map(|n| 1e-3 * (n - n % 16) as f64 + apart_s * (n % 16) as f64)
            .collect();
        let values = vec![0.5; times.len()];
        let begun = Instant::now();
        let curve = Curve::smooth(&times, &values);
        assert!((curve.at(1.0) - 0.5).abs() < 1e-12);
        // The low-pass needs two million products, which take far less than the limit on any machine.
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "{apart_s} s apart"
        );
    }
}
