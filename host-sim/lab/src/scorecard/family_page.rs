//! Formats the results of one set of law settings on device variants as text for a terminal.

use super::family::{DEEP, Family, LOST_DEPTH};
use super::page::touch_cells;
use std::fmt::Write;

/// Text with one table row per wall, the results of the nominal device, and the worst variants.
#[must_use]
pub fn text(families: &[Family]) -> String {
    let mut text = String::from(
        "law                     devices    k_de  members  lost  beyond map  lost or deep  deepest press  deepest touch\n",
    );
    let shown = |value: Option<f64>, factor: f64| {
        value.map_or("lost".to_owned(), |value| format!("{:.3}", factor * value))
    };
    for it in families {
        // Writing into a string cannot fail.
        let _ = writeln!(
            text,
            "{:<24}{:<9}{:>6}{:>9}{:>6}{:>12}{:>14}{:>15}{:>15}",
            it.law,
            it.devices.name(),
            it.k_desired,
            it.members,
            it.lost,
            it.lost_beyond_map,
            it.deep,
            shown(it.deepest_press, 1.0),
            shown(it.deepest_touch, 1.0)
        );
    }
    let _ = writeln!(
        text,
        "lost: held at less than half or more than one and a half of k_de, or deeper than {LOST_DEPTH}; deep: beyond {DEEP}; depths over F/k_de of the press\nbeyond map: T sqrt(k_de/J) beyond what any tuned law was found to hold at that delay\n\nown device, worst of three grips\nlaw                       k_de       Hz  noise °   press   touch  ripple mN·m  at rest mrad  over an ideal wall's: depth  hardness/k_de  extended  first 5 ms"
    );
    for it in families {
        for own in &it.nominal {
            let [depth, hardness, extended, torque] = touch_cells(own.touch.as_ref());
            let _ = writeln!(
                text,
                "{:<24}{:>6}{:>9}{:>9.3}{:>8}{:>8}{:>13}{:>14}{:>29}{:>15}{:>10}{:>12}",
                it.law,
                it.k_desired,
                own.rate_hz,
                own.noise_deg,
                shown(own.peak_penetration_ratio, 1.0),
                shown(own.touch_penetration_ratio, 1.0),
                shown(own.ripple_rms_n_m, 1e3),
                shown(own.motion_at_rest_rad, 1e3),
                depth,
                hardness,
                extended,
                torque
            );
        }
    }
    for it in families {
        if let Some(touch) = &it.touch_over_ideal {
            let [depth, hardness, extended, torque] = touch_cells(Some(touch));
            let _ = writeln!(
                text,
                "{} at {} N·m/rad, worst of {} variants, over an ideal wall's touch: depth {depth}, hardness/k_de {hardness}, extended {extended}, first 5 ms {torque}",
                it.law, it.k_desired, it.members
            );
        }
    }
    let _ = writeln!(
        text,
        "\nworst\nlaw                     devices    k_de   press   touch  T sqrt(k/J)  delay  member"
    );
    for it in families {
        for worst in &it.worst {
            let _ = writeln!(
                text,
                "{:<24}{:<9}{:>6}{:>8}{:>8}{:>13.3}{:>7.2}  {}{}",
                it.law,
                it.devices.name(),
                it.k_desired,
                shown(worst.press, 1.0),
                shown(worst.touch, 1.0),
                worst.stiffness_per_tick,
                worst.delay_ticks,
                worst.member,
                if worst.beyond_map {
                    ", beyond the map"
                } else {
                    ""
                }
            );
        }
    }
    text
}
