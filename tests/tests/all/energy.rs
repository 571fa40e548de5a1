//! Checks the energies of a wall over ten million control periods: the control law's own sum, the energy that passed between device
//! and hand, and where that energy went.

use touchstone_control::observer::{ExactObserver, ThesisObserver};
use touchstone_control::{CountScale, Force, Position, Settings, Si};
use touchstone_sim::run::chain::{Crossing, ExactAngle, Flow, Limited, Sampled, Staged};
use touchstone_sim::run::wall::Controlled;
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_world::plant::{
    Coulomb, Device, HeldCoulomb, Kinematics as _, MEDIUM, State, Stepper,
};

const TICKS: u64 = 10_000_000;
const PERIOD_S: f64 = 1e-3;
/// Position of the wall's surface, rad. The value is not a sum of powers of two, so that penetrations are rounded.
const SURFACE_RAD: f64 = 0.3;

/// A sum whose rounding error does not grow with the number of terms (Neumaier's compensated summation).
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    total: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let next = self.total + x;
        self.lost += if self.total.abs() >= x.abs() {
            (self.total - next) + x
        } else {
            (x - next) + self.total
        };
        self.total = next;
    }
    fn value(self) -> f64 {
        self.total + self.lost
    }
}

/// Energies in J that flow into and out of device and hand.
#[derive(Debug, Clone, Copy, Default)]
struct Books {
    motor: Sum,
    throughput: f64,
    rest_point: Sum,
    device_loss: Sum,
    hand_loss: Sum,
    last_rest: Option<f64>,
}

/// A simulated device and hand whose energies are added up in every control period.
struct Audited<'a, S> {
    plant: S,
    books: &'a mut Books,
}

impl<S: Stepper> Crossing for Audited<'_, S> {
    type State = S::State;

    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) {
        self.cross_with_flow(state, torque_n_m, rest_rad);
    }

    fn cross_with_flow(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        let books = &mut *self.books;
        let last = books.last_rest.replace(rest_rad).unwrap_or(rest_rad);
        // The rest point of the hand jumps at the tick, which strains the hand's spring.
        books.rest_point.add(
            self.plant.stored_energy_j(state, rest_rad) - self.plant.stored_energy_j(state, last),
        );
        let before = state.position();
        let loss = self.plant.step_with_loss(state, torque_n_m, rest_rad);
        let motor_j = torque_n_m * (state.position() - before);
        books.motor.add(motor_j);
        books.throughput += motor_j.abs();
        books.device_loss.add(loss.device_j);
        books.hand_loss.add(loss.hand_j);
        Flow {
            torque_n_m,
            motor_j,
            device_loss_j: loss.device_j,
            stored_j: 0.0,
        }
    }
}

/// Energy observers that get the same positions and forces as the control law.
struct Observers {
    exact: ExactObserver<f64>,
    thesis: ThesisObserver<f64>,
    contact: u64,
    /// Energy in J that passed between device and hand, as the simulated device calculates it.
    port: Sum,
}

impl Recorder for Observers {
    fn record(&mut self, tick: &Tick) {
        let (e, f) = (Position(tick.told_rad), Force(tick.force_n_m));
        self.exact.tick(e, f);
        self.thesis.tick(e, f);
        self.contact += u64::from(tick.force_n_m != 0.0);
        self.port.add(tick.absorbed_j);
    }
}

/// Rest position in rad of a simulated hand that presses harder and softer, and leaves the wall now and then.
fn rest_rad(time_s: f64) -> f64 {
    let slow = (0.7 * time_s).sin();
    let fast = (12.6 * time_s).sin();
    SURFACE_RAD + 3.0 + 2.6 * slow + 1.0 * fast
}

struct Finished {
    observers: Observers,
    books: Books,
    stored_change: f64,
    end_rad: f64,
}

fn press(settings: &Settings) -> Finished {
    let device = Device {
        inertia: 1e-4,
        damping: 4e-4,
        friction: Some(Coulomb {
            kinetic: 3e-4,
            breakaway: 3e-4,
        }),
    };
    let plant = HeldCoulomb::new(&device, &MEDIUM, PERIOD_S).unwrap();
    let start = State::at_rest(SURFACE_RAD - 0.05);
    let scale = CountScale::new(1, Si::ZERO).unwrap();
    let law = Sampled {
        sensor: ExactAngle {
            surface_rad: SURFACE_RAD,
        },
        wall: Controlled::<f64>::new(settings, scale).unwrap(),
    };
    let mut control = Staged::around(Box::new(law), Limited { limit_n_m: 0.5 });
    let mut observers = Observers {
        exact: ExactObserver::new(Position(start.position() - SURFACE_RAD)),
        thesis: ThesisObserver::new(Position(start.position() - SURFACE_RAD)),
        contact: 0,
        port: Sum::default(),
    };
    let mut books = Books::default();
    let stored_before = plant.stored_energy_j(&start, rest_rad(0.0));
    let mut audited = Audited {
        plant: plant.clone(),
        books: &mut books,
    };
    let end = run::cycle_recorded(
        &mut audited,
        start,
        control.as_mut(),
        rest_rad,
        0..TICKS,
        PERIOD_S,
        &mut observers,
    );
    let last_rest = books.last_rest.unwrap();
    Finished {
        observers,
        books,
        stored_change: plant.stored_energy_j(&end, last_rest) - stored_before,
        end_rad: end.position(),
    }
}

fn enhanced() -> Settings {
    Settings {
        k_desired: Si::lit("5"),
        ..Settings::thesis()
    }
}

#[test]
fn over_ten_million_ticks_the_exact_observer_reads_what_crossed_the_port_and_the_books_close() {
    let mut done = press(&enhanced());
    let share = done.observers.contact as f64 / TICKS as f64;
    assert!(share > 0.7 && share < 1.0, "in contact {share}");
    // The force of the last tick has acted; no force follows.
    let end = Position(done.end_rad - SURFACE_RAD);
    let observed = done.observers.exact.tick(end, Force(0.0)).to_f64();
    let port = done.observers.port.value();
    let throughput = done.books.throughput;
    assert!(throughput > 1.0, "something went through: {throughput} J");
    let error = (observed - port).abs() / throughput;
    let thesis = done.observers.thesis.energy.to_f64();
    println!(
        "{TICKS} ticks, {:.1} % in contact, {throughput:.3} J through the port, {port:.6} J absorbed: \
         the exact observer is off by {error:.1e} of the throughput, the thesis' by {:.1e}",
        100.0 * share,
        (thesis - port).abs() / throughput
    );
    // The observer's plain sum rounds each tick by up to half a unit in the last place of the sum; that limits the error.
    assert!(error < 1e-9);
    // The same comparison shows that the observer in the thesis' form is wrong.
    assert!((thesis - port).abs() > 1e-3 * throughput);

    let books = &done.books;
    assert_eq!(books.motor.value(), -port, "one port, two accounts");
    let (rest, device, hand) = (
        books.rest_point.value(),
        books.device_loss.value(),
        books.hand_loss.value(),
    );
    let gap = books.motor.value() + rest - device - hand - done.stored_change;
    let turnover = throughput + rest.abs() + device + hand;
    println!(
        "motor {:.6} J, rest point {rest:.6} J, device {device:.6} J, hand {hand:.6} J, stored {:+.6} J: gap {:.1e} of the turnover",
        books.motor.value(),
        done.stored_change,
        gap.abs() / turnover
    );
    assert!(device > 0.0 && hand > 0.0 && rest > 0.0);
    // Rounding of the states, 1e-16 rad per tick times about 0.1 N·m, and of the losses' quadratic forms.
    assert!(gap.abs() < 1e-9 * turnover);
}

#[test]
fn the_audit_notices_a_loss_of_a_millionth_that_is_left_out() {
    let settings = Settings {
        force_limit: Si::lit("0.01"),
        ..enhanced()
    };
    let done = press(&settings);
    let books = &done.books;
    let spent = books.device_loss.value() * (1.0 - 1e-6) + books.hand_loss.value();
    let gap = books.motor.value() + books.rest_point.value() - spent - done.stored_change;
    let turnover = books.throughput + books.rest_point.value().abs() + spent;
    assert!(gap.abs() > 1e-9 * turnover, "{}", gap.abs() / turnover);
}
