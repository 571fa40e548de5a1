//! Computing cost of a simulated tick (control period): counted instructions, and measured time.

use std::collections::BTreeMap;

use touchstone_control::{Choice as _, LawKind};
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::effects::Effect;
use touchstone_sim::scene::Scene;

use crate::accuracy::clock::{Spread, Work, race};

/// Table of instruction counts, written by `cargo xtask bench --ladder --write`.
const COUNTED: &str = include_str!("ladder.txt");
/// Number of times that each simulated run is timed.
pub(super) const REPEATS: u32 = 15;

/// Counted instructions per tick (control period) of each configuration: the bare loop, and the loop with one law, effect or pair
/// of effects.
pub struct Ladder {
    counted: BTreeMap<&'static str, f64>,
}

impl Ladder {
    /// Reads the instruction counts that were stored last.
    pub fn known() -> Self {
        let counted = COUNTED
            .lines()
            .filter_map(|line| line.rsplit_once(' '))
            .filter_map(|(name, count)| Some((name, count.parse().ok()?)))
            .collect();
        Self { counted }
    }

    fn beyond_bare(&self, name: &str) -> Option<f64> {
        Some(self.counted.get(name)? - self.counted.get("bare")?)
    }

    /// Instructions per tick that an effect adds to the bare loop when no other effect is on.
    pub fn alone(&self, name: &str) -> Option<f64> {
        self.beyond_bare(&format!("with:{name}"))
    }

    fn together(&self, a: &str, b: &str) -> Option<f64> {
        self.beyond_bare(&format!("with:{a}+{b}"))
            .or_else(|| self.beyond_bare(&format!("with:{b}+{a}")))
    }

    /// Predicted instructions per tick (control period): bare loop, law and each effect alone, plus what each pair of effects
    /// adds beyond the sum of the two. `None` if a count is missing.
    pub fn predicted(&self, scene: &Scene, names: &[&str]) -> Option<f64> {
        let mut sum = *self.counted.get("bare")?;
        if scene.law.kind != LawKind::Spring {
            sum += self.beyond_bare(&format!("law:{}", scene.law.kind.word()))?;
        }
        if scene.law.states.word() == "estimated" {
            sum += self.beyond_bare("set:law.states=estimated")?;
        }
        if scene.law.guard.on {
            sum += self.beyond_bare("set:law.guard.on=true")?;
        }
        for (at, name) in names.iter().enumerate() {
            let alone = self.alone(name)?;
            sum += alone;
            for other in &names[at + 1..] {
                // A pair of effects that exclude each other adds nothing.
                if let Some(both) = self.together(name, other) {
                    sum += both - alone - self.alone(other)?;
                }
            }
        }
        Some(sum)
    }
}

/// Measures the computing time of a tick, and for each effect in `named` the time that a tick without it saves, ns. `None` for an
/// effect without which the scene cannot run.
///
/// # Errors
/// The scene cannot be run.
pub fn times(
    scene: &Scene,
    named: &[&Effect],
    step: &mut dyn FnMut(),
) -> Result<(Spread, Vec<Option<f64>>)> {
    run::simulate(scene, None)?;
    let without: Vec<Option<Scene>> = named
        .iter()
        .map(|effect| scene.with(effect.remove).ok())
        .map(|scene| scene.filter(|scene| run::simulate(scene, None).is_ok()))
        .collect();
    let ticks = scene.timing.ticks() as f64;
    let scenes: Vec<&Scene> = std::iter::once(scene)
        .chain(without.iter().flatten())
        .collect();
    let mut work: Vec<Work<'_>> = scenes
        .iter()
        .map(|scene| -> Work<'_> {
            // Each scene has been run once before, so it is not refused.
            Box::new(move || f64::from(u8::from(run::simulate(scene, None).is_ok())))
        })
        .collect();
    let mut spreads = race(&mut work, ticks, REPEATS, step).into_iter();
    let whole = spreads.next().unwrap_or(Spread {
        least_ns: f64::NAN,
        lower_quartile_ns: f64::NAN,
        median_ns: f64::NAN,
        upper_quartile_ns: f64::NAN,
    });
    let saved = without
        .iter()
        .map(|scene| {
            scene.as_ref()?;
            Some(whole.least_ns - spreads.next()?.least_ns)
        })
        .collect();
    Ok((whole, saved))
}
