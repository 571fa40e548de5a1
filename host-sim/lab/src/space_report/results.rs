//! Builds `results.json` of the comparison in three degrees of freedom.

use super::{FILES, Input};
use crate::thesis::space::held_out::{HeldOut, HeldOutCell};
use crate::thesis::space::held_out_cause::HeldOutCause;
use crate::thesis::space::tuned::DirectionCard;
use crate::thesis::space::{Phase, Record};

/// The numbers of a run with their names, which include the units.
#[must_use]
pub fn numbers(run: &Record) -> [(&'static str, f64); 8] {
    let hold = run.late(Phase::Hold, 0.25);
    let slide = run.late(Phase::Slide, 0.9);
    [
        (
            "displayed_at_rest_n_per_mm",
            run.displayed_n_per_mm(hold.clone()),
        ),
        ("ripple_at_rest_mm", run.ripple_mm(hold)),
        (
            "displayed_sliding_n_per_mm",
            run.displayed_n_per_mm(slide.clone()),
        ),
        ("slide_mm_per_s", run.speed_mm_per_s(slide.clone())),
        (
            "most_tangential_over_normal",
            run.most_tangential(slide.clone()),
        ),
        (
            "largest_tangential_step_over_normal",
            run.largest_jump(slide),
        ),
        ("energy_out_j", run.energy.out_j()),
        ("books_off_j", run.audit_j),
    ]
}

/// Contents of `results.json` for the comparison in three degrees of freedom.
#[must_use]
pub fn results(input: &Input) -> serde_json::Value {
    let runs: Vec<_> = input
        .runs
        .iter()
        .map(|run| {
            let (verdict, why) = run.judged();
            let mut value = serde_json::json!({
                "verdict": verdict.name(),
                "not_judged": why.map(|why| why.to_string()),
                "object": run.cell.object.name(),
                "texture": run.cell.feel.texture_text(),
                "material": run.cell.feel.material_text(run.cell.mechanism),
                "approach": run.cell.approach.name(),
                "k_desired_n_per_mm": run.cell.k_desired_n_per_mm,
                "stopped": run.stopped,
            });
            for (name, number) in numbers(run) {
                value[name] = number.into();
            }
            value
        })
        .collect();
    let claims: Vec<_> = input
        .claims
        .iter()
        .map(|claim| {
            serde_json::json!({
                "name": claim.name,
                "source": claim.source,
                "statement": claim.statement,
                "outcome": claim.outcome.name(),
                "measured": claim.measured,
            })
        })
        .collect();
    serde_json::json!({
        "command": input.command,
        "program": input.program.version,
        "files": FILES,
        "dof": 3,
        "mechanism": input.mechanism.word(),
        "held_out": input.held_out.map(held_out_value),
        "runs": runs,
        "claims": claims,
        "directions": directions(input.cards),
    })
}

/// Entries of `results.json` for every direction: the worst measures, and the measures of every device.
fn directions(cards: &[DirectionCard]) -> Vec<serde_json::Value> {
    let cells = |card: &DirectionCard| -> Vec<_> {
        let cells = card.cells.iter();
        cells
            .map(|(device, found, _)| {
                serde_json::json!({
                    "device": device,
                    "figures": found.figures,
                    "settle_from_ramp_end_s": found.settle_s,
                })
            })
            .collect()
    };
    cards
        .iter()
        .map(|card| {
            let worst = card.worst();
            serde_json::json!({
                "direction": card.at.name,
                "normal": card.at.normal,
                "worst": worst.figures,
                "settle_from_ramp_end_s": worst.settle_s,
                "devices": cells(card),
            })
        })
        .collect()
}

/// Entry of `results.json` for a wall with a measure beyond its limit; `None` if all measures are within the limits.
fn beyond_wall(cell: &HeldOutCell) -> Option<serde_json::Value> {
    let fails = cell.fails();
    let names = || fails.iter().map(|(it, _)| it.heading().0);
    cell.cause.map(|cause| {
        serde_json::json!({
            "wall": cell.drawn.text(),
            "figures": names().collect::<Vec<_>>(),
            "longest_n": cell.longest_n,
            "cause": cause,
        })
    })
}

/// Entry of `results.json` for the walls that were not used to choose a setting.
fn held_out_value(found: &HeldOut) -> serde_json::Value {
    serde_json::json!({
        "seed": found.seed,
        "walls": found.cells.len(),
        "beyond": found.failed(),
        "beyond_at_the_motors_limit": found.failed_by(HeldOutCause::MotorsLimit),
        "beyond_walls": found.cells.iter().filter_map(beyond_wall).collect::<Vec<_>>(),
        "settle_from_ramp_end_s": found.settle_s(),
        "worst": found.worst(),
    })
}
