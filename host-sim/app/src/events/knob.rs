//! A board as a knob with numbered positions: its feel, its position numbers, and the requests of other programs.

use super::feel::{Feel, Refusal};
use super::kept::Kept;
use super::lines::Lines;
use super::wish::Wish;
use super::{Options, RECORDS_PER_S};
use crate::config::environment::{as_scene, of_scene};
use crate::out::{note, tell};
use crate::zero::{Angles, Zero};
use touchstone_device::Client;
use touchstone_protocol::settings::environment::Surround;
use touchstone_protocol::{Decimal, DeviceSettings, Reply, Request, Telemetry};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::positions::{Place, Positions};
use touchstone_sim::scene::Environment;

/// A board with its numbered positions.
#[derive(Debug)]
pub struct Knob<'a> {
    options: &'a Options,
    settings: &'a DeviceSettings,
    /// The numbered positions of the present feel.
    pub positions: Positions,
    /// The feel that a program chose last; `None` before any choice.
    feel: Option<Feel>,
    /// The device's limit on the rate at which the force changes while one feel replaces another.
    change_n_m_per_s: Decimal,
    /// The number that the present position gets at the next record; `None` to keep its number.
    called: Option<i64>,
    kept: Option<Kept>,
    zero: Zero,
}

impl<'a> Knob<'a> {
    /// Reads the board's feel and makes the numbered positions. If the feel has no positions and a program may choose another feel
    /// (`is_asked`), one position is a whole turn.
    ///
    /// # Errors
    /// The board does not answer, or the feel has no positions and `is_asked` is false.
    pub fn new(
        client: &mut Client,
        options: &'a Options,
        settings: &'a DeviceSettings,
        kept: Option<Kept>,
        is_asked: bool,
    ) -> Result<Self> {
        let environment = environment(client)?;
        let positions = match positions(options, &environment) {
            Err(_) if is_asked => unnumbered(),
            positions => positions?,
        };
        let mut called = options.position;
        if let Some(number) = kept.as_ref().and_then(|kept| kept.number) {
            match positions.numbers() {
                None => called = Some(number),
                Some(_) => note!(
                    "note: --keep has no effect here: with end stops or listed detents the knob's angle alone gives the position number"
                ),
            }
        }
        let mut knob = Self {
            options,
            settings,
            positions,
            feel: None,
            change_n_m_per_s: environment.change_n_m_per_s,
            called,
            kept,
            zero: Zero::new(settings.timing.rate_hz),
        };
        knob.follow(positions);
        Ok(knob)
    }

    /// Requests telemetry at `RECORDS_PER_S`.
    pub fn ask_for_records(&self, client: &mut Client) -> Result<()> {
        let every = (self.settings.timing.rate_hz / RECORDS_PER_S).max(1);
        client.tell(&Request::Telemetry {
            decimation: u16::try_from(every).unwrap_or(u16::MAX),
        })
    }

    /// Handles one telemetry record: carries out the requests of programs, and reports changes of state and position to them.
    pub fn take(
        &mut self,
        client: &mut Client,
        lines: &mut Lines,
        record: &Telemetry,
    ) -> Result<()> {
        for (from, wish) in lines.wishes(&self.positions) {
            match wish {
                Wish::Position(number) => self.called = Some(number.into()),
                Wish::Feel(asked) => {
                    let limit_n_m = self.settings.law.force_limit_n_m.to_num();
                    let taken = match Feel::read(&asked, limit_n_m) {
                        Ok(feel) => self.render(client, &feel)?.map(|()| feel),
                        Err(refusal) => Err(refusal),
                    };
                    match taken {
                        Ok(feel) => self.feel = Some(feel),
                        Err(refusal) => lines.refuse(from, &refusal),
                    }
                }
            }
        }
        let angles = self.zero.see(record);
        if let Angles::Reset { before } = angles {
            lines.go_on_from(before, record);
        }
        lines.state(record)?;
        let counts = f64::from(self.settings.encoder.counts_per_rev);
        let angle_rad = f64::from(record.count) / counts * std::f64::consts::TAU;
        let mut place = match angles {
            Angles::Same => self.positions.take(angle_rad),
            // During a calibration the motor turns the shaft, not a hand, so positions are not reported.
            Angles::Calibrating => return Ok(()),
            Angles::Calibrated => {
                let number = self.positions.number();
                Some(self.positions.settle(angle_rad, number))
            }
            Angles::Reset { .. } => {
                let number = self.positions.number();
                self.begin_again(client)?;
                Some(self.positions.settle(angle_rad, number))
            }
        };
        if let Some(number) = self.called.take() {
            self.positions.call(number);
            lines.number(number);
            place = Some(Place {
                position: number,
                change: 0,
                beside: self.positions.beside(angle_rad),
            });
        }
        if let Some(place) = place {
            lines.position(record, &place, angle_rad, &self.positions)?;
        }
        if let (Some(kept), Some(number)) = (&mut self.kept, self.positions.number()) {
            kept.see(number)?;
        }
        Ok(())
    }

    /// Writes the position's number to the file of `--keep`, if there is one.
    pub fn keep(&mut self) -> Result<()> {
        self.kept.as_mut().map_or(Ok(()), Kept::write)
    }

    /// Restores telemetry rate and feel after a reset, which set the board back to its stored settings. If no program chose a feel,
    /// the positions are those of the board's stored feel.
    fn begin_again(&mut self, client: &mut Client) -> Result<()> {
        tell!("the board was reset");
        self.ask_for_records(client)?;
        if let Some(feel) = self.feel.clone() {
            if let Err(refusal) = self.render(client, &feel)? {
                note!("note: {}", refusal.problem);
            }
            return Ok(());
        }
        let environment = environment(client)?;
        let positions = positions(self.options, &environment).unwrap_or_else(|_| unnumbered());
        self.follow(positions);
        Ok(())
    }

    fn follow(&mut self, positions: Positions) {
        self.positions = positions;
        self.positions.hysteresis = self.options.hysteresis;
        self.positions.bias = self.options.bias;
    }

    /// Sends a feel to the board. If the board refuses it, nothing changes and the inner error says why.
    fn render(
        &mut self,
        client: &mut Client,
        feel: &Feel,
    ) -> Result<std::result::Result<(), Refusal>> {
        if !client.identity().board.is_large() {
            let problem = "this board's flash is too small for feels".to_owned();
            return Ok(Err(Refusal::of_request(problem)));
        }
        let mut environment = of_scene(&feel.around);
        environment.change_n_m_per_s = self.change_n_m_per_s;
        if let Err(error) = environment.check(self.settings) {
            let name = feel.name.as_deref().unwrap_or("that was sent");
            return Ok(Err(Refusal {
                setting: Some(error.path.to_string()),
                problem: format!("the device refuses the feel {name}: {error}"),
            }));
        }
        match client.ask_or_refusal(&Request::SetEnvironment(environment))? {
            Ok(Reply::Taken(_)) => {}
            Ok(other) => return Err(client.odd(&other)),
            // For example during a calibration.
            Err(refused) => return Ok(Err(refused.into())),
        }
        tell!("feel {}", feel.name.as_deref().unwrap_or("of a program"));
        let own = Positions::of(&feel.around);
        self.follow(own.unwrap_or_else(|| by_pitch(self.options, &feel.around)));
        Ok(Ok(()))
    }
}

/// The positions of a knob whose feel has none: one for each `--pitch`, or for each whole turn.
fn by_pitch(options: &Options, around: &Environment) -> Positions {
    match options.pitch {
        Some(degrees) => Positions::every(degrees.to_radians(), 0.0).between(around),
        None => unnumbered(),
    }
}

/// The positions of a knob whose feel has none: one position per whole turn.
const fn unnumbered() -> Positions {
    Positions::every(std::f64::consts::TAU, 0.0)
}

/// Requests the device's detents, end stops and further walls. A board without memory for them has only its single wall.
fn environment(client: &mut Client) -> Result<Surround> {
    if !client.identity().board.is_large() {
        return Ok(Surround::default());
    }
    match client.ask(&Request::Environment)? {
        Reply::Environment(environment) => Ok(environment),
        other => Err(client.odd(&other)),
    }
}

fn positions(options: &Options, environment: &Surround) -> Result<Positions> {
    let environment = as_scene(environment);
    let own = Positions::of(&environment);
    match options.pitch {
        Some(degrees) => {
            let origin_rad = own.map_or(0.0, |it| it.origin_rad);
            Ok(Positions::every(degrees.to_radians(), origin_rad).between(&environment))
        }
        None => own.ok_or_else(|| Error::Option {
            option: "--pitch".into(),
            problem: "the device has no detents, no profile with places of rest and no clicks, so it has no positions to count"
                .into(),
            fix: "give the distance between two positions, e.g. --pitch 10, or send it a feel with `touchstone config environment coarse-detents`"
                .into(),
        }),
    }
}
