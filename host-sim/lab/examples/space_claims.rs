//! The claims of §5.2 on the terminal.
use touchstone_lab::thesis::space;

fn main() {
    let runs = space::run_all(&space::cells(), || {}).expect("settings");
    for run in &runs {
        let hold = run.late(space::Phase::Hold, 0.25);
        let slide = run.late(space::Phase::Slide, 0.9);
        println!(
            "{:?} {:.2} N/mm at rest, ripple {:.4} mm, F {:.2} N; sliding {:.2} N/mm, tangential {:.3}, jump {:.3}",
            run.cell,
            run.displayed_n_per_mm(hold.clone()),
            run.ripple_mm(hold.clone()),
            run.normal_force_n(hold.end - 1),
            run.displayed_n_per_mm(slide.clone()),
            run.most_tangential(slide.clone()),
            run.largest_jump(slide)
        );
    }
    for claim in space::claims::check(&runs).expect("settings") {
        println!(
            "{:15} {:24} {}",
            claim.outcome.name(),
            claim.name,
            claim.measured
        );
    }
}
