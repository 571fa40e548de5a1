//! Replays a recorded programme of hand actions on the emulated board. A simulated hand carries out, action by action, the file
//! that `touchstone scorecard --programme` wrote. The recording has a row per control period (tick): the board's telemetry in the
//! columns of `touchstone monitor`, and the true motion of the shaft.

use std::fmt::Write as _;
use std::path::Path;

use touchstone_protocol::{DeviceCommand, Limit, Limits, Phase, Request, Telemetry};
use touchstone_world::plant::{FIRM, Hand, LIGHT, MEDIUM};

use crate::bench::{Bench, MS, Setup, US, minimum_jerk};
use crate::cpu::elf::Program;
use crate::fil::fault::CONTROL_TICK;
use crate::world::ShaftBooks;

/// Processor cycles per second.
const SECOND: u64 = 1_000 * MS;
/// Waiting time after arming, in processor cycles. The torque fades in over this time, so that an action begins with the full
/// torque.
const FADED_IN: u64 = 300 * MS;
/// Time in seconds before an action, in which the hand or the test stand moves the shaft to the action's start.
const OUT_S: f64 = 0.5;
const REST: u64 = SECOND / 4;
/// Step of the mechanical simulation, µs.
const STEP_US: u64 = 25;
/// Waiting time in processor cycles until the last telemetry records have arrived over the serial line.
const ON_THE_LINE: u64 = 20 * MS;
/// Least fraction of the control periods in which the encoder count must equal the count for the shaft's true angle, or a neighbour
/// of it. It is below 1, because the shaft moves between sampling and reading.
const IN_STEP: f64 = 0.99;

/// The motion of one hand for one action of the programme.
#[derive(Debug, Clone, PartialEq)]
pub struct HandDeed {
    /// Name of the hand's grip.
    pub grip: String,
    /// Description of the action.
    pub deed: String,
    /// Rest point of the hand's spring in rad, one value per control period.
    pub rest_rad: Vec<f64>,
}

/// A programme of hand actions, as `touchstone scorecard --programme` writes it.
#[derive(Debug, Clone, PartialEq)]
pub struct HandProgramme {
    /// Position of the wall's surface, rad.
    pub surface_rad: f64,
    /// Control periods per second.
    pub rate_hz: u32,
    /// The actions, in order.
    pub deeds: Vec<HandDeed>,
}

impl HandProgramme {
    /// Reads a file of `touchstone scorecard --programme`.
    ///
    /// # Errors
    /// The problem, and its place in the file.
    pub fn read(file: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(file);
        let text = text.map_err(|error| format!("{}: {error}", file.display()))?;
        Self::parse(&text).map_err(|error| format!("{}: {error}", file.display()))
    }

    fn parse(text: &str) -> Result<Self, String> {
        const HEADER: &str = "grip,deed,time_s,surface_rad,rest_rad";
        let mut lines = text.lines().enumerate();
        if lines.next().map(|(_, line)| line) != Some(HEADER) {
            return Err(format!("does not begin with {HEADER}"));
        }
        let mut deeds: Vec<HandDeed> = Vec::new();
        let (mut surface_rad, mut rate_hz) = (0.0, 0);
        for (index, line) in lines {
            let wrong = || format!("line {}: `{line}`", index + 1);
            let cells: Vec<&str> = line.split(',').collect();
            let [grip, deed, numbers @ ..] = &cells[..] else {
                return Err(wrong());
            };
            let numbers: Result<Vec<f64>, _> = numbers.iter().map(|it| it.parse()).collect();
            let Ok([time_s, surface, rest]) = <[f64; 3]>::try_from(numbers.unwrap_or_default())
            else {
                return Err(wrong());
            };
            let same = |last: &&mut HandDeed| last.grip == *grip && last.deed == *deed;
            match deeds.last_mut().filter(same) {
                Some(last) => {
                    if last.rest_rad.len() == 1 {
                        rate_hz = (1.0 / time_s).round() as u32;
                    }
                    last.rest_rad.push(rest);
                }
                None => deeds.push(HandDeed {
                    grip: (*grip).to_owned(),
                    deed: (*deed).to_owned(),
                    rest_rad: vec![rest],
                }),
            }
            surface_rad = surface;
        }
        if deeds.iter().any(|deed| deed.rest_rad.len() < 2) || deeds.is_empty() {
            return Err("has no deed of two ticks".into());
        }
        Ok(Self {
            surface_rad,
            rate_hz,
            deeds,
        })
    }
}

/// The simulated hand for a grip's name.
fn hand_of(grip: &str) -> Result<Hand, String> {
    match grip {
        "light" => Ok(LIGHT),
        "medium" => Ok(MEDIUM),
        "firm" => Ok(FIRM),
        other => Err(format!("no grip is called `{other}`")),
    }
}

/// Columns of the recording: those of `touchstone monitor` that concern the wall, and those that only a test stand can measure.
const COLUMNS: &str = "grip,deed,tick,time_s,count,penetration_rad,force_n_m,state,limits,angle_rad,velocity_rad_per_s,motor_force_n_m,absorbed_j,device_loss_j,surface_rad";

/// Replays a programme of hand actions on a board, with a new device for each grip. Returns the recording as text.
///
/// # Errors
/// The step that failed.
pub fn played(
    program: &Program,
    setup: &Setup,
    programme: &HandProgramme,
) -> Result<String, String> {
    let by_grip: Vec<&[HandDeed]> = programme
        .deeds
        .chunk_by(|one, next| one.grip == next.grip)
        .collect();
    let parts: Vec<Result<String, String>> = std::thread::scope(|scope| {
        let threads: Vec<_> = by_grip
            .iter()
            .map(|deeds| scope.spawn(move || with_a_grip(program, setup, programme, deeds)))
            .collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, _>| {
            thread.join().unwrap_or_else(|_| Err("panicked".into()))
        };
        threads.into_iter().map(join).collect()
    });
    let mut text = format!("{COLUMNS}\n");
    for part in parts {
        text += &part?;
    }
    Ok(text)
}

fn with_a_grip(
    program: &Program,
    setup: &Setup,
    programme: &HandProgramme,
    deeds: &[HandDeed],
) -> Result<String, String> {
    let mut stand = Stand::new(program, setup, programme, &deeds[0])?;
    let mut text = String::new();
    for deed in deeds {
        let said = |error| format!("{}, {}: {error}", deed.grip, deed.deed);
        let course = stand.play(deed).map_err(said)?;
        stand.write(deed, &course, &mut text);
    }
    Ok(text)
}

/// A board on a simulated test stand, which measures the shaft's true angle.
struct Stand {
    bench: Bench,
    rate_hz: u32,
    surface_rad: f64,
    /// Angle per encoder count, rad.
    step_rad: f64,
    /// Encoder counts by which the device's count exceeds the count for the shaft's true angle.
    ahead: i64,
    first_tick: Option<u32>,
}

/// Recording of some control periods and of the start of the next one: the shaft's true state, and the device's telemetry.
struct Course {
    shaft: Vec<ShaftBooks>,
    told: Vec<Telemetry>,
}

impl Stand {
    /// Makes a test stand with a calibrated device, whose knob the hand holds. Moves the knob to and fro to find `ahead`.
    fn new(
        program: &Program,
        setup: &Setup,
        programme: &HandProgramme,
        first: &HandDeed,
    ) -> Result<Self, String> {
        let mut bench = Bench::new(program, setup)?;
        bench.boot()?;
        let kind = setup.board.encoder.kind();
        let surface = programme.surface_rad.to_string();
        let surface = touchstone_control::Si::from_str(&surface);
        let surface = surface.map_err(|error| error.to_string())?;
        bench.configure(|settings| {
            settings.encoder.kind = kind;
            settings.wall.surface_rad = surface;
        })?;
        let settings = bench.settings()?;
        if settings.timing.rate_hz != programme.rate_hz {
            return Err(format!(
                "the board runs at {} Hz, the programme at {}",
                settings.timing.rate_hz, programme.rate_hz
            ));
        }
        bench.calibrate()?;
        // Waits, because a light rotor still moves and swings in the hand.
        bench.run(REST)?;
        let now = bench.now();
        let world = &mut bench.machine.chip_mut().world;
        world.advance(now);
        world.keep_books();
        let here = world.angle_rad();
        world.hold(&hand_of(&first.grip)?, move |_| here);
        let mut stand = Self {
            step_rad: std::f64::consts::TAU / f64::from(settings.encoder.counts_per_rev),
            rate_hz: programme.rate_hz,
            surface_rad: programme.surface_rad,
            bench,
            ahead: 0,
            first_tick: None,
        };
        stand.bench.run(REST)?;
        // The shaft moves a short way in both directions, to align the device's counts with the true angle.
        for to in [here + 0.1, here - 0.1] {
            stand.go(to);
            let course = stand.watch(700)?;
            stand.ahead = stand.in_step(&course).1;
        }
        Ok(stand)
    }

    /// Converts a true shaft angle to the programme's frame. There the angle of an encoder count is the middle of the count.
    fn in_programme(&self, world_rad: f64) -> f64 {
        world_rad + (self.ahead as f64 - 0.5) * self.step_rad
    }

    fn in_world(&self, programme_rad: f64) -> f64 {
        programme_rad - (self.ahead as f64 - 0.5) * self.step_rad
    }

    /// Moves the rest point of the hand's spring smoothly to a position and keeps it there.
    fn go(&mut self, to: f64) {
        let now = self.bench.now();
        let world = &mut self.bench.machine.chip_mut().world;
        world.advance(now);
        let from = world.rest_rad().unwrap_or(to);
        world.lead(move |time| from + (to - from) * minimum_jerk(time / OUT_S));
    }

    /// Turns the shaft from outside to a position, where the hand then takes hold of it at rest. A hand alone would not reach the
    /// position exactly, because of friction.
    fn put(&mut self, hand: &Hand, to: f64) -> Result<(), String> {
        let now = self.bench.now();
        let world = &mut self.bench.machine.chip_mut().world;
        world.advance(now);
        let way = to - world.books().angle_rad;
        // The motion takes a whole number of mechanical steps, each of which moves the shaft by the same angle.
        let steps = (OUT_S * 1e6) as u64 / STEP_US;
        world.force(way / OUT_S);
        self.bench.run(steps * STEP_US * US)?;
        let now = self.bench.now();
        let world = &mut self.bench.machine.chip_mut().world;
        world.advance(now);
        world.force(0.0);
        world.hold(hand, move |_| to);
        self.bench.run(REST)
    }

    /// Records this many control periods, from the next one on.
    fn watch(&mut self, ticks: usize) -> Result<Course, String> {
        let from = self.bench.link.telemetry.len();
        self.bench.machine.run_to(CONTROL_TICK.exception())?;
        self.watch_from_here(from, ticks)
    }

    /// Same as `watch`, called when the handler of the first control period begins. `from` is the number of telemetry records
    /// before it.
    fn watch_from_here(&mut self, from: usize, ticks: usize) -> Result<Course, String> {
        let begin = self.bench.now();
        let period = SECOND / u64::from(self.rate_hz);
        let mut shaft = Vec::with_capacity(ticks + 1);
        for tick in 0..=ticks as u64 {
            let wait = (begin + tick * period).saturating_sub(self.bench.now());
            self.bench.run(wait)?;
            let now = self.bench.now();
            let world = &mut self.bench.machine.chip_mut().world;
            world.advance(now);
            shaft.push(world.books());
        }
        self.bench.run(ON_THE_LINE)?;
        if self.bench.link.gaps(from) > 0 {
            return Err("records of telemetry are missing".into());
        }
        let told = self.bench.link.telemetry[from..].to_vec();
        let mut course = Course { shaft, told };
        let (first, ahead) = self.in_step(&course);
        let share = self.share(&course, first, ahead, 1);
        if share < IN_STEP {
            return Err(format!(
                "counts and shaft are in step in {share:.2} of the ticks"
            ));
        }
        course.told.drain(..first);
        course.told.truncate(ticks + 1);
        Ok(course)
    }

    /// Aligns telemetry and true motion. Returns the index of the record that belongs to the first true state, and the counts by
    /// which the device is ahead. Chosen is the pair for which most counts fit the true angles.
    fn in_step(&self, course: &Course) -> (usize, i64) {
        let spare = course.told.len().saturating_sub(course.shaft.len());
        let mut best = (0, 0, -1.0);
        for first in 0..=spare {
            let middle = course.shaft.len() / 2;
            let Some(told) = course.told.get(first + middle) else {
                continue;
            };
            let about = i64::from(told.count) - self.count_of(&course.shaft[middle]);
            for ahead in about - 1..=about + 1 {
                let share = self.share(course, first, ahead, 0);
                if share > best.2 {
                    best = (first, ahead, share);
                }
            }
        }
        (best.0, best.1)
    }

    fn count_of(&self, shaft: &ShaftBooks) -> i64 {
        (shaft.angle_rad / self.step_rad).floor() as i64
    }

    /// Fraction (0 to 1) of the control periods whose encoder count is within `off` counts of the one for the shaft's true angle.
    fn share(&self, course: &Course, first: usize, ahead: i64, off: i64) -> f64 {
        let pairs = course.told.iter().skip(first).zip(&course.shaft);
        let here = |shaft: &ShaftBooks| self.count_of(shaft) + ahead;
        let right = pairs
            .filter(|(told, shaft)| (i64::from(told.count) - here(shaft)).abs() <= off)
            .count();
        right as f64 / course.shaft.len() as f64
    }

    /// Carries out an action: arms the device outside the wall, so that the control law starts anew, records the action, and
    /// disarms.
    fn play(&mut self, deed: &HandDeed) -> Result<Course, String> {
        self.put(&hand_of(&deed.grip)?, self.in_world(deed.rest_rad[0]))?;
        let bench = &mut self.bench;
        bench.demand(Request::Command(DeviceCommand::Arm))?;
        bench.wait_for(Phase::Armed, 100 * MS)?;
        bench.run(FADED_IN)?;
        let from = bench.link.telemetry.len();
        bench.machine.run_to(CONTROL_TICK.exception())?;
        let rests: Vec<f64> = deed.rest_rad.iter().map(|it| self.in_world(*it)).collect();
        let (rate_hz, last) = (f64::from(self.rate_hz), rests[rests.len() - 1]);
        let ticks = rests.len();
        let now = self.bench.now();
        let world = &mut self.bench.machine.chip_mut().world;
        world.advance(now);
        // The hand's rest point is constant within a control tick, as in the simulator.
        world.lead(move |time| {
            let tick = (time * rate_hz + 1e-6) as usize;
            rests.get(tick).copied().unwrap_or(last)
        });
        let course = self.watch_from_here(from, ticks)?;
        let status = self.bench.status()?;
        if status.phase != Phase::Armed {
            return Err(format!("{} with {:?}", status.phase.name(), status.fault));
        }
        if self.in_step(&course).1 != self.ahead {
            return Err("the device has lost counts".into());
        }
        let disarm = Request::Command(DeviceCommand::Disarm);
        self.bench.demand(disarm)?;
        self.bench.wait_for(Phase::Ready, 100 * MS)?;
        Ok(course)
    }

    /// Appends a row of the recording for each control period. A row has the motor's mean force until the next period, and the
    /// changes of the energies until then. `course` has the start after the last period too.
    fn write(&mut self, deed: &HandDeed, course: &Course, text: &mut String) {
        let period_s = 1.0 / f64::from(self.rate_hz);
        for (index, (told, shaft)) in course.told.iter().zip(&course.shaft).enumerate() {
            let first = *self.first_tick.get_or_insert(told.tick);
            let next = course.shaft.get(index + 1).unwrap_or(shaft);
            // Writing into a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                deed.grip,
                deed.deed,
                told.tick,
                f64::from(told.tick.wrapping_sub(first)) * period_s,
                told.count,
                told.penetration_rad,
                told.force_n_m,
                told.phase.name(),
                limits(told.limits),
                self.in_programme(shaft.angle_rad),
                shaft.rad_per_s,
                -(next.impulse_n_m_s - shaft.impulse_n_m_s) / period_s,
                -(next.motor_j - shaft.motor_j),
                next.loss_j - shaft.loss_j,
                self.surface_rad,
            );
        }
    }
}

/// Names of the limits that act, as `touchstone monitor` writes them.
fn limits(bits: u8) -> String {
    let limits = Limits::from_wire(bits);
    let names = Limit::ALL.into_iter().filter(|limit| limits.has(*limit));
    let names: Vec<String> = names.map(|it| format!("{it:?}").to_lowercase()).collect();
    names.join("+")
}

#[cfg(test)]
mod tests {
    use super::HandProgramme;

    #[test]
    fn a_programme_is_read_deed_by_deed_and_what_is_none_is_named() {
        let text = "grip,deed,time_s,surface_rad,rest_rad\n\
                    light,press,0,0.5,0.1\nlight,press,0.001,0.5,0.2\nlight,move-1,0,0.5,0.3\nlight,move-1,0.001,0.5,0.4\n";
        let read = HandProgramme::parse(text).unwrap();
        assert_eq!((read.deeds.len(), read.rate_hz), (2, 1_000));
        assert_eq!(read.deeds[1].deed, "move-1");
        assert_eq!(read.deeds[1].rest_rad, [0.3, 0.4]);
        assert!((read.surface_rad - 0.5).abs() < 1e-12);
        for (wrong, said) in [
            ("", "begin"),
            ("grip,deed,time_s,surface_rad,rest_rad\n", "no deed"),
            (
                "grip,deed,time_s,surface_rad,rest_rad\nlight,press,0,x,1\n",
                "line 2",
            ),
        ] {
            assert!(HandProgramme::parse(wrong).unwrap_err().contains(said));
        }
    }
}
