//! Counts the firmware's costs: instructions and cycles of the control law, the control interrupt and the current loop, and the
//! stack in use.

use touchstone_control::{ChangeOfForce, Si};
use touchstone_protocol::settings::DeviceSettings;
use touchstone_protocol::{DeviceCommand, Phase, Request, Surround};
use touchstone_world::plant::{FIRM, Hand, MEDIUM};

use crate::bench::{Bench, MS, Setup};
use crate::board::{Board, Encoder};
use crate::budgets::{CONTROL, CURRENT, FEEL, LAW, PROCESSOR_PERCENT};
use crate::cpu::core::{Cost, WAIT_STATES};
use crate::cpu::decode::EXCEPTION;
use crate::cpu::elf::Program;
use crate::cpu::handler::{CONTROL_TICK, CURRENT_LOOP, Handler};
use crate::fil::around;
use crate::fil::fault::Fault;
use crate::fil::jobs::Programs;
use crate::peripheral::CORE_HZ;
use crate::peripheral::flash::BASE as FLASH;
use crate::peripheral::spi::SlaveFault;
use crate::peripheral::timer::gates::GateDriver;

/// Rate of the current loop in hertz: one run per PWM period.
const PWM_HZ: u64 = 20_000;
/// Fastest control rate of the firmware, Hz.
const FASTEST_HZ: u64 = 10_000;

/// A workload under which the costs are counted: settings of the device, and a hand that presses the knob.
struct Case {
    name: &'static str,
    settings: fn(&mut DeviceSettings),
    hand: Hand,
    torque_n_m: f64,
    ramp_s: f64,
}

/// By board, the encoders that are counted beside the one in [`Board::all`].
const MORE_ENCODERS: &[(&str, &[Encoder])] = &[
    (
        "nucleo-g474re",
        &[Encoder::Mt6701, Encoder::Incremental(16_384)],
    ),
    ("nucleo-g431rb-ihm16m1", &[Encoder::Mt6701]),
];

/// The workloads after the hard press use a light press: the hard press heats the motor, which halves the allowed force. With half
/// of its force a wall swings under a strong hand (fault 26).
const CASES: &[Case] = &[
    Case {
        name: "press, 1 N·m/rad",
        settings: |settings| settings.wall.k_desired_n_m_per_rad = Si::lit("1"),
        hand: MEDIUM,
        torque_n_m: 0.1,
        ramp_s: 0.5,
    },
    Case {
        name: "press, 5 N·m/rad",
        settings: |settings| settings.wall.k_desired_n_m_per_rad = Si::lit("5"),
        hand: MEDIUM,
        torque_n_m: 0.1,
        ramp_s: 0.5,
    },
    Case {
        name: "tap, 5 N·m/rad",
        settings: |settings| settings.wall.k_desired_n_m_per_rad = Si::lit("5"),
        hand: FIRM,
        torque_n_m: 0.15,
        ramp_s: 0.06,
    },
    Case {
        name: "hard press, 20 N·m/rad",
        settings: |settings| settings.wall.k_desired_n_m_per_rad = Si::lit("20"),
        hand: FIRM,
        torque_n_m: 0.3,
        ramp_s: 0.2,
    },
    Case {
        name: "press, all steps at their largest",
        settings: |settings| {
            settings.law.step_of_ideal_per_ms = Si::lit("1");
            settings.law.limit_of_force_per_ms = Si::lit("1");
            settings.law.limit_of_penetration_per_ms = Si::lit("1");
        },
        hand: MEDIUM,
        torque_n_m: 0.05,
        ramp_s: 0.3,
    },
    Case {
        name: "press, nothing lent",
        settings: |settings| settings.law.energy_credit_j = Si::lit("0"),
        hand: MEDIUM,
        torque_n_m: 0.05,
        ramp_s: 0.3,
    },
    Case {
        name: "press, 2 kHz",
        settings: |settings| {
            settings.timing.rate_hz = 2_000;
            settings.law.guard.change = ChangeOfForce::Estimated;
        },
        hand: MEDIUM,
        torque_n_m: 0.05,
        ramp_s: 0.3,
    },
];

/// Faults that switch the outputs off, by name. The costs are counted with each, because a control period with a fault executes
/// other code than one without.
const FAULTS: &[(&str, Fault)] = &[
    ("  bus at 33 V", Fault::Bus(33.0, 0)),
    ("  phase A reads +8 A", Fault::Sensor(0, 8.0)),
    ("  encoder's parity", Fault::Encoder(SlaveFault::FlipBit(0))),
    ("  encoder's bus hangs", Fault::BusHangs),
    ("  shaft turned at +150 rad/s", Fault::Turned(150.0)),
    ("  flicked at 90 rad/s", Fault::Flicked(-90.0, 12_000)),
    ("  break that stays", Fault::Break(0)),
    ("  comparator of phase A stays", Fault::Comparator(1, 0)),
];

/// Counted costs of the control law, the control interrupt and the current loop.
#[derive(Debug, Clone, Copy, Default)]
struct Counted {
    law: Cost,
    control: Handler,
    current: Handler,
}

/// The largest costs and the exceeded limits, collected while the table is printed row by row.
#[derive(Default)]
struct Table {
    worst: Counted,
    /// Costs while the board renders the largest feel; `None` on boards that render none.
    feel: Option<Counted>,
    stack_used: u32,
    wrong: Vec<String>,
}

impl Table {
    /// Prints one row of the table: the costs that were counted since the previous row.
    fn row(&mut self, name: &str, result: Result<(), String>, bench: &mut Bench, stack_top: u32) {
        let counted = self.shown(name, result, bench, stack_top);
        let worst = &mut self.worst;
        worst.law = worst.law.worst(counted.law);
        worst.control.worst = worst.control.worst.worst(counted.control.worst);
        worst.current.worst = worst.current.worst.worst(counted.current.worst);
    }

    /// Prints a row, and returns the costs that were counted since the previous row.
    fn shown(
        &mut self,
        name: &str,
        result: Result<(), String>,
        bench: &mut Bench,
        stack_top: u32,
    ) -> Counted {
        let counted = take(bench);
        let show = |cost: Cost| {
            format!(
                "{} ({}, {})",
                cost.instructions,
                cost.cycles,
                cost.waiting()
            )
        };
        let law = match counted.law.instructions {
            0 => "-".into(),
            _ => show(counted.law),
        };
        let (control, current) = (show(counted.control.worst), show(counted.current.worst));
        println!("{name:<36}{law:>22}{control:>24}{current:>22}");
        self.stack_used = self.stack_used.max(bench.machine.stack_used(stack_top));
        if let Err(error) = result {
            println!("WRONG: {name}: {error}");
            self.wrong.push(error);
        }
        counted
    }
}

/// Counts the costs of the programs of all boards, prints a table per board and a summary as the last line, and returns the exit
/// code.
#[must_use]
pub fn run(programs: &Programs) -> u8 {
    let (mut code, mut summaries) = (0, Vec::new());
    for board in Board::all() {
        let Some(program) = programs.of(&board) else {
            continue;
        };
        let more = MORE_ENCODERS.iter().filter(|(name, _)| *name == board.name);
        let more = more.flat_map(|(_, encoders)| *encoders);
        let mut boards = vec![board.clone()];
        boards.extend(more.map(|&encoder| Board {
            encoder,
            ..board.clone()
        }));
        match count(program, &boards) {
            Ok((is_right, summary)) => {
                code |= u8::from(!is_right);
                summaries.push(format!("{}: {summary}", board.name));
            }
            Err(error) => {
                println!("WRONG: {error}");
                return 1;
            }
        }
    }
    println!(
        "Cycles by the table of the Cortex-M4's manual, each class at its upper value, along the paths that ran, without wait \
         states; waiting: the same with {WAIT_STATES} for every double word of flash that is fetched and every constant read \
         beside the code, as without cache and prefetch, tables left out. A board lies between. Handlers without what \
         interrupted them; entry and return, 12 cycles each, on top."
    );
    println!("{}", summaries.join("; "));
    code
}

/// Runs all workloads on a board with the first of its encoders, and some workloads with its other encoders. Prints the table.
/// Returns whether every cost is within its limit, and a summary.
fn count(program: &Program, boards: &[Board]) -> Result<(bool, String), String> {
    println!(
        "{:<36}{:>22}{:>24}{:>22}",
        "instructions (cycles, waiting), worst", "law", "control interrupt", "current loop"
    );
    let top = program.symbol("_stack_start").unwrap_or(0);
    let size = top - program.symbol("_stack_end").unwrap_or(top);
    let mut table = Table::default();
    let laws = program.functions(&["touchstone_drive", "law_tick"]);
    for (index, board) in boards.iter().enumerate() {
        let encoder = board.encoder;
        let setup = Setup::on(board.clone());
        let mut bench = Bench::new(program, &setup)?;
        for (start, _, name) in &laws {
            bench.machine.chip_mut().core.watch(name, *start);
        }
        println!("{} with {encoder:?}", board.name);
        bench.machine.chip_mut().core.by_place = vec![0; board.flash_bytes / 8];
        let booted = bench.boot().map(|_| ());
        table.row("start", booted, &mut bench, top);
        // The walls of the other workloads are too stiff for a board with a small motor. They run on the NUCLEO with the larger
        // motor, whose program is the same.
        let (cases, faults) = match index {
            0 if board.has_small_motor() => (&CASES[..1], FAULTS),
            0 => (CASES, FAULTS),
            _ => (&CASES[..1], &FAULTS[..1]),
        };
        let faults = faults.iter().filter(|(_, fault)| can_have(board, *fault));
        for case in cases {
            let calibrated = calibrate(&mut bench, case, encoder);
            table.row("  calibration and fading in", calibrated, &mut bench, top);
            let played = play(&mut bench, case);
            table.row(case.name, played, &mut bench, top);
        }
        for (name, fault) in faults {
            let failed =
                calibrate(&mut bench, &CASES[0], encoder).and_then(|()| fail(&mut bench, *fault));
            table.row(name, failed, &mut bench, top);
            // A light rotor coasts for seconds, and a calibration needs it at rest.
            if board.has_small_motor() && matches!(fault, Fault::Flicked(..)) {
                bench.run(5_000 * MS)?;
            }
        }
        tell_places(program, &bench);
        if index == 0 && board.is_large() {
            let calibrated = calibrate(&mut bench, &CASES[0], encoder);
            table.row("  calibration and fading in", calibrated, &mut bench, top);
            let felt = feel(&mut bench, &setup);
            table.feel = Some(table.shown("the largest feel", felt, &mut bench, top));
        }
    }
    println!("stack: {} of {size} bytes were used", table.stack_used);
    let worst = &table.worst;
    let mut over = Vec::new();
    for (name, cost, budget) in [
        ("law", worst.law, LAW),
        ("control interrupt", worst.control.worst, CONTROL),
        ("current loop", worst.current.worst, CURRENT),
    ] {
        let count = cost.instructions;
        let within = if count > budget { "OVER" } else { "within" };
        println!(
            "{name}: at most {count} instructions, {within} the budget of {budget}; {} cycles, waiting {}",
            cost.cycles,
            cost.waiting()
        );
        if count > budget {
            over.push(name);
        }
    }
    if let Some(feel) = &table.feel {
        let (control, current) = (feel.control.worst, feel.current.worst);
        let free =
            |current: u64| CORE_HZ * PROCESSOR_PERCENT / 100 - (current + 2 * EXCEPTION) * PWM_HZ;
        let fastest = |control: u64, current: u64| free(current) / (control + 2 * EXCEPTION);
        if control.instructions > FEEL {
            over.push("largest feel");
        }
        println!(
            "largest feel: control interrupt at most {} of {FEEL} instructions; with {PROCESSOR_PERCENT} % of the processor up to {} Hz without wait states, {} Hz waiting",
            control.instructions,
            fastest(control.cycles, current.cycles),
            fastest(control.waiting(), current.waiting())
        );
    }
    for rate_hz in [1_000, FASTEST_HZ] {
        let taken = |control: u64, current: u64| {
            let both = (control + 2 * EXCEPTION) * rate_hz + (current + 2 * EXCEPTION) * PWM_HZ;
            100 * both / CORE_HZ
        };
        let (control, current) = (worst.control.worst, worst.current.worst);
        println!(
            "processor at {rate_hz} Hz, every run the worst: {} % without wait states, {} % waiting",
            taken(control.cycles, current.cycles),
            taken(control.waiting(), current.waiting())
        );
        let is_fast = boards.iter().all(|board| board.ccm_bytes > 0);
        if is_fast && taken(control.waiting(), current.waiting()) > PROCESSOR_PERCENT {
            over.push("processor");
        }
    }
    if laws.is_empty() {
        println!(
            "the law is not a function of its own in this program: it is counted with the control interrupt"
        );
    }
    let is_right = table.wrong.is_empty() && over.is_empty() && table.stack_used <= size;
    Ok((is_right, summary(worst, &over, table.stack_used, size)))
}

/// Prints which functions of the current loop and the control interrupt were fetched from flash most often. Boards without CCM RAM,
/// the memory without wait states, are left out.
fn tell_places(program: &Program, bench: &Bench) {
    if bench.machine.chip().board.ccm_bytes == 0 {
        return;
    }

    let mut by_function = std::collections::BTreeMap::<&str, u64>::new();
    let counts = bench.machine.chip().core.by_place.iter().enumerate();
    for (at, count) in counts.filter(|(_, count)| **count > 0) {
        let address = FLASH + 8 * at as u32;
        let name = program.function_at(address).unwrap_or("?");
        *by_function.entry(name).or_default() += u64::from(*count);
    }
    let mut most: Vec<_> = by_function.into_iter().collect();
    most.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
    let most = most.iter().take(5);
    let most = most.map(|(name, count)| format!("{name} {count} times"));
    let most = most.collect::<Vec<_>>().join(", ");
    println!("  fetched from flash: {most}");
}

fn summary(worst: &Counted, over: &[&str], used: u32, size: u32) -> String {
    let over = match over {
        [] => "within their budgets".to_owned(),
        over => format!("OVER their budgets: {}", over.join(", ")),
    };
    format!(
        "law {}, control interrupt {}, current loop {} instructions, {over}; stack {used} of {size} bytes",
        worst.law.instructions, worst.control.worst.instructions, worst.current.worst.instructions
    )
}

/// Whether a fault can occur on a board. Some faults need an encoder on the SPI bus or a current sensor; the break signal comes
/// from a pin on some boards and from comparators on others.
fn can_have(board: &Board, fault: Fault) -> bool {
    match fault {
        Fault::Encoder(_) | Fault::BusHangs => !matches!(board.encoder, Encoder::Incremental(_)),
        Fault::Sensor(..) => board.measures_current(),
        Fault::Break(_) => board.gates != GateDriver::L6387,
        Fault::Comparator(..) => board.gates == GateDriver::L6387,
        _ => true,
    }
}

/// Returns the costs counted since the last call, and resets the counters.
fn take(bench: &mut Bench) -> Counted {
    let chip = bench.machine.chip_mut();
    let mut counted = Counted::default();
    for watch in &mut chip.core.watches {
        counted.law = counted.law.worst(std::mem::take(&mut watch.worst));
    }
    counted.control = std::mem::take(&mut chip.handlers[CONTROL_TICK]);
    counted.current = std::mem::take(&mut chip.handlers[CURRENT_LOOP]);
    counted
}

/// Injects a fault while the device is armed, waits 20 ms, and removes the fault.
///
/// Errors: after the 20 ms the device is not in the phase `Fault`. For a fault that turns the knob quickly, the phase `Armed` is no
/// error either.
fn fail(bench: &mut Bench, fault: Fault) -> Result<(), String> {
    fault.inject(bench)?;
    bench.run(20 * MS)?;
    fault.remove(bench);
    match (bench.status()?.phase, fault) {
        (Phase::Fault, _) | (Phase::Armed, Fault::Flicked(..)) => Ok(()),
        (other, _) => Err(format!("{} instead of fault", other.name())),
    }
}

fn calibrate(bench: &mut Bench, case: &Case, encoder: Encoder) -> Result<(), String> {
    bench.release();
    let phase = bench.status()?.phase;
    if phase != Phase::Boot && phase != Phase::Stopped {
        bench.demand(Request::Command(DeviceCommand::Stop))?;
    }
    bench.demand(Request::Defaults)?;
    let turns = bench.machine.chip().board.field_turns_per_s;
    bench.configure(|settings| {
        settings.encoder.kind = encoder.kind();
        settings.calibration.electrical_turns_per_s = turns;
        settings.wall.surface_rad = Si::lit("0.2");
        (case.settings)(settings);
    })?;
    bench.arm()?;
    bench.run(250 * MS)
}

/// Lets a hand sweep through the largest feel for 3.3 s, two swings to and fro.
fn feel(bench: &mut Bench, setup: &Setup) -> Result<(), String> {
    around::set(bench, &around::largest(setup))?;
    around::sweep(bench);
    bench.run(3_300 * MS)?;
    let status = bench.status()?;
    bench.release();
    around::set(bench, &Surround::default())?;
    match status.phase {
        Phase::Armed => Ok(()),
        other => Err(format!("{} with {:?}", other.name(), status.fault)),
    }
}

fn play(bench: &mut Bench, case: &Case) -> Result<(), String> {
    // The torques of the workloads are for a board with a press of 0.1 N·m, as in the thesis. They are scaled to the press of this
    // board.
    let share = bench.machine.chip().board.press_n_m / 0.1;
    bench.press(&case.hand, share * case.torque_n_m, case.ramp_s, 0.3)?;
    let time = (2.0 * case.ramp_s + 0.4) * 1e3;
    bench.run(time as u64 * MS)?;
    let status = bench.status()?;
    match status.phase {
        Phase::Armed => Ok(()),
        other => Err(format!("{} with {:?}", other.name(), status.fault)),
    }
}
