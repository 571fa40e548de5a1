//! What there is to do, in pieces that do not depend on each other: each has devices of its own, so their order does not matter.

use super::campaign::Campaign;
use super::checks::{CHECKS, Check, OF_THE_EMULATOR};
use super::list::{
    ASKED_FOR, BESIDE, Injection, ON_ESC1, POWER, PROCESSOR, SECOND, WITH_AS5047P, WITH_MT6701,
    WITH_TRACKS,
};
use super::tally::Tally;
use crate::bench::Setup;
use crate::board::{Board, Encoder};
use crate::cpu::elf::Program;

/// The slowest and the fastest clock that the watchdog may have, Hz.
const SLOW_LSI: u64 = 29_500;
const FAST_LSI: u64 = 34_000;

/// Injections of a piece: so many that starting a device and telling it its settings does not count.
const PIECE: usize = 12;

/// The boards' programs; what has none is left out.
#[derive(Debug, Default)]
pub struct Programs {
    /// Of the NUCLEO-G474RE with the X-NUCLEO-IHM08M1.
    pub nucleo_g474re: Option<Program>,
    /// Of the B-G431B-ESC1.
    pub b_g431b_esc1: Option<Program>,
}

enum Work {
    Check(Check),
    Rows {
        is_first: bool,
        rows: Vec<Injection>,
    },
}

/// A piece of work.
pub struct Job<'a> {
    program: &'a Program,
    setup: Setup,
    device: String,
    work: Work,
}

/// Everything, or what has one of `only` in its name.
#[must_use]
pub fn jobs<'a>(programs: &'a Programs, only: &[&str]) -> Vec<Job<'a>> {
    let g474 = |encoder, lsi_hz, lists: &[&[Injection]]| {
        (
            programs.nucleo_g474re.as_ref(),
            Setup {
                board: Board::nucleo_g474re(encoder),
                lsi_hz,
                ..Setup::default()
            },
            lists.concat(),
        )
    };
    let sets = [
        g474(
            Encoder::As5047p,
            SLOW_LSI,
            &[POWER, WITH_AS5047P, PROCESSOR, ASKED_FOR, BESIDE, SECOND],
        ),
        g474(Encoder::Mt6701, FAST_LSI, &[WITH_MT6701]),
        g474(Encoder::Incremental(16_384), FAST_LSI, &[WITH_TRACKS]),
        (
            programs.b_g431b_esc1.as_ref(),
            Setup {
                board: Board::b_g431b_esc1(),
                lsi_hz: SLOW_LSI,
                ..Setup::default()
            },
            ON_ESC1.to_vec(),
        ),
    ];
    let mut jobs = Vec::new();
    let mut checked = Vec::new();
    for (program, setup, mut rows) in sets {
        let Some(program) = program else {
            continue;
        };
        let board = setup.board.name;
        let device = format!("{board}, {:?}", setup.board.encoder);
        let asked = |name: &str| {
            let name = format!("{device}: {name}");
            only.is_empty() || only.iter().any(|only| name.contains(only))
        };
        let mut add = |work| {
            jobs.push(Job {
                program,
                setup: setup.clone(),
                device: device.clone(),
                work,
            });
        };
        // Once a board, and once.
        if !checked.contains(&board) {
            let of_all = checked.is_empty().then_some(&OF_THE_EMULATOR);
            for check in CHECKS.iter().chain(of_all).filter(|(name, _)| asked(name)) {
                add(Work::Check(*check));
            }
            checked.push(board);
        }
        rows.retain(|row| asked(&row.title()));
        for (index, rows) in rows.chunks(PIECE).enumerate() {
            add(Work::Rows {
                is_first: index == 0,
                rows: rows.to_vec(),
            });
        }
    }
    jobs
}

impl Job<'_> {
    /// Does it.
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
                // Beyond help: the next one begins with another.
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
