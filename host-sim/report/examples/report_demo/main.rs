//! Writes reports of made-up runs, so that the layout of the pages can be checked without a simulation: a matrix of 20 runs, and a
//! single run.
//!
//! `cargo run --release -p touchstone-report --example report_demo -- FOLDER`

use std::path::PathBuf;
use std::time::Instant;

use touchstone_control::LawKind;
use touchstone_report::{self as report, Block, Colour, ReportInput, Section};
use touchstone_sim::run;

mod synthetic;

fn main() -> touchstone_sim::error::Result<()> {
    let folder = PathBuf::from(
        std::env::args()
            .nth(1)
            .unwrap_or_else(|| "touchstone-report/demo".to_owned()),
    );
    let laws = [
        LawKind::Spring,
        LawKind::Tdpa,
        LawKind::Fba,
        LawKind::Sfa,
        LawKind::EnhancedSfa,
    ];
    let runs: Vec<run::record::Run> = [0.5, 1.0, 2.5, 5.0]
        .iter()
        .flat_map(|&k| laws.map(|law| synthetic::run(law, k, 3.2)))
        .collect();
    let sections = [Section {
        title: "Claims".to_owned(),
        folded: true,
        body: vec![
            Block::Text("A caller's own section; the numbers are made up.".to_owned()),
            Block::Table {
                caption: "Claims of the figures, and what became of them.".to_owned(),
                header: ["Figure", "Claim", "Found"].map(str::to_owned).into(),
                rows: vec![
                    ["5.4", "A spring at 2.5 N·m/rad is active", "reproduced"]
                        .map(str::to_owned)
                        .into(),
                ],
            },
        ],
    }];
    let row_notes = [(
        5.0,
        "Figs. 5.5 to 5.7 of the thesis. This text is the caller's.".to_owned(),
    )];
    let notes =
        ["Synthetic runs: nothing on this page was simulated with the real laws.".to_owned()];
    let matrix = ReportInput {
        title: "Five control laws on a made-up knob",
        intro: "A press into a virtual wall with each law, at stiffnesses below, at and above the critical one.",
        command: "cargo run --release -p touchstone-report --example report_demo",
        k_critical: Some(1.0),
        runs: &runs,
        notes: &notes,
        row_notes: &row_notes,
        sections: &sections,
        ..Default::default()
    };
    let single = ReportInput {
        title: "One run",
        runs: &runs[19..],
        sections: &[],
        ..matrix
    };
    for (name, input) in [("matrix", matrix), ("single", single)] {
        print!("{}", report::table::render(input.runs, Colour::detect()));
        let start = Instant::now();
        let page = report::html::render(&input, &report::origin::Origin::default());
        let drawn = start.elapsed();
        let written = report::write(&input, &folder.join(name))?;
        println!(
            "\n{}: page {:.2} MB in {:.0} ms; all {:.1} MB in {:.0} ms\n",
            written.page.display(),
            page.len() as f64 / 1e6,
            drawn.as_secs_f64() * 1e3,
            written.bytes as f64 / 1e6,
            (start.elapsed() - drawn).as_secs_f64() * 1e3
        );
    }
    Ok(())
}
