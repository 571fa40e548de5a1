//! Decides whether the device rests while the hand holds still. The last quarter of every hold is examined.
//!
//! The motion of a press defines its holds. In a recording, a hold is a span of at least `LEAST_STILL_S` in which the hand's rest
//! point stays within the threshold of a limit cycle. Without a hold, the last twentieth of the run is examined. If the hand
//! moves in the examined time, only a motion of the device beyond `BEYOND_HAND` times that of the hand is attributed to the wall.

use super::terms::Terms;
use super::tick::Tick;
use super::verdict::{LEAST_REST_S, NotJudged};

/// Shortest span in which a recorded hand counts as still, s. Only its last quarter is examined, so that earlier motion can decay.
const LEAST_STILL_S: f64 = 0.8;
/// Length of the pieces into which a span of a still hand is divided, s.
const PIECE_S: f64 = 0.05;
/// A motion of the device beyond this factor times that of the hand is attributed to the wall.
const BEYOND_HAND: f64 = 2.0;

/// Smallest and largest value of a series of numbers.
#[derive(Debug, Clone, Copy)]
struct Span {
    low: f64,
    high: f64,
}

impl Span {
    const EMPTY: Span = Span {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    fn add(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    fn with(self, other: Span) -> Span {
        Span {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn width(self) -> Option<f64> {
        (self.high >= self.low).then_some(self.high - self.low)
    }
}

/// Observations of the device over some time: motion, exits from the wall, and whether the torque limit was reached.
#[derive(Debug, Clone, Copy)]
struct Seen {
    motion: Span,
    hand: Span,
    exits: u32,
    at_limit: bool,
    /// Whether the device touched the wall; always true in a hold of the scene's motion. Elsewhere, a device that coasts outside
    /// the wall is not judged by its motion.
    touched: bool,
    ticks: u64,
}

impl Seen {
    const NOTHING: Seen = Seen {
        motion: Span::EMPTY,
        hand: Span::EMPTY,
        exits: 0,
        at_limit: false,
        touched: false,
        ticks: 0,
    };

    fn add(&mut self, tick: &Tick, left: bool, at_limit: bool) {
        self.motion.add(tick.angle_rad);
        self.hand.add(tick.rest_rad);
        self.touched |= tick.force_n_m != 0.0;
        self.exits += u32::from(left);
        self.at_limit |= at_limit;
        self.ticks += 1;
    }

    fn with(self, other: Seen) -> Seen {
        Seen {
            motion: self.motion.with(other.motion),
            hand: self.hand.with(other.hand),
            exits: self.exits + other.exits,
            at_limit: self.at_limit || other.at_limit,
            touched: self.touched || other.touched,
            ticks: self.ticks + other.ticks,
        }
    }
}

/// The examined part of a hold: its last quarter, in ticks.
#[derive(Debug, Clone)]
struct Hold {
    from: u64,
    to: u64,
    seen: Seen,
}

/// The present span in which a recorded hand holds still, divided into pieces.
#[derive(Debug, Clone)]
struct Still {
    hand: Span,
    ticks: u64,
    pieces: Vec<Seen>,
}

impl Still {
    const NONE: Still = Still {
        hand: Span::EMPTY,
        ticks: 0,
        pieces: Vec::new(),
    };

    /// Observations over the last quarter of the span; `None` if the span is shorter than [`LEAST_STILL_S`].
    fn end(&self, terms: &Terms) -> Option<Seen> {
        let long_enough = self.ticks as f64 * terms.period_s >= LEAST_STILL_S;
        let quarter = (self.pieces.len() / 4).max(1);
        let last = self.pieces.iter().rev().take(quarter).copied();
        last.reduce(Seen::with).filter(|_| long_enough)
    }
}

/// Examines every tick (control period) for motion of device and hand.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    holds: Vec<Hold>,
    current: usize,
    /// Observations over the last quarter of each finished span in which a recorded hand held still.
    found: Vec<Seen>,
    still: Still,
    piece_ticks: u64,
}

/// Whether the device rested in the holds of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rested {
    /// Largest peak-to-peak motion of the device in an examined time with contact, rad; `None` without such a time.
    pub peak_to_peak: Option<f64>,
    /// Whether the device keeps moving by more than the motion of its hand explains.
    pub oscillates: bool,
    /// Whether the verdict is unstable: the device moves farther than a limit cycle (0.25 rad), or keeps moving and also leaves
    /// the wall twice or reaches its torque limit.
    pub lost: bool,
    /// Reason why the run does not show whether the device rests; `None` if it does.
    pub not_judged: Option<NotJudged>,
}

impl Rest {
    pub fn new(terms: &Terms) -> Self {
        // Without a hold, the last fifth of the run counts as a hold.
        let quiet = if terms.holds.is_empty() {
            vec![(terms.ticks - terms.ticks / 5, terms.ticks)]
        } else {
            terms.holds.clone()
        };
        let named = !terms.holds.is_empty();
        let holds = quiet.into_iter().map(|(from, to)| Hold {
            from: to - (to - from) / 4,
            to,
            seen: Seen {
                touched: named,
                ..Seen::NOTHING
            },
        });
        Self {
            holds: holds.collect(),
            current: 0,
            found: Vec::new(),
            still: Still::NONE,
            piece_ticks: ((PIECE_S / terms.period_s) as u64).max(1),
        }
    }

    /// Examines one tick. `left` is true if the device left the wall in this tick.
    pub fn record(&mut self, tick: &Tick, left: bool, terms: &Terms) {
        let at_limit = tick.force_n_m.abs() >= terms.force_limit_n_m;
        if let Some(hold) = self.holds.get_mut(self.current) {
            if tick.index >= hold.to {
                self.current += 1;
            } else if tick.index >= hold.from {
                hold.seen.add(tick, left, at_limit);
            }
        }
        if terms.recorded {
            self.follow(tick, left, at_limit, terms);
        }
    }

    /// Extends the present span in which a recorded hand holds still, or ends the span if the hand has moved too far.
    fn follow(&mut self, tick: &Tick, left: bool, at_limit: bool, terms: &Terms) {
        let mut hand = self.still.hand;
        hand.add(tick.rest_rad);
        if hand
            .width()
            .is_some_and(|width| width <= terms.limit_cycle_rad)
        {
            self.still.hand = hand;
        } else {
            self.found.extend(self.still.end(terms));
            self.still = Still::NONE;
            self.still.hand.add(tick.rest_rad);
        }
        if self.still.ticks.is_multiple_of(self.piece_ticks) {
            self.still.pieces.push(Seen::NOTHING);
        }
        self.still.ticks += 1;
        if let Some(piece) = self.still.pieces.last_mut() {
            piece.add(tick, left, at_limit);
        }
    }

    pub fn finish(&self, terms: &Terms) -> Rested {
        let mut windows = self.found.clone();
        windows.extend(self.still.end(terms));
        // Motions other than recordings have only these holds. For a recorded hand that never holds still, they are the end of
        // the run.
        if windows.is_empty() {
            windows.extend(self.holds.iter().map(|hold| hold.seen));
        }
        let mut rested = Rested {
            peak_to_peak: None,
            oscillates: false,
            lost: false,
            not_judged: None,
        };
        let (mut left, mut far) = (false, false);
        for window in &windows {
            let hand_rad = window.hand.width().unwrap_or(0.0) + terms.tremor_rad;
            let device_rad = window.motion.width().unwrap_or(0.0);
            let is_hand_still = hand_rad <= terms.limit_cycle_rad;
            let own_rad = if is_hand_still {
                0.0
            } else {
                BEYOND_HAND * hand_rad
            };
            left |= window.exits >= 2 || window.at_limit;
            if window.touched {
                rested.peak_to_peak = rested
                    .peak_to_peak
                    .into_iter()
                    .chain(window.motion.width())
                    .reduce(f64::max);
                rested.oscillates |= device_rad > own_rad + terms.limit_cycle_rad;
                far |= device_rad > own_rad + terms.unstable_rad;
            }
            let rests = window.touched && device_rad <= terms.limit_cycle_rad;
            if !is_hand_still && !rests {
                rested.not_judged = Some(NotJudged::HandMoves {
                    hand_rad,
                    device_rad,
                });
            }
        }
        rested.lost = far || (rested.oscillates && left);
        let seen_s = windows
            .last()
            .map_or(0.0, |window| window.ticks as f64 * terms.period_s);
        // One control period of tolerance, because times are rounded to ticks.
        if seen_s + terms.period_s < LEAST_REST_S {
            // A motion over such a short time need not continue.
            rested.oscillates = false;
            rested.not_judged = Some(NotJudged::TooShort {
                seen_s,
                least_s: LEAST_REST_S,
            });
        }
        rested
    }
}
