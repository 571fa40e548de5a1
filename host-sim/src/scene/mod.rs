//! Scenes: what to simulate, in TOML, every field with its unit in its name.
