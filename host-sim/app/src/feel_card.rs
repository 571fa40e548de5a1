//! `touchstone scorecard --feel`: judges a knob's feel (detents, torque profile, friction, clicks) instead of a wall.

use super::expect::NOT_MET;
use super::number;
use super::out::{self, say};
use super::progress;
use std::process::ExitCode;
use touchstone_drive::Hardware;
use touchstone_drive::wire::hardware;
use touchstone_lab::scorecard::feel::{FeelCard, Felt, feel_card};
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_sim::error::Result;
use touchstone_sim::scene::{self, Scene};

/// Largest peak-to-peak motion of the resting knob that does not count as a buzz, encoder counts.
const QUIET_COUNTS: f64 = 2.0;
/// Largest difference between the largest commanded torque and the largest torque of the feel's curve ("drawn"), as a fraction of
/// the latter.
const AS_DRAWN: f64 = 0.05;
/// Delay from a position reading to the motor's response, in PWM periods, as for a knob that `touchstone setup` measured.
const DELAY_PERIODS: f64 = 1.5;

/// Options of the scorecard of a feel.
#[derive(Debug, Clone, clap::Args)]
#[group(id = "feel-options")]
#[command(
    next_help_heading = "A feel: torque, rest and positions (exit code 3 if a demand is not met)"
)]
pub struct Options {
    /// Judges the scene's feel (detents, profile, friction, clicks) under three simulated grips, instead of its wall.
    #[arg(long, conflicts_with_all = ["family", "tuned", "out", "programme", "laws"])]
    feel: bool,
    /// With --feel: judges all shipped feels, each as it is, in place of a scene.
    #[arg(long, requires = "feel", conflicts_with_all = ["scene", "k_desired", "settings", "sets"])]
    all_feels: bool,
    /// With --feel: judges the feel with the encoder, rate, delay, torque and guard of each of the five boards.
    #[arg(long, requires = "feel")]
    boards: bool,
    /// With --feel: each grip turns the knob to and fro at 2 to 20 rad/s until it has crossed this many positions, or a round
    /// crosses none.
    #[arg(long, value_name = "N", requires = "feel", default_value_t = 200, value_parser = number::within(1_u64, 100_000_000, "of positions"))]
    crossings: u64,
    /// With --feel: demands at most two encoder counts of motion at rest.
    #[arg(long, requires = "feel")]
    no_buzz: bool,
    /// With --feel: demands that every position is counted once.
    #[arg(long, requires = "feel")]
    positions: bool,
    /// With --feel: demands that the largest commanded torque is within 5 % of the largest drawn one.
    #[arg(long, requires = "feel")]
    as_drawn: bool,
}

impl Options {
    /// Whether the user requested the scorecard of a feel.
    pub const fn is_asked(&self) -> bool {
        self.feel
    }

    /// Judges the feels and prints a table.
    pub fn main(&self, own: &Scene) -> Result<ExitCode> {
        let feels: Vec<Scene> = match self.all_feels {
            true => (scene::feels().into_iter())
                .map(Scene::load)
                .collect::<Result<_>>()?,
            false => vec![own.clone()],
        };
        if let Some(none) = feels.iter().find(|it| it.environment.is_none()) {
            return Err(none.error(
                "environment",
                "the scene has no feel: neither detents nor another haptic effect",
                "give a scene of `touchstone feels`, or leave out --feel to judge the wall",
            ));
        }
        let mut places: Vec<(&'static str, Scene)> = Vec::new();
        for feel in &feels {
            match self.boards {
                true => {
                    for board in Board::ALL {
                        places.push((board.name(), on_board(feel, board)?));
                    }
                }
                false => places.push(("", feel.clone())),
            }
        }
        let bar = progress::bar(places.len() as u64, "turning knobs");
        let mut cards = Vec::new();
        for (board, scene) in &places {
            cards.push((*board, feel_card(scene, self.crossings)?));
            bar.inc(1);
        }
        bar.finish_and_clear();
        out::result(
            || json(&cards),
            || {
                say!("{}", text(&cards).trim_end());
                Ok(())
            },
        )?;
        Ok(self.conclude(&cards))
    }

    /// Prints every demand that is not met, and returns the exit code. It is always demanded that the hand gets no more energy than
    /// the guard allows.
    fn conclude(&self, cards: &[(&str, FeelCard)]) -> ExitCode {
        let mut code = ExitCode::SUCCESS;
        for (board, card, felt) in rows(cards) {
            // A value that is NaN meets no demand.
            let demands = [
                (
                    true,
                    felt.energy_out_j <= felt.energy_allowed_j,
                    format!(
                        "the hand got {:.3} mJ, the guard allows {:.3}",
                        1e3 * felt.energy_out_j,
                        1e3 * felt.energy_allowed_j
                    ),
                ),
                (
                    self.no_buzz,
                    felt.buzz_counts <= QUIET_COUNTS,
                    format!(
                        "--no-buzz: the knob moves by {:.1} counts at rest, at most {QUIET_COUNTS} are allowed",
                        felt.buzz_counts
                    ),
                ),
                (
                    self.positions,
                    felt.counts_right(),
                    format!(
                        "--positions: {} lost and {} doubled of {}",
                        felt.lost, felt.doubled, felt.crossings
                    ),
                ),
                (
                    self.as_drawn,
                    (felt.peak_share).is_none_or(|share| (share - 1.0).abs() <= AS_DRAWN),
                    format!(
                        "--as-drawn: {:.3} of the drawn torque",
                        felt.peak_share.unwrap_or_default()
                    ),
                ),
            ];
            let fails = demands.into_iter().filter(|(asked, met, _)| *asked && !met);
            for (_, _, fail) in fails {
                code = ExitCode::from(NOT_MET);
                eprintln!(
                    "not met: {fail} ({}{board}, grip {})",
                    card.scene, felt.grip
                );
            }
        }
        // Without counted crossings, `--positions` would be met but prove nothing. With --all-feels, feels without positions are
        // allowed.
        for (board, card) in cards.iter().filter(|_| self.positions) {
            let has_none = card.pitch_rad.is_none() && !self.all_feels;
            let counted = card.grips.iter().any(|felt| felt.crossings > 0);
            if has_none || card.pitch_rad.is_some() && !counted {
                code = ExitCode::from(NOT_MET);
                eprintln!(
                    "not met: --positions: no grip crossed a position, so nothing was counted ({}{})",
                    card.scene,
                    on_named(board)
                );
            }
        }
        code
    }
}

fn on_named(board: &str) -> String {
    match board {
        "" => String::new(),
        board => format!(" on {board}"),
    }
}

fn rows<'a>(
    cards: &'a [(&str, FeelCard)],
) -> impl Iterator<Item = (String, &'a FeelCard, &'a Felt)> {
    cards.iter().flat_map(|(board, card)| {
        let on = on_named(board);
        card.grips.iter().map(move |felt| (on.clone(), card, felt))
    })
}

fn json(cards: &[(&str, FeelCard)]) -> serde_json::Value {
    let cards: Vec<_> = (cards.iter())
        .map(|(board, card)| {
            let mut value = serde_json::json!(card);
            if !board.is_empty() {
                value["board"] = (*board).into();
            }
            value
        })
        .collect();
    serde_json::json!({ "feels": cards })
}

fn text(cards: &[(&str, FeelCard)]) -> String {
    let mut text = format!(
        "{:<18} {:<7} {:>8} {:>7} {:>10} {:>6} {:>7} {:>9} {:>5} {:>7} {:>8} {:>13}\n",
        "feel",
        "grip",
        "drawn",
        "peak/",
        "hysteresis",
        "buzz",
        "snap",
        "positions",
        "lost",
        "doubled",
        "limited",
        "energy out"
    );
    text += &format!(
        "{:<18} {:<7} {:>8} {:>7} {:>10} {:>6} {:>7} {:>9} {:>5} {:>7} {:>8} {:>13}\n",
        "",
        "",
        "mN·m",
        "drawn",
        "mN·m",
        "counts",
        "rad/s",
        "crossed",
        "",
        "",
        "20 rad/s",
        "of allowed mJ"
    );
    let mut before = String::new();
    for (on, card, felt) in rows(cards) {
        if on != before && !on.is_empty() {
            text += &format!("{}{on}\n", card.scene);
            before.clone_from(&on);
        }
        let peak = felt
            .peak_share
            .map_or_else(|| "-".to_owned(), |share| format!("{share:.3}"));
        let [.., limited] = felt.limited_share;
        text += &format!(
            "{:<18} {:<7} {:>8.2} {peak:>7} {:>10.2} {:>6.1} {:>7.1} {:>9} {:>5} {:>7} {:>7.1}% {:>6.2} {:>6.1}\n",
            card.scene,
            felt.grip,
            1e3 * felt.drawn_n_m,
            1e3 * felt.hysteresis_n_m,
            felt.buzz_counts,
            felt.snap_rad_per_s,
            felt.crossings,
            felt.lost,
            felt.doubled,
            1e2 * limited,
            1e3 * felt.energy_out_j,
            1e3 * felt.energy_allowed_j,
        );
    }
    let sum: u64 = rows(cards).map(|(_, _, felt)| felt.crossings).sum();
    text + &format!("{sum} positions crossed\n")
}

/// A feel on the knob that the board's default settings are made for: device, law and energy guard are from that knob's scene.
/// Encoder and control rate are from the default settings; delay and current resolution are the board's.
fn on_board(feel: &Scene, board: Board) -> Result<Scene> {
    let settings = DeviceSettings::defaults(board);
    let board_hardware: &Hardware = hardware(board);
    let knob = Scene::load(match board {
        Board::NucleoG474re | Board::BG431bEsc1 => "thesis-knob",
        Board::NucleoG474reIhm16m1 | Board::NucleoG431rbIhm16m1 => "gimbal-knob",
        Board::NucleoG474reSimplefocMini => "voltage-knob",
    })?;
    feel.with(|scene| {
        scene.device = knob.device;
        scene.law = knob.law;
        if let Some(encoder) = &mut scene.encoder {
            encoder.counts_per_rev = f64::from(settings.encoder.counts_per_rev);
        }
        scene.timing.rate_hz = settings.timing.rate_hz;
        scene.timing.computational_delay_s = DELAY_PERIODS / f64::from(board_hardware.pwm_hz);
        if board.senses_current() {
            let constant: f64 = settings.motor.torque_constant_n_m_per_a.to_num();
            let step: f64 = board_hardware.amps_per_code.to_num();
            // The current is read once per PWM period. The mean of the n readings in a control period has a step that is finer by
            // the root of n.
            let readings = f64::from(board_hardware.pwm_hz) / f64::from(settings.timing.rate_hz);
            let step_n_m = constant * step.abs() / readings.sqrt();
            scene.device.amplifier_step_n_m = Some(step_n_m);
        }
    })
}
