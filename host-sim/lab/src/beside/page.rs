//! Report page on a recording and its simulation: both courses in one picture, and their differences in numbers.

use super::{Beside, PARTS};
use touchstone_report::figure::{Axis, Figure, Range, Shape};
use touchstone_report::quantity::plain;
use touchstone_report::{Block, Section, standalone};

/// Largest number of points of a line in a picture; a picture 800 pixels wide shows no more.
const MOST: usize = 2000;

/// Sections of the report page that compares recording and simulation.
#[must_use]
pub fn sections(beside: &Beside) -> Vec<Section> {
    let section = |title: &str, body| Section {
        title: title.to_owned(),
        body,
        folded: false,
    };
    let mut numbers = vec![differences(beside)];
    if !beside.fits.is_empty() {
        numbers.push(fits(beside));
    }
    let pictures = [
        ("Position", "penetration", "rad", &beside.penetration_rad),
        ("Force", "force out of the wall", "N·m", &beside.force_n_m),
    ];
    let pictures = pictures.map(|(title, axis, unit, both)| {
        let figure = over_each_other(beside, axis, unit, both);
        Block::Figure(standalone(title, &[figure]))
    });
    vec![
        section("Recorded and simulated", pictures.to_vec()),
        section("How far apart", numbers),
    ]
}

fn over_each_other(beside: &Beside, axis: &str, unit: &str, both: &[Vec<f64>; 2]) -> Figure {
    let x = Axis::new("time", "s", Range::of(beside.time_s.iter().copied()));
    let values = both.iter().flatten().copied();
    let y = Axis::new(axis, unit, Range::of(values).padded(0.05, 0.05));
    let mut figure = Figure::new("", x, y);
    let every = beside.time_s.len().div_ceil(MOST).max(1);
    for (role, name, values) in [
        ("force", "recorded", &both[0]),
        ("hip", "simulated", &both[1]),
    ] {
        let points = beside.time_s.iter().copied().zip(values.iter().copied());
        figure.line(role, name, Shape::Series(points.step_by(every).collect()));
    }
    figure
}

fn differences(beside: &Beside) -> Block {
    let row = |it: &super::Difference| {
        vec![
            format!("{}, {}", it.what, it.unit),
            format!("{:.3e}", it.rms),
            format!("{:.1} %", 100.0 * it.share),
            format!("{:.3e}", it.worst),
            plain(it.worst_at_s),
            it.parts_at_s.map_or_else(|| "never".into(), plain),
        ]
    };
    Block::Table {
        caption: format!(
            "Over {} ticks. They count as different from where the difference first exceeds {:.0} % of the recorded range.",
            beside.time_s.len(),
            100.0 * PARTS
        ),
        header: ["what", "rms", "of its span", "worst", "at, s", "part at, s"]
            .map(str::to_owned)
            .to_vec(),
        rows: beside.differences.iter().map(row).collect(),
    }
}

fn fits(beside: &Beside) -> Block {
    Block::Table {
        caption: "Change of each property of the knob, alone, that fits the recording best, and the position's difference that would remain.".into(),
        header: ["value", "factor", "rms that stays, rad"].map(str::to_owned).to_vec(),
        rows: beside
            .fits
            .iter()
            .map(|fit| {
                vec![
                    fit.field.to_owned(),
                    format!("{:.3}", fit.factor),
                    format!("{:.3e}", fit.rms_rad),
                ]
            })
            .collect(),
    }
}
