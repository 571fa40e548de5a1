//! A bar on standard error, where somebody looks at it.

use super::out::quiet;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over so many steps; hidden where nobody wants it.
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
