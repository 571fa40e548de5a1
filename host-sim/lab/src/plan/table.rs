//! Formats the description of how the simulator runs a scene as text for a terminal.

use std::fmt::Write;

use super::{Omitted, Planned};

/// Formats the description of how a scene is simulated as text.
#[must_use]
pub fn render(plan: &Planned) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}: {} states", plan.scene, plan.states.len());
    let _ = writeln!(out, "  {}", plan.states.join(", "));
    let _ = writeln!(out, "eigenvalues of the linear part, 1/s");
    for value in &plan.eigenvalues {
        let _ = match value.frequency_hz {
            Some(hz) => writeln!(
                out,
                "  {:>12.4} ± {:.4} i  ({hz:.2} Hz)",
                value.re_per_s, value.im_rad_per_s
            ),
            None => writeln!(out, "  {:>12.4}", value.re_per_s),
        };
    }
    let substeps = match plan.substeps {
        1 => String::new(),
        count => format!(", {count} substeps a tick"),
    };
    let _ = writeln!(out, "tier: {}{substeps}", plan.tier);
    for reason in &plan.reasons {
        let _ = writeln!(out, "  {reason}");
    }
    cost(&mut out, plan);
    if plan.omitted.is_empty() {
        return out;
    }
    let percent = 100.0 * plan.tolerance;
    let matters = |effect: &&Omitted| effect.verdict.is_some() || !effect.moves.is_empty();
    let _ = writeln!(
        out,
        "not in the scene, and would move an output by more than {percent} %"
    );
    if !plan.omitted.iter().any(|effect| matters(&effect)) {
        let _ = writeln!(out, "  none");
    }
    for effect in plan.omitted.iter().filter(matters) {
        let verdict = effect
            .verdict
            .map_or(String::new(), |verdict| format!(", verdict {verdict}"));
        let _ = writeln!(out, "  {} at {}{verdict}", effect.name, effect.typical);
        for moved in &effect.moves {
            let shown =
                |value: Option<f64>| value.map_or("none".to_owned(), |it| format!("{it:.4e}"));
            let _ = writeln!(
                out,
                "    {}: {} to {}",
                moved.output,
                shown(moved.without),
                shown(moved.with)
            );
        }
    }
    let others: Vec<&str> = plan
        .omitted
        .iter()
        .filter(|effect| !matters(effect) && effect.not_tried.is_none())
        .map(|effect| effect.name)
        .collect();
    if !others.is_empty() {
        let _ = writeln!(
            out,
            "not in the scene, and would not: {}",
            others.join(", ")
        );
    }
    for effect in &plan.omitted {
        if let Some(why) = &effect.not_tried {
            let _ = writeln!(out, "not tried: {}: {why}", effect.name);
        }
    }
    out
}

fn cost(out: &mut String, plan: &Planned) {
    let predicted = plan
        .predicted_instructions
        .map_or("unknown".to_owned(), |count| {
            format!("{count:.0} instructions")
        });
    let measured = plan.measured.map_or(String::new(), |spread| {
        format!(
            ", measured {:.0} ns (least; median {:.0} ns)",
            spread.least_ns, spread.median_ns
        )
    });
    let _ = writeln!(out, "cost of a tick: predicted {predicted}{measured}");
    for effect in &plan.effects {
        let instructions = effect.instructions.map_or(String::new(), |count| {
            format!("{count:>+10.0} instructions alone")
        });
        let ns = effect
            .ns
            .map_or(String::new(), |ns| format!("{ns:>+10.0} ns here"));
        let _ = writeln!(
            out,
            "  {:<20}{:<32}{instructions}{ns}",
            effect.name, effect.place
        );
    }
}
