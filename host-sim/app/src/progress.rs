//! Progress bar on standard error, shown only if standard error is a terminal.

use super::out::quiet;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Creates a progress bar with this many steps; `--quiet` and `--json` hide it.
pub fn bar(steps: u64, message: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(steps).with_style(style());
    if quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar.set_message(message);
    bar
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} [{wide_bar}] {pos}/{len} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}
