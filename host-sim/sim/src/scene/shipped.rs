//! The scenes that are compiled into the program.

use std::path::PathBuf;

/// Name and text of every shipped scene, the main one first.
const SHIPPED: &[(&str, &str)] = &[
    (
        "thesis-knob",
        include_str!("../../../../scenes/thesis-knob.toml"),
    ),
    (
        "press-hold",
        include_str!("../../../../scenes/press-hold.toml"),
    ),
    (
        "press-wiggle-release",
        include_str!("../../../../scenes/press-wiggle-release.toml"),
    ),
    ("tap", include_str!("../../../../scenes/tap.toml")),
    (
        "free-release",
        include_str!("../../../../scenes/free-release.toml"),
    ),
    (
        "low-stiffness",
        include_str!("../../../../scenes/low-stiffness.toml"),
    ),
    (
        "gimbal-knob",
        include_str!("../../../../scenes/gimbal-knob.toml"),
    ),
    (
        "voltage-knob",
        include_str!("../../../../scenes/voltage-knob.toml"),
    ),
    ("identify", include_str!("../../../../scenes/identify.toml")),
];

/// Name and text of every shipped haptic effect of a knob (detents, switches, end stops). Each is a short scene that builds on
/// another.
const FEELS: &[(&str, &str)] = &[
    (
        "smooth",
        include_str!("../../../../scenes/feels/smooth.toml"),
    ),
    (
        "hard-stops",
        include_str!("../../../../scenes/feels/hard-stops.toml"),
    ),
    (
        "coarse-detents",
        include_str!("../../../../scenes/feels/coarse-detents.toml"),
    ),
    (
        "fine-detents",
        include_str!("../../../../scenes/feels/fine-detents.toml"),
    ),
    (
        "bounded-detents",
        include_str!("../../../../scenes/feels/bounded-detents.toml"),
    ),
    (
        "five-positions",
        include_str!("../../../../scenes/feels/five-positions.toml"),
    ),
    (
        "selector",
        include_str!("../../../../scenes/feels/selector.toml"),
    ),
    (
        "on-off",
        include_str!("../../../../scenes/feels/on-off.toml"),
    ),
    (
        "return-to-centre",
        include_str!("../../../../scenes/feels/return-to-centre.toml"),
    ),
    (
        "multi-turn",
        include_str!("../../../../scenes/feels/multi-turn.toml"),
    ),
    (
        "volume",
        include_str!("../../../../scenes/feels/volume.toml"),
    ),
    (
        "magnetic-detents",
        include_str!("../../../../scenes/feels/magnetic-detents.toml"),
    ),
    (
        "ratchet",
        include_str!("../../../../scenes/feels/ratchet.toml"),
    ),
    (
        "guitar-strings",
        include_str!("../../../../scenes/feels/guitar-strings.toml"),
    ),
    (
        "safe-dial",
        include_str!("../../../../scenes/feels/safe-dial.toml"),
    ),
    (
        "heavy-dial",
        include_str!("../../../../scenes/feels/heavy-dial.toml"),
    ),
    (
        "flywheel",
        include_str!("../../../../scenes/feels/flywheel.toml"),
    ),
    (
        "clicker",
        include_str!("../../../../scenes/feels/clicker.toml"),
    ),
    (
        "shuttle",
        include_str!("../../../../scenes/feels/shuttle.toml"),
    ),
    (
        "washboard",
        include_str!("../../../../scenes/feels/washboard.toml"),
    ),
    (
        "multi-turn-smooth",
        include_str!("../../../../scenes/feels/multi-turn-smooth.toml"),
    ),
    (
        "fine-values",
        include_str!("../../../../scenes/feels/fine-values.toml"),
    ),
    (
        "weak-detents",
        include_str!("../../../../scenes/feels/weak-detents.toml"),
    ),
];

/// Names of the shipped scenes.
pub fn names() -> Vec<&'static str> {
    SHIPPED.iter().map(|(name, _)| *name).collect()
}

/// Names of the shipped haptic effects of a knob (feels). Each is also a scene.
pub fn feels() -> Vec<&'static str> {
    FEELS.iter().map(|(name, _)| *name).collect()
}

/// Whether a name is that of a shipped scene or haptic effect.
pub fn is_shipped(name: &str) -> bool {
    text(name).is_some()
}

/// Text of a shipped scene or haptic effect, and the path of its file in the repository.
pub(super) fn text(name: &str) -> Option<(&'static str, PathBuf)> {
    let of = |list: &[(&str, &'static str)]| {
        list.iter()
            .find(|(own, _)| *own == name)
            .map(|(_, text)| *text)
    };
    let kept = |folder: &str| PathBuf::from(format!("{folder}/{name}.toml"));
    let scene = of(SHIPPED).map(|text| (text, kept("scenes")));
    scene.or_else(|| of(FEELS).map(|text| (text, kept("scenes/feels"))))
}
