//! Tests that runs of one scene's variants read a recording once, and that a changed file is read again.
//!
//! The test is a separate program, because a process keeps only the recording that it read last.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};
use touchstone_sim::run;
use touchstone_sim::scene::{Recording, Scene};

/// Writes a recording of a hand that jumps between 0 and `amplitude_rad`, and sets the file's time a minute back.
fn write(file: &Path, amplitude_rad: &str) {
    let mut text = String::from("time_s,angle_rad\n");
    for sample in 0..100 {
        let angle = ["0.0", amplitude_rad][sample % 2];
        text += &format!("{},{angle}\n", 0.01 * f64::from(sample as u32));
    }
    std::fs::write(file, text).unwrap();
    let old = SystemTime::now() - Duration::from_secs(60);
    File::options()
        .write(true)
        .open(file)
        .unwrap()
        .set_modified(old)
        .unwrap();
}

#[test]
fn variants_of_a_scene_read_a_recording_once() {
    let folder = std::env::temp_dir().join(format!("touchstone-once-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("hand.csv");
    write(&file, "0.1");
    let scene = Scene::load("low-stiffness").unwrap();
    let scene = scene.with_recording(&file).unwrap();
    let first = Recording::read(&file).unwrap();
    for damping in [1e-4, 2e-4, 3e-4] {
        let varied = scene.with(|scene| scene.device.damping_n_m_s_per_rad = damping);
        run::run(&varied.unwrap(), false).unwrap();
    }
    let then = Recording::read(&file).unwrap();
    assert!(Arc::ptr_eq(&first, &then), "was read again");

    write(&file, "0.2");
    let changed = Recording::read(&file).unwrap();
    assert_eq!(changed.angles_rad()[1], 0.2);
    // A file that has just changed is always read again, because a second change could leave the file's time the same.
    std::fs::write(&file, "time_s,angle_rad\n0,0\n1,1\n").unwrap();
    assert_eq!(Recording::read(&file).unwrap().angles_rad()[1], 1.0);
    std::fs::write(&file, "time_s,angle_rad\n0,0\n1,2\n").unwrap();
    assert_eq!(Recording::read(&file).unwrap().angles_rad()[1], 2.0);
    // A deleted file is an error: the kept recording is not used.
    std::fs::remove_file(&file).unwrap();
    assert!(Recording::read(&file).is_err());
    std::fs::remove_dir_all(folder).unwrap();
}
