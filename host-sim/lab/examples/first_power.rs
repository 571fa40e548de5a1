//! Draws the electrical signals to expect at a board's first power-up. `first_power FOLDER OUT` reads the CSV tables that
//! `touchstone-emulator trace` wrote into FOLDER and writes SVG pictures into OUT. `cargo xtask traces` runs both programs.

use std::error::Error;
use std::path::Path;

use touchstone_report::drawn;
use touchstone_report::figure::{Axis, Figure, Range, Shape};
use touchstone_report::svg::Size;

/// Voltage of a pin at high level, V.
const HIGH_V: f64 = 3.3;
/// Vertical distance between the curves of two pins in a picture, V.
const APART_V: f64 = 5.0;
const NARROW: Size = Size {
    width: 360,
    height: 230,
};
const WIDE: Size = Size {
    width: 540,
    height: 260,
};

type Drawn = Result<String, Box<dyn Error>>;
/// File name of a picture, and the function that draws it from the tables in a folder.
type Picture = (&'static str, fn(&Path) -> Drawn);

const PICTURES: [Picture; 4] = [
    ("pwm.svg", pwm),
    ("step.svg", step),
    ("calibration.svg", calibration),
    ("press.svg", press),
];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [tables, out] = &words[..] else {
        return Err("first_power needs the folder of the tables and that of the pictures".into());
    };
    std::fs::create_dir_all(out)?;
    for (name, draws) in PICTURES {
        std::fs::write(Path::new(out).join(name), draws(Path::new(tables))?)?;
    }
    Ok(())
}

/// A CSV table: column names and the cells of each row.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(folder: &Path, name: &str) -> Result<Self, Box<dyn Error>> {
        let mut reader = csv::Reader::from_path(folder.join(name))?;
        let names = reader.headers()?.iter().map(str::to_owned).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            rows.push(record?.iter().map(str::to_owned).collect());
        }
        Ok(Self { names, rows })
    }

    fn words(&self, name: &str) -> Result<Vec<&str>, String> {
        let at = self.names.iter().position(|it| it == name);
        let at = at.ok_or_else(|| format!("no column {name}"))?;
        Ok(self.rows.iter().map(|row| row[at].as_str()).collect())
    }

    fn numbers(&self, name: &str) -> Result<Vec<f64>, Box<dyn Error>> {
        let cells = self.words(name)?;
        Ok(cells
            .iter()
            .map(|it| it.parse())
            .collect::<Result<_, _>>()?)
    }

    /// Time in seconds and value of the named column, row by row.
    fn course(&self, name: &str) -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
        let times = self.numbers("time_s")?;
        Ok(times.into_iter().zip(self.numbers(name)?).collect())
    }
}

fn time(min: f64, max: f64) -> Axis {
    Axis::new("time", "s", Range { min, max })
}

/// Corner points of the curve of a pin's level (0 or 1), drawn `above` volts higher, from pairs of time and level.
fn corners(levels: &[(f64, f64)], above: f64) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (index, &(at, level)) in levels.iter().enumerate() {
        let volts = above + level * HIGH_V;
        match points.last() {
            Some(&(_, before)) if before == volts && index + 1 < levels.len() => continue,
            Some(&(_, before)) => points.extend([(at, before), (at, volts)]),
            None => points.push((at, volts)),
        }
    }
    points
}

/// Draws the two pins of motor phase U between the times `from` and `to` in seconds, with lines at the times at which currents are
/// sampled.
fn pins(
    table: &Table,
    title: &str,
    [lower, upper]: [&str; 2],
    from: f64,
    to: f64,
) -> Result<Figure, Box<dyn Error>> {
    let range = Range {
        min: -0.5,
        max: APART_V + HIGH_V + 0.5,
    };
    let mut y = Axis::new(&format!("{upper} (below), {lower} (above)"), "V", range);
    let marks = [0.0, HIGH_V].map(|volts| (volts, format!("{volts}")));
    let above = [0.0, HIGH_V].map(|volts| (volts + APART_V, format!("{volts}")));
    y.marks = Some(marks.into_iter().chain(above).collect());
    let mut figure = Figure::new(title, time(from, to), y);
    let shown = |course: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
        let seen = |(at, _): &(f64, f64)| (from..=to).contains(at);
        course.into_iter().filter(seen).collect()
    };
    let times = table.numbers("time_s")?;
    let samples = table.words("samples")?.into_iter().zip(&times);
    let mut name = "currents are sampled";
    for (_, at) in
        samples.filter(|(what, at)| what.contains("current") && **at <= to && **at >= from)
    {
        figure.line("kc", name, Shape::Vertical(*at));
        name = "";
    }
    for (column, role, name, above) in [
        ("upper_u", "force", upper, 0.0),
        ("lower_u", "law-a", lower, APART_V),
    ] {
        let levels = shown(table.course(column)?);
        figure.line(role, name, Shape::Series(corners(&levels, above)));
    }
    Ok(figure)
}

fn pwm(folder: &Path) -> Drawn {
    let (shield, larger) = (
        Table::read(folder, "pwm.csv")?,
        Table::read(folder, "pwm-ihm08m1.csv")?,
    );
    // Dead time of the larger shield, between the falling edges of its two pins. Its lower transistors are on while their pin is
    // low.
    let falls = |name: &str| -> Result<f64, Box<dyn Error>> {
        let course = larger.course(name)?;
        let fall = course
            .windows(2)
            .find(|pair| pair[0].1 > 0.5 && pair[1].1 < 0.5);
        Ok(fall.ok_or("a pin that does not fall")?[1].0)
    };
    let (off, on) = (falls("upper_u")?, falls("lower_u")?);
    let mut figures = [
        pins(
            &shield,
            "X-NUCLEO-IHM16M1",
            ["PB13, EN1", "PA8, IN1"],
            0.0,
            1.1e-4,
        )?,
        pins(
            &larger,
            "X-NUCLEO-IHM08M1",
            ["PA7, LIN", "PA8, HIN"],
            0.0,
            1.1e-4,
        )?,
        pins(
            &larger,
            "The same, one edge",
            ["PA7, LIN", "PA8, HIN"],
            off - 1e-6,
            off + 2e-6,
        )?,
    ];
    figures[0].description = "Enabled for good; IN chooses the transistor.".into();
    figures[1].description = "LIN low is the lower transistor on.".into();
    figures[2].description = format!("{:.2} µs with both transistors off.", (on - off) * 1e6);
    Ok(drawn(
        "The bridge's pins of phase U, a wall on and nobody at it, as the emulated timer drives them",
        &figures,
        NARROW,
    ))
}

fn step(folder: &Path) -> Drawn {
    let table = Table::read(folder, "step.csv")?;
    let phases = ["current_u_a", "current_v_a", "current_w_a"];
    let [u, v, w] = phases.map(|name| table.course(name));
    let phases = [u?, v?, w?];
    let push = table.numbers("push_a")?[0];
    let amplitude: Vec<(f64, f64)> = (0..phases[0].len())
        .map(|row| {
            let squares: f64 = phases.iter().map(|phase| phase[row].1.powi(2)).sum();
            (phases[0][row].0, (squares * 2.0 / 3.0).sqrt())
        })
        .collect();
    let end = amplitude.last().ok_or("an empty table")?.0;
    let reached = amplitude
        .iter()
        .find(|(_, amps)| *amps >= (1.0 - (-1f64).exp()) * push);
    let reached = reached.ok_or("the current is not reached")?.0;
    let range = Range {
        min: -1.2 * push,
        max: 1.2 * push,
    };
    let mut figure = Figure::new(
        "A torque begins",
        time(-5e-4, end.min(3e-3)),
        Axis::new("current into a phase", "A", range),
    );
    figure.line("kc", "asked for", Shape::Horizontal(push));
    let drawn_as = [("law-a", "U"), ("law-d", "V"), ("law-c", "W")];
    for ((role, name), phase) in drawn_as.into_iter().zip(phases) {
        figure.line(role, name, Shape::Series(phase));
    }
    figure.line("force", "amplitude of the three", Shape::Series(amplitude));
    figure.description = format!(
        "From 10 % (time 0) to 63 % of {:.0} mA in {:.2} ms; which phase takes how much is where the rotor stands.",
        push * 1e3,
        reached * 1e3
    );
    Ok(drawn(
        "The phases' currents where a torque begins, X-NUCLEO-IHM16M1",
        &[figure],
        WIDE,
    ))
}

fn calibration(folder: &Path) -> Drawn {
    let table = Table::read(folder, "calibration.csv")?;
    let (angle, current) = (table.course("angle_deg")?, table.course("current_u_a")?);
    let end = angle.last().ok_or("an empty table")?.0;
    let of = |course: &[(f64, f64)]| {
        Range::of(course.iter().map(|(_, value)| *value)).padded(0.05, 0.05)
    };
    let (angles, currents) = (of(&angle), of(&current));
    let mut y = Axis::new("shaft, degrees", "", angles);
    y.range = angles;
    let mut shaft = Figure::new("The shaft", time(0.0, end), y);
    shaft.description = format!(
        "From {:.0} to {:.0} degrees of where it stood; ready after {end:.1} s.",
        Range::of(angle.iter().map(|it| it.1)).min,
        Range::of(angle.iter().map(|it| it.1)).max
    );
    shaft.line("force", "", Shape::Series(angle));
    let axis = Axis::new("current into phase U", "A", currents);
    let mut probe = Figure::new("A phase", time(0.0, end), axis);
    let largest = current.iter().map(|it| it.1.abs()).fold(0.0, f64::max);
    probe.description = format!("{largest:.2} A at most.");
    probe.line("law-a", "", Shape::Series(current));
    Ok(drawn(
        "A calibration, X-NUCLEO-IHM16M1",
        &[shaft, probe],
        WIDE,
    ))
}

fn press(folder: &Path) -> Drawn {
    let table = Table::read(folder, "press.csv")?;
    let [depth, force, current] =
        ["penetration_rad", "force_n_m", "current_q_a"].map(|name| table.course(name));
    let (depth, force, current) = (depth?, force?, current?);
    let end = force.last().ok_or("an empty table")?.0;
    // The held press: a tenth of a second that ends 50 ticks before the last tick with a force, when the hand already lets go.
    let falls = force.iter().rposition(|(_, newton)| *newton > 0.0);
    let falls = falls.ok_or("no force")?;
    let held = falls.saturating_sub(150)..falls.saturating_sub(50);
    let mean = |course: &[(f64, f64)]| {
        course[held.clone()].iter().map(|it| it.1).sum::<f64>() / held.len() as f64
    };
    let (rad, newton, ampere) = (mean(&depth), mean(&force), mean(&current));
    let deepest = depth.iter().map(|it| it.1).fold(0.0, f64::max);
    let range = Range {
        min: -deepest,
        max: 1.2 * deepest,
    };
    let of =
        |course: &[(f64, f64)]| Range::of(course.iter().map(|(_, value)| *value)).padded(0.1, 0.1);
    let mut figures = [
        Figure::new(
            "Penetration",
            time(0.0, end),
            Axis::new("penetration", "rad", range),
        ),
        Figure::new(
            "Force",
            time(0.0, end),
            Axis::new("force, out of the wall", "N·m", of(&force)),
        ),
        Figure::new(
            "Current",
            time(0.0, end),
            Axis::new("q-axis current", "A", of(&current)),
        ),
    ];
    figures[0].description = format!("{:.1} mrad held; negative is outside.", rad * 1e3);
    figures[1].description = format!(
        "{:.1} mN·m held: {:.2} N·m/rad.",
        newton * 1e3,
        newton / rad
    );
    figures[2].description = format!("{:.0} mA held.", ampere * 1e3);
    for (figure, course) in figures.iter_mut().zip([depth, force, current]) {
        figure.line("zero", "", Shape::Horizontal(0.0));
        figure.line("force", "", Shape::Series(course));
    }
    Ok(drawn(
        "A press on a wall of 1 N·m/rad and the letting go, X-NUCLEO-IHM16M1",
        &figures,
        NARROW,
    ))
}
