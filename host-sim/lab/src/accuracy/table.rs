//! Formats the results of an accuracy measurement as a text table for a terminal.

use std::fmt::Write;

use super::plant::Point;
use super::{Accuracy, COUNT_RAD};

fn shown(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.2e}"))
}

fn substeps(count: Option<u32>) -> String {
    count.map_or(String::new(), |count| format!("/{count}"))
}

/// Formats all results as lines of text.
#[must_use]
pub fn render(found: &Accuracy) -> String {
    let mut out = String::new();
    write(found, &mut out).expect("a string takes everything");
    out
}

fn write(found: &Accuracy, out: &mut String) -> std::fmt::Result {
    let commit = found
        .program
        .commit
        .map_or("unknown", |commit| &commit[..commit.len().min(12)]);
    writeln!(
        out,
        "{} {} ({commit}{}), {}, {}{}",
        found.program.name,
        found.program.version,
        if found.program.modified {
            ", changed"
        } else {
            ""
        },
        found.machine.compiler,
        found.machine.cpu,
        if found.machine.optimised {
            ""
        } else {
            "; built without optimisation: its times mean nothing"
        },
    )?;
    writeln!(
        out,
        "Times: least [quartiles] of {} repeats, to be compared within this run only.",
        found.repeats
    )?;
    for diagram in &found.plant {
        writeln!(
            out,
            "\nplant, {}: {} ({} ms, {} stops and starts, reference known to {:.0e} rad)",
            diagram.problem,
            diagram.about,
            diagram.ticks,
            diagram.events,
            diagram.reference_floor_rad
        )?;
        writeln!(
            out,
            "  {:<26}{:>12}{:>12}{:>12}  ns per simulated ms",
            "method", "error, rad", "in counts", "energy gap"
        )?;
        for point in &diagram.points {
            let Point {
                method,
                substeps: count,
                error_rad,
                energy_gap,
                time,
                ..
            } = point;
            let counts = error_rad.map(|error| error / COUNT_RAD);
            let error = error_rad.map_or("diverged".to_owned(), |error| format!("{error:.2e}"));
            writeln!(
                out,
                "  {:<26}{error:>12}{:>12}{:>12}  {:.1} [{:.1} {:.1}]",
                format!("{method}{}", substeps(*count)),
                shown(counts),
                shown(*energy_gap),
                time.least_ns,
                time.lower_quartile_ns,
                time.upper_quartile_ns
            )?;
        }
    }
    writeln!(
        out,
        "\nlaw: largest difference from f64 over a recorded press"
    )?;
    writeln!(
        out,
        "  {:<18}{:<9}{:>12}{:>12}{:>12}{:>9}{:>7}  ns per tick",
        "law", "number", "force, N·m", "energy, J", "floor, N·m", "on board", "worst"
    )?;
    for point in &found.law {
        let time = match (&point.time, &point.refused) {
            (Some(time), _) => format!(
                "{:.2} [{:.2} {:.2}]",
                time.least_ns, time.lower_quartile_ns, time.upper_quartile_ns
            ),
            (None, Some(reason)) => format!("refused: {reason}"),
            (None, None) => "-".to_owned(),
        };
        writeln!(
            out,
            "  {:<18}{:<9}{:>12}{:>12}{:>12}{:>9}{:>7}  {time}",
            point.law,
            point.number,
            shown(point.force_error_n_m),
            shown(point.energy_error_j),
            shown(Some(point.force_floor_n_m)),
            point
                .board_instructions
                .map_or("-".to_owned(), |mean| format!("{mean:.0}")),
            point
                .board_instructions_worst
                .map_or("-".to_owned(), |worst| worst.to_string()),
        )?;
    }
    writeln!(
        out,
        "\nsampling: a hand that presses, probes at 2 Hz and holds"
    )?;
    writeln!(
        out,
        "  {:<14}{:>6}{:>8}{:>8}  {:<12}{:>11}{:>11}{:>8}{:>11}{:>12}{:>12}{:>9}{:>7}",
        "law",
        "k_de",
        "Hz",
        "counts",
        "verdict",
        "stiffness",
        "dynamic",
        "phase",
        "ripple N·m",
        "wall out J",
        "hand out J",
        "K_max",
        "board"
    )?;
    for p in &found.sampling {
        writeln!(
            out,
            "  {:<14}{:>6}{:>8}{:>8}  {:<12}{:>11}{:>11}{:>8}{:>11}{:>12}{:>12}{:>9.4}{:>7}",
            p.law,
            p.k_desired_n_m_per_rad,
            p.rate_hz,
            p.counts_per_rev,
            p.verdict,
            shown(p.stiffness_error),
            shown(p.dynamic_stiffness_error),
            p.dynamic_stiffness_phase_deg
                .map_or("-".to_owned(), |deg| format!("{deg:.1}°")),
            shown(p.ripple_rms_n_m),
            shown(p.energy_out_wall_worst_window_j),
            shown(p.energy_out_worst_window_j),
            p.k_max_n_m_per_rad,
            p.board_load_at_most
                .map_or("-".to_owned(), |load| format!("{:.0} %", 100.0 * load)),
        )?;
    }
    writeln!(out, "\nclosed loop, by its functionals")?;
    writeln!(
        out,
        "  {:<22}{:<31}{:<12}{:>12}{:>12}{:>12}{:>12}{:>10}{:>10}",
        "scene", "method", "verdict", "k_di", "hand out J", "depth rad", "path rad", "K_max", "off"
    )?;
    for p in &found.closed_loop {
        writeln!(
            out,
            "  {:<22}{:<31}{:<12}{:>12}{:>12}{:>12}{:>12}{:>10}{:>10}",
            p.scene,
            format!("{}{}", p.method, substeps(p.substeps)),
            p.verdict,
            p.k_displayed_n_m_per_rad
                .map_or("-".to_owned(), |k| format!("{k:.6}")),
            shown(Some(p.energy_out_worst_window_j)),
            shown(Some(p.penetration_max_rad)),
            shown(Some(p.path_difference_rad)),
            p.k_max_n_m_per_rad
                .map_or("none".to_owned(), |k| format!("{k:.5}")),
            p.k_max_error
                .map_or("-".to_owned(), |off| format!("{off:+.1e}")),
        )?;
    }
    writeln!(
        out,
        "\nto be within one encoder count ({COUNT_RAD:.2e} rad) choose"
    )?;
    for chosen in &found.within_a_count {
        let say = |cheapest: &Option<super::choice::Cheapest>| match cheapest {
            Some(c) => format!(
                "{}{}: {:.1} ns per ms, off by {:.1e} rad",
                c.method,
                substeps(c.substeps),
                c.least_ns,
                c.error_rad
            ),
            None => "nothing that was tried".to_owned(),
        };
        let times = chosen.times_the_exact.map_or(String::new(), |times| {
            format!(" ({times:.1} times the exact step)")
        });
        writeln!(
            out,
            "  {:<14}{}; without the exact step {}{times}",
            chosen.problem,
            say(&chosen.of_all),
            say(&chosen.without_exact)
        )?;
    }
    Ok(())
}
