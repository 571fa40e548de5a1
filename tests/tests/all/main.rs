//! All tests across the crates, in one program, which is compiled and linked once. A file has the tests of one claim;
//! `cargo test -p touchstone-tests NAME::` runs those of the file `NAME.rs`.

mod change_is_read;
mod critical_stiffness;
mod current_loop;
mod device_settings_are_validated;
mod drive_random;
mod effects_cost_nothing;
mod encoder_eccentricity_is_measured;
mod energy;
mod energy_guard;
mod environment;
mod environment_changes;
mod environment_guard;
mod estimator;
mod estimator_promises;
mod every_law_is_everywhere;
mod every_law_keeps_its_bounds;
mod exact_observer_is_exact_to_the_bit;
mod feel_adversary;
mod feel_inertia;
mod feel_parts;
mod feels;
mod frames_survive_noise;
mod gimbal_kit;
mod guard_after_setup;
mod guard_in_the_loop;
mod integrators_in_scenes;
mod knob_broken_parts;
mod knob_calibrates;
mod knob_faults;
mod knob_is_measured;
mod knob_keeps_its_alignment;
mod knob_plays_its_cogging;
mod knob_plays_the_wall;
mod knob_settings;
mod knob_starts;
mod knob_starts_by_itself;
mod laws_follow_the_thesis;
mod made_bytes;
mod no_false_alarm;
mod no_law_breaks_at_the_ends_of_its_format;
mod number_formats;
mod number_formats_agree;
mod observed_energy_keeps_its_promise;
mod offset_after_the_loan;
mod overpowered_wall;
mod profile;
mod pulse_at_the_touch;
mod pulse_on_an_empty_account;
mod recording_beside_simulation;
mod runs_keep_their_bits;
mod settings_are_validated;
mod settings_warn_of_passivity_bounds;
mod shipped_scenes;
mod shipped_wall;
mod single_faults;
mod space_estimated;
mod space_fixed_plane_is_one_axis;
mod space_friction;
mod space_guard;
mod space_leaving;
mod space_page_is_the_comparison;
mod space_proxy_cases;
mod space_surface_points;
mod space_touch_and_texture;
mod space_vectors;
mod stored_settings_survive_power_cuts;
mod thesis_matrix;
mod thesis_observer_has_the_wrong_sign;
mod torque_resolution;
mod twin_follows_the_knob;
mod velocity;
mod vibration_at_the_touch;
mod voltage_mode;
mod what_a_hand_feels;

/// A file that no line above names would be neither compiled nor run.
#[test]
fn every_file_of_this_folder_is_part_of_the_program() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/all");
    let (mut modules, program) = (0, include_str!("main.rs"));
    for entry in std::fs::read_dir(folder).expect("the tests") {
        let name = entry.expect("a file").file_name();
        let name = name.to_string_lossy();
        let name = name.strip_suffix(".rs").expect("a Rust file");
        if name != "main" {
            modules += 1;
            let line = format!("mod {name};");
            assert!(
                program.lines().any(|it| it == line),
                "main.rs lacks `{line}`"
            );
        }
    }
    assert_eq!(modules, program.matches("\nmod ").count());
}
