//! The scenes that come with the program.

/// Name and text of every shipped scene, the main one first.
pub(crate) const SHIPPED: &[(&str, &str)] = &[
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

/// Names of the shipped scenes.
pub fn names() -> Vec<&'static str> {
    SHIPPED.iter().map(|(name, _)| *name).collect()
}
