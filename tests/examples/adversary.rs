//! Searches for the simulated hand that gets the most energy out of a device, with and without the energy guard, at four delays and
//! for every control law.
//!
//! `cargo run --release -p touchstone-tests --example adversary -- FILE.csv 1000000` spends a million evaluations with the guard,
//! for all types of hand, delays and laws together, and a tenth of that without. The default is 40,000. Each combination of hand
//! type, law and delay is one row of the file, written as soon as it is finished; the same command continues after an interruption.
//! With `shipped` at the end, capacity and force limit are the shipped ones instead of 20 mJ and 0.3 N·m.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::path::Path;
use touchstone_control::{LawKind, ObserverForm, Settings, Si};
use touchstone_lab::journal::Journal;
use touchstone_tests::adversary::Way;
use touchstone_tests::port::{Port, PortLaw, SpringDamper};

const DELAYS: [f64; 4] = [0.0, 0.1, 0.5, 1.0];
/// Control periods in one evaluation of a simulated hand. The worst hand of a search is run again for `LONGER` periods.
const TICKS: u32 = 500;
const LONGER: u32 = 20_000;
/// The energy guard's limits: capacity of its energy account in J, and force limit in N·m.
#[derive(Debug, Clone, Copy)]
struct Account {
    capacity_j: f64,
    force_limit_n_m: f64,
}

impl Account {
    /// The limits for most figures in `docs/energy-guard.md`: 20 mJ and 0.3 N·m.
    const SMALL: Self = Self {
        capacity_j: 0.02,
        force_limit_n_m: 0.3,
    };

    fn shipped() -> Self {
        let settings = Settings::default();
        Self {
            capacity_j: settings.guard.capacity.to_num(),
            force_limit_n_m: settings.force_limit.to_num(),
        }
    }

    /// Most energy in J that the energy guard lets a hand get out: the capacity, plus one encoder count times the force limit.
    fn bound_j(self) -> f64 {
        self.capacity_j + self.force_limit_n_m * touchstone_tests::port::COUNT_RAD
    }

    fn port(self, law: PortLaw, delay_ticks: f64, guarded: bool) -> Port {
        let mut port = Port::new(law, delay_ticks, true, guarded);
        port.force_limit_n_m = self.force_limit_n_m;
        if let Some(guard) = &mut port.guard {
            guard.capacity = Si::from_num(self.capacity_j);
        }
        port
    }
}

const SEED: u64 = 1;

/// The control laws that the hands meet: plain springs and dampers, a hostile damper that drives the device in its direction of
/// motion, every law with the thesis' settings, and the shipped law.
fn laws() -> Vec<(String, PortLaw)> {
    let spring = |k, b| PortLaw::from(SpringDamper { k, b });
    let mut laws = vec![
        ("spring 5".to_owned(), spring(5.0, 0.0)),
        ("spring 5, damper 0.0076".to_owned(), spring(5.0, 0.0076)),
        ("spring 20, damper 0.055".to_owned(), spring(20.0, 0.055)),
        ("hostile: damper of -10".to_owned(), spring(0.0, -10.0)),
    ];
    let thesis = Settings::thesis();
    let known = [
        ("tdpa", LawKind::Tdpa, ObserverForm::Exact),
        ("tdpa, published", LawKind::Tdpa, ObserverForm::Thesis),
        ("fba", LawKind::Fba, ObserverForm::Exact),
        ("sfa", LawKind::Sfa, ObserverForm::Exact),
        (
            "sfa-continuous",
            LawKind::SfaContinuous,
            ObserverForm::Exact,
        ),
        (
            "enhanced, thesis",
            LawKind::EnhancedSfa,
            ObserverForm::Exact,
        ),
    ];
    laws.extend(known.map(|(name, law, observer)| {
        let settings = Settings {
            law,
            observer,
            ..thesis
        };
        (name.to_owned(), settings.into())
    }));
    let shipped = Settings::default();
    laws.push(("enhanced, shipped".to_owned(), shipped.into()));
    let damper = Settings {
        law: LawKind::SpringDamper,
        ..shipped
    };
    laws.push(("damper on estimated states".to_owned(), damper.into()));
    laws
}

/// One row of the result file: the worst hand of one type for one control law and delay.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Row {
    law: String,
    delay_ticks: f64,
    way: String,
    evaluations: u32,
    /// Most energy in J that the hand gets out with the energy guard, beyond the energy that refills the guard's account.
    guarded_j: f64,
    /// The same hand's energy in J, including the control period in which it exceeded the energy guard's speed limit, if it did.
    overspeed_j: f64,
    /// Most energy in J that a hand gets out in any half second without the energy guard.
    bare_j: f64,
}

fn row(account: Account, law: &(String, PortLaw), delay_ticks: f64, way: Way, each: u32) -> Row {
    let guarded = account.port(law.1, delay_ticks, true);
    let (numbers, taken) = way.worst(&guarded, each, TICKS, SEED);
    let longer = way.play(&guarded, &numbers, LONGER);
    let bare = account.port(law.1, delay_ticks, false);
    let (_, bare_j) = way.worst(&bare, each / 10 + 1, TICKS, SEED);
    Row {
        law: law.0.clone(),
        delay_ticks,
        way: format!("{way:?}"),
        evaluations: each,
        guarded_j: taken.max(longer.above_refill_j),
        overspeed_j: longer.with_overspeed_j,
        bare_j,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let file = words
        .next()
        .ok_or("give FILE.csv [EVALUATIONS, default 40000] [shipped]")?;
    let budget: u32 = match words.next() {
        None => 40_000,
        Some(word) => word.parse().map_err(|error| {
            format!("the number of evaluations: {error}; give a whole number, such as 1000000")
        })?,
    };
    let account = match words.next().as_deref() {
        None => Account::SMALL,
        Some("shipped") => Account::shipped(),
        Some(word) => return Err(format!("`{word}`: give `shipped` or nothing").into()),
    };
    let laws = laws();
    let cells: Vec<(usize, f64, Way)> = (0..laws.len())
        .flat_map(|law| DELAYS.map(|delay| (law, delay)))
        .flat_map(|(law, delay)| Way::ALL.map(|way| (law, delay, way)))
        .collect();
    let each = budget.div_ceil(cells.len() as u32);
    let (mut journal, mut rows) = Journal::open::<Row>(Path::new(&file))?;
    if rows.iter().any(|row| row.evaluations != each) {
        return Err(
            format!("{file} holds another number of evaluations; give another file").into(),
        );
    }
    let at_once = rayon::current_num_threads();
    for cells in cells[rows.len().min(cells.len())..].chunks(at_once) {
        let found: Vec<Row> = cells
            .par_iter()
            .map(|(law, delay, way)| row(account, &laws[*law], *delay, *way, each))
            .collect();
        journal.append(None, &found)?;
        rows.extend(found);
        eprint!(
            "\r{} of {}",
            rows.len(),
            laws.len() * DELAYS.len() * Way::ALL.len()
        );
    }
    eprintln!();
    print(account, &laws, &rows);
    let worst = rows.iter().map(|row| row.guarded_j).fold(0.0, f64::max);
    let bound = account.bound_j();
    if worst > bound {
        return Err(format!("{worst} J, beyond the bound of {bound}").into());
    }
    Ok(())
}

/// Prints the worst type of hand for every control law and delay.
fn print(account: Account, laws: &[(String, PortLaw)], rows: &[Row]) {
    let total: u64 = rows.iter().map(|row| u64::from(row.evaluations)).sum();
    println!(
        "{total} evaluations with the guard: the most found, mJ above the refill (bound: {:.3}); without it, mJ in half a second",
        1e3 * account.bound_j()
    );
    println!(
        "{:<28}{:>34}   without",
        "law", "guard, delay 0, 0.1, 0.5, 1 tick"
    );
    for (name, _) in laws {
        let most = |of: fn(&Row) -> f64| {
            DELAYS.map(|delay| {
                rows.iter()
                    .filter(|row| row.law == *name && row.delay_ticks == delay)
                    .map(of)
                    .fold(0.0, f64::max)
            })
        };
        let guarded = most(|row| 1e3 * row.guarded_j).map(|mj| format!("{mj:>8.3}"));
        let bare = most(|row| 1e3 * row.bare_j).map(|mj| format!("{mj:>9.1}"));
        println!("{name:<28}  {}   {}", guarded.concat(), bare.concat());
    }
    let worst = rows.iter().map(|row| row.guarded_j).fold(0.0, f64::max);
    println!("worst of all with the guard: {:.3} mJ", 1e3 * worst);
    let beyond: Vec<f64> = rows.iter().map(|row| row.overspeed_j).collect();
    let ended = beyond.iter().filter(|beyond| **beyond > 0.0).count();
    println!(
        "{ended} of these {} hands went beyond overspeed in the end; with that tick, which the bound leaves out: at most {:.3} mJ",
        beyond.len(),
        1e3 * beyond.iter().copied().fold(0.0, f64::max)
    );
}
