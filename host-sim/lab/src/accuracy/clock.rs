//! Measures the time of small pieces of work on a machine that also runs other programs. Pieces are repeated in turn; the results
//! are the least time and the quartiles.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;

/// Shortest time that is measured with one reading of the clock, s. It is long compared with the time that reading the clock takes.
const STRETCH_S: f64 = 2e-4;

/// Measured computing times in nanoseconds per unit of work: least, quartiles and median over the repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Least time per unit of work, which is that of a repeat without disturbance, ns.
    pub least_ns: f64,
    /// Lower quartile of the times per unit of work, ns.
    pub lower_quartile_ns: f64,
    /// Median of the times per unit of work, ns.
    pub median_ns: f64,
    /// Upper quartile of the times per unit of work, ns.
    pub upper_quartile_ns: f64,
}

/// Work whose computing time is measured. One call does all of the work and returns a number, so that the compiler cannot remove
/// the work.
pub type Work<'a> = Box<dyn FnMut() -> f64 + 'a>;

/// Times every piece of work `repeats` times. Each round has a new order, so that a disturbance affects all pieces alike.
///
/// `units` is the number of units of work in one call. Returns the times per unit, one entry per piece.
pub fn race(
    work: &mut [Work<'_>],
    units: f64,
    repeats: u32,
    mut on_round: impl FnMut(),
) -> Vec<Spread> {
    let calls: Vec<u32> = work
        .iter_mut()
        .map(|work| {
            black_box(work());
            let start = Instant::now();
            black_box(work());
            let once = start.elapsed().as_secs_f64().max(1e-9);
            (STRETCH_S / once).ceil().clamp(1.0, 1e5) as u32
        })
        .collect();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); work.len()];
    let mut order: Vec<usize> = (0..work.len()).collect();
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..repeats {
        for last in (1..order.len()).rev() {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            order.swap(last, (seed % (last as u64 + 1)) as usize);
        }
        for &index in &order {
            let start = Instant::now();
            for _ in 0..calls[index] {
                black_box(work[index]());
            }
            let elapsed = start.elapsed().as_secs_f64();
            times[index].push(1e9 * elapsed / (f64::from(calls[index]) * units));
        }
        on_round();
    }
    times.into_iter().map(spread).collect()
}

fn spread(mut times: Vec<f64>) -> Spread {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    Spread {
        least_ns: at(0.0),
        lower_quartile_ns: at(0.25),
        median_ns: at(0.5),
        upper_quartile_ns: at(0.75),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_the_sorted_times() {
        let found = spread(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(
            [
                found.least_ns,
                found.lower_quartile_ns,
                found.median_ns,
                found.upper_quartile_ns
            ],
            [1.0, 2.0, 3.0, 4.0]
        );
    }

    #[test]
    fn more_work_takes_longer() {
        let sum = |n: u32| move || (0..n).map(|i| f64::from(black_box(i)).sqrt()).sum::<f64>();
        let mut work: Vec<Work> = vec![Box::new(sum(1000)), Box::new(sum(20_000))];
        let times = race(&mut work, 1.0, 5, || {});
        assert!(times[1].least_ns > 5.0 * times[0].least_ns, "{times:?}");
    }
}
