//! Splits the fault-injection campaign into independent jobs. Each job has emulated devices of its own, so the order of the jobs
//! does not matter.

use super::campaign::Campaign;
use super::checks::{CHECKS, Check, OF_THE_EMULATOR};
use super::list::{
    ASKED_FOR, BESIDE, Injection, MODEL, MORE_ON_IHM16M1, MOTION, ON_ESC1, ON_G431RB, ON_IHM16M1,
    ON_SIMPLEFOC_MINI, POWER, PROCESSOR, SECOND, WITH_AS5047P, WITH_LINK_R35, WITH_MT6701,
    WITH_TRACKS,
};
use super::tally::Tally;
use crate::bench::Setup;
use crate::board::{Board, Encoder, FaultLink};
use crate::cpu::elf::Program;
use std::collections::BTreeSet;
use touchstone_protocol::FaultCode;

/// Slowest clock frequency of the independent watchdog, Hz.
const SLOW_LSI: u64 = 29_500;
const FAST_LSI: u64 = 34_000;

/// Number of injections per job: enough that starting and configuring a device takes little of the job's time.
const PIECE: usize = 12;

/// The short forms of the campaign run one of this many injections, and in addition injections for the fault codes that those do
/// not cause.
const OF_ROWS: usize = 3;

/// The board on which the short form `Sample` runs all checks except the longest. The other boards execute the same code.
const REFERENCE: &str = "nucleo-g474re-ihm16m1";

/// The checks that the short forms of the campaign run on all boards, because they depend on a board's pins and parts. The first is
/// a check of the emulator itself and runs only once.
const ON_ALL_BOARDS: [&str; 4] = [
    OF_THE_EMULATOR.0,
    "boot and presses",
    "registers after the start",
    "over-current by the comparators",
];

/// Further checks of the short form `Brief`, besides [`ON_ALL_BOARDS`]. Each simulates seconds of the device's time, not minutes.
const BRIEF: [&str; 4] = [
    "damaged settings",
    "more than one wall",
    "random frames",
    "cable pulled",
];

/// The longest check, which takes a tenth of the whole campaign's time. The short forms of the campaign leave it out.
const LONGEST: &str = "cogging";

/// A check that the short form `Sample` also runs on a second board, because its result differs from the reference board's.
const HOT: (&str, &str) = ("a hand that leans", "nucleo-g474re");

/// The firmware programs of the boards. Boards without a program are left out of the campaign.
#[derive(Debug, Default)]
pub struct Programs(Vec<(&'static str, Program)>);

impl Programs {
    /// Adds the firmware program of a board.
    pub fn add(&mut self, board: &'static str, program: Program) {
        self.0.push((board, program));
    }

    /// The firmware program of a board; `None` if there is none.
    #[must_use]
    pub fn of(&self, board: &Board) -> Option<&Program> {
        let found = self.0.iter().find(|(name, _)| *name == board.name);
        found.map(|(_, program)| program)
    }

    /// Number of boards for which there is a firmware program.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.len()
    }
}

enum Work {
    Check(Check),
    Rows {
        is_first: bool,
        rows: Vec<Injection>,
    },
}

/// One job of the fault-injection campaign: injections or checks that run on emulated devices of their own.
pub struct Job<'a> {
    program: &'a Program,
    setup: Setup,
    device: String,
    work: Work,
}

/// Selection of the checks and injections to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked<'a> {
    /// All checks and injections.
    Everything,
    /// One of three injections on every board and at least one for each fault code, all but the longest check on the reference
    /// board, and a few checks on the other boards.
    Sample,
    /// The same injections as `Sample`, and the checks that finish quickly.
    Brief,
    /// All checks and injections whose name contains one of these texts.
    Only(&'a [&'a str]),
}

impl Asked<'_> {
    fn has_check(self, board: &str, name: &str) -> bool {
        let is_of_all = ON_ALL_BOARDS.contains(&name);
        match self {
            Self::Everything | Self::Only(_) => true,
            Self::Sample => {
                is_of_all || name != LONGEST && board == REFERENCE || (name, board) == HOT
            }
            Self::Brief => is_of_all || BRIEF.contains(&name),
        }
    }

    /// Whether the selection leaves injections or checks out because it is a short form of the campaign.
    #[must_use]
    pub fn is_sample(self) -> bool {
        matches!(self, Self::Sample | Self::Brief)
    }

    fn is_named(self, name: &str) -> bool {
        match self {
            Self::Everything | Self::Sample | Self::Brief => true,
            Self::Only(texts) => texts.iter().any(|text| name.contains(text)),
        }
    }
}

/// All jobs that run the selected checks and injections.
#[must_use]
pub fn jobs<'a>(programs: &'a Programs, asked: Asked<'_>) -> Vec<Job<'a>> {
    let on = |board: Board, lsi_hz, lists: &[&[Injection]]| {
        let setup = Setup {
            lsi_hz,
            ..Setup::on(board)
        };
        (programs.of(&setup.board), setup, lists.concat())
    };
    let tracks = Encoder::Incremental(16_384);
    let sets = [
        on(
            Board::nucleo_g474re(Encoder::As5047p),
            SLOW_LSI,
            &[
                POWER,
                WITH_AS5047P,
                MOTION,
                MODEL,
                PROCESSOR,
                ASKED_FOR,
                BESIDE,
                SECOND,
            ],
        ),
        on(
            Board::nucleo_g474re(Encoder::Mt6701),
            FAST_LSI,
            &[WITH_MT6701],
        ),
        on(Board::nucleo_g474re(tracks), FAST_LSI, &[WITH_TRACKS]),
        on(
            Board::nucleo_g474re_ihm16m1(Encoder::As5047p, FaultLink::R37),
            SLOW_LSI,
            &[ON_IHM16M1, MORE_ON_IHM16M1, MOTION, MODEL, BESIDE],
        ),
        on(
            Board::nucleo_g474re_ihm16m1(Encoder::Mt6701, FaultLink::R35),
            FAST_LSI,
            &[WITH_LINK_R35],
        ),
        on(
            Board::nucleo_g474re_simplefoc_mini(Encoder::As5047p),
            SLOW_LSI,
            &[ON_SIMPLEFOC_MINI, MOTION],
        ),
        on(
            Board::nucleo_g431rb_ihm16m1(Encoder::As5047p, FaultLink::R37),
            SLOW_LSI,
            &[ON_IHM16M1, ON_G431RB, MOTION, MODEL],
        ),
        on(
            Board::nucleo_g431rb_ihm16m1(Encoder::Mt6701, FaultLink::R35),
            FAST_LSI,
            &[WITH_LINK_R35],
        ),
        on(Board::b_g431b_esc1(), SLOW_LSI, &[ON_ESC1, MOTION, MODEL]),
    ];
    let mut lists: Vec<Vec<Injection>> = sets.iter().map(|(.., rows)| rows.clone()).collect();
    if asked.is_sample() {
        lists = sample(&lists);
    }
    let mut jobs = Vec::new();
    let mut checked = Vec::new();
    for ((program, setup, _), mut rows) in sets.into_iter().zip(lists) {
        let Some(program) = program else {
            continue;
        };
        let board = setup.board.name;
        let device = format!("{board}, {:?}", setup.board.encoder);
        let is_named = |name: &str| asked.is_named(&format!("{device}: {name}"));
        let mut add = |work| {
            jobs.push(Job {
                program,
                setup: setup.clone(),
                device: device.clone(),
                work,
            });
        };
        // The checks of a board run once per board. The check of the emulator itself runs once, with the first board.
        if !checked.contains(&board) {
            let of_all = checked.is_empty().then_some(&OF_THE_EMULATOR);
            let wanted = |name| is_named(name) && asked.has_check(board, name);
            for check in CHECKS.iter().chain(of_all).filter(|(name, _)| wanted(name)) {
                add(Work::Check(*check));
            }
            checked.push(board);
        }
        rows.retain(|row| is_named(&row.title()));
        for (index, rows) in rows.chunks(PIECE).enumerate() {
            add(Work::Rows {
                is_first: index == 0,
                rows: rows.to_vec(),
            });
        }
    }
    jobs
}

/// The injections of a short form of the campaign, for each device: one of three. Of each fault code that these do not surely
/// cause, also the first injection that does.
fn sample(lists: &[Vec<Injection>]) -> Vec<Vec<Injection>> {
    let is_of_three = |list: usize, row: usize| row % OF_ROWS == list % OF_ROWS;
    let rows = |list: usize| lists[list].iter().enumerate();
    let mut latched: BTreeSet<FaultCode> = (0..lists.len())
        .flat_map(|list| rows(list).filter(move |(row, _)| is_of_three(list, *row)))
        .filter_map(|(_, row)| row.expect.only_code())
        .collect();
    (0..lists.len())
        .map(|list| {
            rows(list)
                .filter(|(row, injection)| {
                    is_of_three(list, *row)
                        || (injection.expect.only_code()).is_some_and(|code| latched.insert(code))
                })
                .map(|(_, injection)| *injection)
                .collect()
        })
        .collect()
}

impl Job<'_> {
    /// Name of the job for reports.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.work {
            Work::Check((name, _)) => format!("{}: {name}", self.device),
            Work::Rows { rows, .. } => format!("{}: {} injections", self.device, rows.len()),
        }
    }

    /// Runs the job's injections or check, and returns the results.
    #[must_use]
    pub fn run(&self) -> Tally {
        let mut tally = Tally::on(&self.device);
        match &self.work {
            Work::Check((_, check)) => check(self.program, &self.setup, &mut tally),
            Work::Rows { is_first, rows } => {
                if *is_first {
                    tally.head(&self.setup);
                }
                self.inject(rows, &mut tally);
            }
        }
        tally
    }

    fn inject(&self, rows: &[Injection], tally: &mut Tally) {
        let mut campaign: Option<Campaign> = None;
        for injection in rows {
            let mut device = match campaign.take() {
                Some(device) => device,
                None => match Campaign::new(self.program, &self.setup) {
                    Ok(device) => device,
                    Err(error) => {
                        tally.check(&injection.title(), Err(format!("boot: {error}")));
                        continue;
                    }
                },
            };
            let outcome = device.inject(injection);
            tally.row(injection, &outcome);
            let failed = |wrong: &String| wrong.starts_with("before");
            let is_lost =
                device.bench().halted.is_some() || outcome.wrong.as_ref().is_some_and(failed);
            if is_lost {
                // The device is unusable now, so the next injection starts with a new device.
                tally.ran(device.bench());
            } else {
                campaign = Some(device);
            }
        }
        if let Some(mut device) = campaign {
            tally.ran(device.bench());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_sample_chooses_by_name_is_there() {
        for name in ON_ALL_BOARDS.into_iter().chain(BRIEF).chain([LONGEST]) {
            let mut all = CHECKS.iter().chain([&OF_THE_EMULATOR]);
            assert!(all.any(|(check, _)| *check == name), "{name}");
        }
        assert!(Board::all().iter().any(|board| board.name == REFERENCE));
    }

    #[test]
    fn a_sample_latches_every_fault_code_that_a_list_latches() {
        let lists = [POWER, WITH_AS5047P, ON_IHM16M1, ON_ESC1, MOTION].map(<[_]>::to_vec);
        let codes = |lists: &[Vec<Injection>]| -> BTreeSet<FaultCode> {
            let rows = lists.iter().flatten();
            rows.filter_map(|row| row.expect.only_code()).collect()
        };
        let sampled = sample(&lists);
        assert_eq!(codes(&sampled), codes(&lists));
        let count = |lists: &[Vec<Injection>]| lists.iter().map(Vec::len).sum::<usize>();
        assert!(count(&sampled) < count(&lists) / 2);
    }
}
