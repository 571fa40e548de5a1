//! Checks whether the settings of a control law keep the bounds within which the law is passive without an energy guard.

use super::warnings;
use crate::error::{Error, Result};
use crate::scene::Scene;
use touchstone_control::{LawKind, StatesKind};

/// Returns the first passivity bound of the control law that the scene violates, as an error at the field concerned. `None`: the
/// scene keeps all bounds.
///
/// A spring of stiffness `k` under a zero-order hold is passive if the device damping that the law assumes is at least `k (T/2 +
/// t_d)`. With virtual damping `B`, the device damping must exceed `k (T/2 + t_d) + B` (Colgate and Schenkel). `T` is the control
/// period, `t_d` the computational delay. Enhanced successive force augmentation counts as such a spring if its settings need no
/// augmentation. The bounds of the other laws are those of [`warnings`]. A law on estimated states is an error, too, because no
/// bound is known for it.
///
/// # Errors
/// A setting that the control crate cannot represent.
pub fn refusal(scene: &Scene) -> Result<Option<Error>> {
    if let Some((_, error)) = warnings(scene)?.into_iter().next() {
        return Ok(Some(error));
    }
    if scene.law.states == StatesKind::Estimated {
        return Ok(Some(scene.error(
            "law.states",
            "a law on estimated states has no passivity bound of its own",
            "set measured states, as --preset thesis does",
        )));
    }
    let plain = match scene.law.kind {
        LawKind::Spring | LawKind::SpringDamper => true,
        LawKind::EnhancedSfa => scene.settings()?.is_plain_spring(),
        LawKind::Tdpa | LawKind::Fba | LawKind::Sfa | LawKind::SfaContinuous => false,
    };
    Ok(plain.then(|| spring(scene)).flatten())
}

fn spring(scene: &Scene) -> Option<Error> {
    // Without augmentation (`k_de` up to the soft stiffness `k_v`), the enhanced law is a damped spring.
    let set = scene.law.virtual_damping_n_m_s_per_rad;
    let own = match scene.law.kind {
        LawKind::SpringDamper => set,
        LawKind::EnhancedSfa => {
            set * scene.wall.k_desired_n_m_per_rad / scene.law.k_soft_n_m_per_rad
        }
        _ => 0.0,
    };
    let damped = scene.law.kind == LawKind::SpringDamper || own > 0.0;
    let late_s = 0.5 * scene.timing.period_s() + scene.timing.computational_delay_s;
    let (stiffness, counted) = (
        scene.wall.k_desired_n_m_per_rad,
        scene.law.device_damping_n_m_s_per_rad,
    );
    // Largest stiffness for the damping left to the spring. The tolerance of a millionth allows for bounds rounded to decimals.
    let most = (counted - own) / late_s;
    let keeps = if damped {
        stiffness < most
    } else {
        stiffness <= most * (1.0 + 1e-6)
    };
    if keeps {
        return None;
    }
    let bound = match (damped, scene.timing.computational_delay_s > 0.0) {
        (false, false) => "2 c_i/T",
        (false, true) => "c_i/(T/2 + t_d)",
        (true, false) => "2 (c_i - B)/T",
        (true, true) => "(c_i - B)/(T/2 + t_d)",
    };
    let fix = if most > 0.0 {
        let word = if damped { "below" } else { "at most" };
        format!("give {word} {most:.4}")
    } else {
        format!("give law.virtual_damping_n_m_s_per_rad below {counted:e}")
    };
    Some(scene.error(
        "wall.k_desired_n_m_per_rad",
        format!(
            "k_de = {stiffness} is above {bound} = {:.4}: the spring gives away more energy than the damping takes",
            most.max(0.0)
        ),
        fix,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[track_caller]
    fn refused(sets: &[&str]) -> bool {
        let scene = Scene::load("tap")
            .and_then(|scene| scene.with_preset(Preset::Thesis))
            .and_then(|scene| scene.with_overrides(sets))
            .unwrap();
        refusal(&scene).unwrap().is_some()
    }

    #[test]
    fn a_spring_keeps_two_c_over_t_and_its_delay() {
        let spring = |k: &str, delay: &str| {
            let (k, delay) = (
                format!("wall.k_desired_n_m_per_rad={k}"),
                format!("timing.computational_delay_s={delay}"),
            );
            refused(&["law.kind=spring", &k, &delay])
        };
        // With c_i = 5e-4 at 1 kHz the bound is 1 N·m/rad; with a tick of delay it is a third of that.
        assert!(!spring("1", "0") && spring("1.001", "0"));
        assert!(!spring("0.333", "1e-3") && spring("0.334", "1e-3"));
    }

    #[test]
    fn virtual_damping_eats_the_margin() {
        let damped = |k: &str, damping: &str| {
            let (k, damping) = (
                format!("wall.k_desired_n_m_per_rad={k}"),
                format!("law.virtual_damping_n_m_s_per_rad={damping}"),
            );
            refused(&["law.kind=spring-damper", &k, &damping])
        };
        // The stiffness must be strictly below 2 (5e-4 - 2e-4)/T = 0.6 N·m/rad.
        assert!(!damped("0.59", "2e-4") && damped("0.601", "2e-4"));
        assert!(damped("0.1", "5e-4"));
    }

    #[test]
    fn an_enhanced_law_needs_no_credit_where_it_is_a_spring() {
        assert!(refused(&["law.kind=enhanced-sfa"]));
        assert!(!refused(&[
            "law.kind=enhanced-sfa",
            "law.energy_credit_j=0"
        ]));
        let soft = ["law.kind=enhanced-sfa", "wall.k_desired_n_m_per_rad=0.5"];
        assert!(!refused(&soft));
        let late = "timing.computational_delay_s=2e-3";
        assert!(refused(&[soft[0], soft[1], late]));
    }

    #[test]
    fn estimated_states_have_no_bound() {
        let soft = ["law.kind=spring", "wall.k_desired_n_m_per_rad=0.5"];
        assert!(!refused(&soft));
        assert!(refused(&[soft[0], soft[1], "law.states=estimated"]));
    }

    #[test]
    fn the_observer_of_the_thesis_is_refused() {
        assert!(refused(&["law.kind=tdpa", "law.observer=thesis"]));
        assert!(!refused(&["law.kind=tdpa"]));
    }
}
