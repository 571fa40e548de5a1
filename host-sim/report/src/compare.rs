//! Section of the page in which a reader chooses two runs to draw over each other. Traces are embedded as integers; the page's
//! script draws them.

use std::fmt::Write;

use serde_json::json;

use super::ReportInput;
use super::label;
use super::label::Condition;
use super::matrix::Matrix;
use super::picture;
use super::quantity::plain;
use super::svg::escape;
use touchstone_sim::run::record::Trace;

/// Largest number of ticks of a trace that are embedded in the page. A longer trace is divided into stretches, of which only the
/// lowest and highest angle are embedded.
const MOST: usize = 4000;
/// Number of integer steps into which the range of a column is divided.
const STEPS: f64 = 8000.0;

/// Writes the section that compares two runs, with its data; nothing if fewer than two runs have a recorded trace.
pub fn section(page: &mut String, input: &ReportInput, matrices: &[Matrix]) {
    let traced: Vec<(usize, &Trace)> = input
        .runs
        .iter()
        .enumerate()
        .filter_map(|(index, run)| Some((index, run.trace.as_ref()?)))
        .filter(|(_, trace)| !trace.time_s.is_empty())
        .collect();
    if traced.len() < 2 {
        return;
    }
    let first = matrices.first();
    let (a, b) = first
        .and_then(|table| picture::pair(input.runs, table))
        .unwrap_or((traced[0].0, traced[1].0));
    // If all runs share the same conditions, the conditions are left out of their names.
    let conditions: Vec<Condition> = traced
        .iter()
        .map(|(index, _)| Condition::of(&input.runs[*index].summary))
        .collect();
    let shared = conditions.windows(2).all(|pair| pair[0] == pair[1]);
    let options = |chosen: usize| {
        let option = |(index, _): &(usize, &Trace)| {
            let s = &input.runs[*index].summary;
            let condition = if shared {
                String::new()
            } else {
                format!(" · {}", Condition::of(s).text())
            };
            format!(
                "<option value=\"{index}\"{}>{}, k_de {} · {}{}</option>",
                if *index == chosen { " selected" } else { "" },
                label::run_name(s),
                plain(s.k_desired),
                label::verdict(s.verdict),
                escape(&condition)
            )
        };
        traced.iter().map(option).collect::<String>()
    };
    let _ = write!(
        page,
        "<section id=\"compare\">\n<h2>Two runs over each other</h2>\n\
         <p class=\"choice\"><label><svg viewBox=\"0 0 26 8\" aria-hidden=\"true\"><path class=\"a\" d=\"M1 4H25\"/></svg> <select id=\"run-a\">{}</select></label> \
         <label><svg viewBox=\"0 0 26 8\" aria-hidden=\"true\"><path class=\"b\" d=\"M1 4H25\"/></svg> <select id=\"run-b\">{}</select></label></p>\n\
         <noscript><p class=\"note\">Choosing needs the page's script; the picture above shows one pair.</p></noscript>\n\
         <div class=\"plots\" id=\"overlay\"></div>\n<script type=\"application/json\" id=\"traces\">",
        options(a),
        options(b)
    );
    page.push('{');
    for (position, (index, trace)) in traced.iter().enumerate() {
        let comma = if position > 0 { ",\n" } else { "" };
        let k = input.runs[*index].summary.k_desired;
        let _ = write!(page, "{comma}\"{index}\":{}", embedded(trace, k));
    }
    page.push_str("}</script>\n</section>\n");
}

/// Encodes a trace as integers: for each column its lowest value, the size of a step, and the differences from tick to tick in
/// steps.
fn embedded(trace: &Trace, k_desired: f64) -> serde_json::Value {
    let kept = kept(&trace.angle_rad);
    let column = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        let low = if low.is_finite() { low } else { 0.0 };
        let step = ((high - low) / STEPS).max(1e-15);
        let mut last = 0;
        let differences: Vec<i64> = kept
            .iter()
            .map(|&i| {
                let value = ((values[i] - low) / step).round() as i64;
                std::mem::replace(&mut last, value).wrapping_neg() + value
            })
            .collect();
        json!([low, f64::from(step as f32), differences])
    };
    json!({
        "t": column(&trace.time_s),
        "x": column(&trace.angle_rad),
        "f": column(&trace.force_n_m),
        "e": column(&trace.energy_true_j),
        "s": trace.surface_rad[0],
        "k": k_desired,
    })
}

/// Indices of the ticks that are embedded in the page. A long trace is divided into stretches. Of each stretch the ticks with the
/// lowest and the highest value are embedded, and of the trace the first and the last tick.
fn kept(values: &[f64]) -> Vec<usize> {
    if values.len() <= MOST {
        return (0..values.len()).collect();
    }
    let stretch = (2 * values.len()).div_ceil(MOST);
    let mut kept = vec![0];
    for start in (0..values.len()).step_by(stretch) {
        let all = start..values.len().min(start + stretch);
        let by = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        let low = all.clone().min_by(by).unwrap_or(start);
        let high = all.max_by(by).unwrap_or(start);
        kept.extend([low.min(high), low.max(high)]);
    }
    kept.push(values.len() - 1);
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;

    #[test]
    fn what_is_embedded_adds_up_to_the_trace() {
        let run = synthetic::run(LawKind::Spring, 5.0, 1.0);
        let trace = run.trace.as_ref().unwrap();
        let data = embedded(trace, 5.0);
        for (key, values) in [("x", &trace.angle_rad), ("f", &trace.force_n_m)] {
            let (low, step) = (
                data[key][0].as_f64().unwrap(),
                data[key][1].as_f64().unwrap(),
            );
            let mut sum = 0;
            for (difference, value) in data[key][2].as_array().unwrap().iter().zip(values) {
                sum += difference.as_i64().unwrap();
                // Half a step, plus the rounding of the step over all steps.
                let off = (low + step * sum as f64 - value).abs();
                assert!(off <= step * (0.5 + 1e-7 * STEPS), "{key}: {off} {step}");
            }
        }
    }

    #[test]
    fn a_long_trace_keeps_its_extremes() {
        let mut values = vec![0.0; 100_000];
        values[54_321] = 1.0;
        values[54_322] = -1.0;
        let kept = kept(&values);
        assert!(kept.len() <= MOST + 2, "{}", kept.len());
        assert!(kept.contains(&54_321) && kept.contains(&54_322));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(*kept.last().unwrap(), 99_999);
    }
}
