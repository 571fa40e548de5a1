//! Tries all inputs of properties (statements about the code) that have few enough inputs: `every [NAME]`, `every --list`.
//!
//! Products and a root on three axes at 8 bits are too hard for the solvers, but have at most 2^32 inputs. For quotients with 2^24
//! inputs, a solver takes longer than a trial of each input. The property's body that runs here is also the one that the tests run
//! on samples. It is compiled with overflow checks and debug assertions (`--profile every`). So at this width it is a proof that
//! needs no solver.
//!
//! ```text
//! cargo xtask prove --every
//! ```

use std::process::ExitCode;
use std::time::Instant;
use touchstone_proofs::source::Source;
use touchstone_proofs::{
    contact, edges, heart, objects, planes, shells, space, vector_guard, vectors,
};

/// A row of the table of properties: the property's name, and the function that tries its inputs.
type Row = (&'static str, fn(&mut Every));

macro_rules! every {
    ($($part:ident)::+) => {
        (
            concat!($("::", stringify!($part)),+).split_at(2).1,
            $($part)::+::body,
        )
    };
}

const PROPERTIES: &[Row] = &[
    every!(heart::reciprocal::p6_reciprocal_8),
    every!(edges::w8::p1_edge_affordable),
    every!(edges::w8::p1_edge_per),
    every!(edges::w8::p6_edge_divide),
    every!(space::w8::p4_unit),
    every!(space::w8::p4_within),
    every!(space::w8::p4_polar),
    every!(space::w8::p7_leaving),
    every!(objects::p4_ball_nearest),
    every!(objects::p4_ball_exit),
    every!(objects::p4_box_nearest),
    every!(objects::p4_box_exit),
    every!(objects::p4_cylinder_nearest),
    every!(objects::p4_cylinder_exit),
    every!(objects::p4_plate_keeps_its_side),
    every!(objects::p4_plate_exit),
    every!(planes::p4_plane_nearest),
    every!(planes::p4_plane_exit),
    every!(planes::p4_facets_nearest),
    every!(planes::p4_facets_exit),
    every!(planes::p4_edge_nearest),
    every!(planes::p4_edge_exit),
    every!(planes::p4_corner_nearest),
    every!(planes::p4_corner_exit),
    every!(planes::p4_shape_is_its_object),
    every!(contact::p4_displacement),
    every!(contact::p4_point_closest),
    every!(contact::p4_point_of_penetration),
    every!(contact::p4_point_restricted),
    every!(contact::p4_friction_sticks_and_slides),
    every!(contact::p4_friction_turns),
    every!(shells::p4_magnitude_is_the_law),
    every!(shells::p4_per_axis_is_three_laws),
    every!(shells::p4_per_axis_is_told_its_part),
    every!(shells::p1_bounding_is_the_sum),
    every!(shells::p4_wall_is_its_parts),
    every!(vectors::p4_scalar_products),
    every!(vectors::p4_lengths),
    every!(vectors::p4_across_is_shorter),
    every!(vectors::p4_within_is_hardly_shorter),
    every!(space::root32::p5_root_of_halves),
    every!(vector_guard::w8::p1_vector_account),
    every!(vector_guard::w8::p1_vector_change),
    every!(vector_guard::w8::p9_no_force_at_the_end),
    every!(vector_guard::w8::p4_vector_commanded),
];

/// Largest count of numbers that one input of a property consists of.
const DIGITS: usize = 16;

/// A source that gives a property all inputs, one after the other. The numbers of an input are the digits of one large number that
/// counts up. There are up to some thousand million inputs, so the work for each input is kept small.
struct Every {
    /// Value and width in bits of each digit.
    digits: [(u64, u32); DIGITS],
    /// Number of digits that the property has drawn so far.
    known: usize,
    at: usize,
    rejected: bool,
    covers: Vec<(&'static str, u64)>,
    /// Index of the cover (a situation to be reached) that is expected next, if this input meets covers in the same order as the
    /// last one.
    cover_at: usize,
}

impl Every {
    /// The first of all inputs whose first number is `first`, a number of at most 8 bits.
    fn beginning_with(first: u64) -> Self {
        let mut digits = [(0, 8); DIGITS];
        digits[0].0 = first;
        Self {
            digits,
            known: 1,
            at: 0,
            rejected: false,
            covers: Vec::new(),
            cover_at: 0,
        }
    }

    /// Goes to the next input with the same first number; `false` if there is none.
    #[inline(always)]
    fn advance(&mut self) -> bool {
        // After a refused assumption the property draws no further numbers; those of earlier inputs do not count.
        self.known = self.known.min(self.at.max(1));
        while self.known > 1 {
            let (value, bits) = &mut self.digits[self.known - 1];
            if *value < u64::MAX >> (64 - *bits) {
                *value += 1;
                return true;
            }
            self.known -= 1;
        }
        false
    }

    /// Counts a cover (a situation to be reached) that is not the expected one.
    #[cold]
    fn other_cover(&mut self, reached: bool, what: &'static str) {
        match self.covers.iter_mut().find(|(text, _)| *text == what) {
            Some((_, count)) => *count += u64::from(reached),
            None => self.covers.push((what, u64::from(reached))),
        }
    }
}

impl Source for Every {
    #[inline(always)]
    fn bits(&mut self, bits: u32) -> u64 {
        let at = self.at;
        if at == self.known {
            self.digits[at] = (0, bits);
            self.known = at + 1;
        }
        let digit = &mut self.digits[at];
        if at == 0 {
            assert!(bits <= 8, "the first question is of one byte");
            digit.1 = bits;
        }
        assert!(digit.1 == bits, "another question after the same answers");
        self.at = at + 1;
        digit.0 & (u64::MAX >> (64 - bits))
    }
    #[inline(always)]
    fn assume(&mut self, holds: bool) -> bool {
        self.rejected |= !holds;
        holds
    }
    #[inline(always)]
    fn shortcut(&mut self) -> bool {
        false
    }
    #[inline(always)]
    fn cover(&mut self, reached: bool, what: &'static str) {
        match self.covers.get_mut(self.cover_at) {
            Some((text, count)) if std::ptr::eq(*text, what) => {
                *count += u64::from(reached);
                self.cover_at += 1;
            }
            _ => self.other_cover(reached, what),
        }
    }
}

/// Result for all inputs that begin with one number: how many were tried and accepted, and how often each cover (situation) was
/// reached.
#[derive(Default)]
struct Found {
    tried: u64,
    accepted: u64,
    covers: Vec<(&'static str, u64)>,
}

fn of_one_first(body: fn(&mut Every), first: u64) -> Found {
    let mut source = Every::beginning_with(first);
    let mut found = Found::default();
    loop {
        (source.at, source.cover_at, source.rejected) = (0, 0, false);
        body(&mut source);
        // The first number has fewer bits than 8, and this value does not fit them.
        if source.digits[0].0 >> source.digits[0].1 != 0 {
            return Found::default();
        }
        found.tried += 1;
        found.accepted += u64::from(!source.rejected);
        if !source.advance() {
            found.covers = source.covers;
            return found;
        }
    }
}

impl Found {
    fn with(mut self, other: Self) -> Self {
        self.tried += other.tried;
        self.accepted += other.accepted;
        for (what, count) in other.covers {
            match self.covers.iter_mut().find(|(text, _)| *text == what) {
                Some((_, sum)) => *sum += count,
                None => self.covers.push((what, count)),
            }
        }
        self
    }
}

/// Tries all inputs of a property on all processors; ends the program if the property fails.
fn of_all(body: fn(&mut Every)) -> Found {
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get) as u64;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..processors)
            .map(|worker| {
                scope.spawn(move || {
                    (worker..256)
                        .step_by(processors as usize)
                        .fold(Found::default(), |found, first| {
                            found.with(of_one_first(body, first))
                        })
                })
            })
            .collect();
        workers
            .into_iter()
            .map(|worker| worker.join().expect("the property holds"))
            .fold(Found::default(), Found::with)
    })
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words == ["--list"] {
        for (name, _) in PROPERTIES {
            println!("{name}");
        }
        return ExitCode::SUCCESS;
    }
    let part = words.first().map_or("", String::as_str);
    let asked: Vec<&Row> = PROPERTIES
        .iter()
        .filter(|(name, _)| name.contains(part))
        .collect();
    if asked.is_empty() || words.len() > 1 {
        eprintln!("every [PART OF A NAME], one of every --list");
        return ExitCode::from(2);
    }
    let mut fine = true;
    for (name, body) in asked {
        let begun = Instant::now();
        let found = of_all(*body);
        let missing: Vec<_> = found
            .covers
            .iter()
            .filter(|(_, count)| *count == 0)
            .collect();
        let ok = found.accepted > 0 && missing.is_empty() && !found.covers.is_empty();
        fine &= ok;
        let said = if ok { "holds" } else { "says nothing" };
        println!(
            "{name}: {said}: {} inputs, {} of them within its assumptions, {:.0} s",
            found.tried,
            found.accepted,
            begun.elapsed().as_secs_f64()
        );
        if !ok {
            println!("  covers never reached: {missing:?}");
        }
    }
    if fine {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
