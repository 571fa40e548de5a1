use super::*;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use touchstone_sim::run::{Recorder, Tick, watch};

#[derive(Default)]
struct Ticks(Vec<Tick>);

impl Recorder for Ticks {
    fn record(&mut self, tick: &Tick) {
        self.0.push(*tick);
    }
}

fn gimbal() -> Scene {
    Scene::load("gimbal-knob").unwrap()
}

/// Makes a recording without a board: simulates the scene `board` with the hand's actions for `scene`, in the format of a test
/// stand.
fn recorded(scene: &Scene, board: &Scene, deeds: &[Deed], name: &str) -> BoardRecording {
    let programme = board_programme(scene);
    let mut text = String::from(
        "grip,deed,penetration_rad,force_n_m,state,angle_rad,velocity_rad_per_s,motor_force_n_m,absorbed_j,device_loss_j,surface_rad\n",
    );
    for deed in deeds {
        let of_deed = programme.scene(board, Grip::Medium, *deed);
        let ticks = watch(&of_deed, Ticks::default()).unwrap().0;
        let mut row = |told: f64, tick: &Tick, angle: f64, speed: f64| {
            writeln!(
                text,
                "medium,{},{told},{},armed,{angle},{speed},{},{},{},{}",
                deed_word(*deed),
                tick.force_n_m,
                tick.motor_force_n_m,
                tick.absorbed_j,
                tick.device_loss_j,
                board.wall.surface_rad
            )
            .unwrap();
        };
        for tick in &ticks {
            row(tick.told_rad, tick, tick.angle_rad, tick.velocity_rad_per_s);
        }
        let last = ticks.last().unwrap();
        let (angle, speed) = (last.angle_after_rad, last.velocity_after_rad_per_s);
        row(last.told_rad, last, angle, speed);
    }
    let file = file(name);
    std::fs::write(&file, text).unwrap();
    let read = BoardRecording::read(&file);
    std::fs::remove_file(&file).unwrap();
    read.unwrap()
}

fn file(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("touchstone-{name}-{}.csv", std::process::id()))
}

fn figure(card: &BoardCard, key: &str) -> FigureBeside {
    *card.figures.iter().find(|it| it.key == key).unwrap()
}

#[test]
fn a_board_that_is_the_scene_has_its_figures_to_the_bit() {
    let scene = gimbal();
    let deeds = [Deed::Press, Deed::Move(2.0)];
    let card = board_card(&scene, &[recorded(&scene, &scene, &deeds, "same")]).unwrap();
    assert_eq!(
        (card.grips.as_slice(), card.figures.len()),
        (&["medium"][..], 18)
    );
    for it in card.figures.iter().chain(&card.moved) {
        assert_eq!(it.desktop, it.board, "{}", it.key);
        assert!(it.is_in_scatter() && it.holds(0.0), "{}", it.key);
    }
    assert!(figure(&card, "ripple_rms_n_m").board.unwrap() > 1e-4);
    assert_eq!((card.moved.len(), card.apart(0.0).count()), (2, 0));
}

#[test]
fn a_board_with_a_softer_wall_a_late_one_and_one_with_other_friction_are_apart() {
    let scene = gimbal();
    let apart = |change: &dyn Fn(&mut Scene), deed: Deed, name: &str| -> Vec<&'static str> {
        let mut board = scene.clone();
        change(&mut board);
        let card = board_card(&scene, &[recorded(&scene, &board, &[deed], name)]).unwrap();
        card.beyond(SAME).map(|it| it.key).collect()
    };
    let soft = |scene: &mut Scene| scene.wall.k_desired_n_m_per_rad *= 0.8;
    let found = apart(&soft, Deed::Move(1.0), "soft");
    assert!(found.contains(&"modulus_n_m_per_rad"), "{found:?}");
    let late = |scene: &mut Scene| scene.timing.computational_delay_s = 9e-4;
    let found = apart(&late, Deed::Move(4.0), "late");
    assert!(found.contains(&"phase_deg"), "{found:?}");
    let rough = |scene: &mut Scene| {
        if let Some(friction) = &mut scene.device.friction {
            friction.kinetic_n_m *= 6.0;
        }
    };
    let found = apart(&rough, Deed::Press, "rough");
    assert!(found.contains(&"release_speed_rad_per_s"), "{found:?}");
}

#[test]
fn a_board_at_several_places_has_a_scatter_and_is_beyond_only_where_the_two_do_not_meet() {
    let scene = gimbal();
    let step = scene.encoder.as_ref().unwrap().step_rad();
    let deeds = [Deed::Move(4.0)];
    let at_places = |change: &dyn Fn(&mut Scene), name: &str| {
        let of_place = |share: f64| {
            let mut board = scene.clone();
            change(&mut board);
            board.wall.surface_rad += share * step;
            recorded(&scene, &board, &deeds, name)
        };
        [0.0625, 0.3125, 0.5625, 0.8125].map(of_place)
    };
    let same = board_card(&scene, &at_places(&|_| (), "places")).unwrap();
    assert_eq!(same.places, 4);
    assert_eq!(
        same.beyond(0.0).map(|it| it.key).collect::<Vec<_>>(),
        [""; 0]
    );
    let phase = same.moved.iter().find(|it| it.key == "phase_deg").unwrap();
    let (low, high) = phase.board_scatter.unwrap();
    assert!(low < high, "{low} {high}");
    let late = |scene: &mut Scene| scene.timing.computational_delay_s = 4e-4;
    let found = board_card(&scene, &at_places(&late, "late-places")).unwrap();
    assert!(found.beyond(SAME).any(|it| it.key == "phase_deg"));
    // Recordings with different actions are refused.
    let mut unequal = at_places(&|_| (), "unequal");
    unequal[2] = recorded(&scene, &scene, &[Deed::Move(2.0)], "other-deed");
    let said = board_card(&scene, &unequal).unwrap_err().to_string();
    assert!(said.contains("not in all recordings"), "{said}");
}

#[test]
fn what_is_no_recording_of_the_scene_is_refused() {
    let scene = gimbal();
    let deeds = [Deed::Press];
    let recording = recorded(&scene, &scene, &deeds, "other");
    let said = |scene: &Scene| {
        board_card(scene, std::slice::from_ref(&recording))
            .unwrap_err()
            .to_string()
    };
    let longer = scene.with(|scene| {
        if let touchstone_sim::scene::MotionSpec::TouchAndPress(press) = &mut scene.operator.motion
        {
            press.hold_s += 0.5;
        }
    });
    assert!(said(&longer.unwrap()).contains("ticks instead of"));
    let further = scene.with(|scene| scene.wall.surface_rad += 0.01);
    assert!(said(&further.unwrap()).contains("wall is not where"));
    let file = file("off");
    let header = "grip,deed,penetration_rad,force_n_m,state,angle_rad,velocity_rad_per_s,motor_force_n_m,absorbed_j,device_loss_j";
    let read = |row: &str| {
        std::fs::write(&file, format!("{header}\n{row}\n")).unwrap();
        BoardRecording::read(&file)
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    assert!(read("medium,press,0,0,ready,0,0,0,0,0").contains("the wall was ready"));
    assert!(read("medium,press,0,nan,armed,0,0,0,0,0").contains("line 2, force_n_m"));
    std::fs::remove_file(&file).unwrap();
    assert!(BoardRecording::read(Path::new("missing.csv")).is_err());
}

#[test]
fn a_programme_has_a_row_a_tick_of_every_deed_that_is_named() {
    let scene = gimbal();
    let text = programme_csv(&scene, &[Grip::Firm], &["press".into(), "move-0.25".into()]).unwrap();
    let programme = board_programme(&scene);
    let ticks = |deed| programme.scene(&scene, Grip::Firm, deed).timing.ticks() as usize;
    assert_eq!(
        text.lines().count(),
        1 + ticks(Deed::Press) + ticks(Deed::Move(0.25))
    );
    assert!(
        text.lines()
            .nth(1)
            .unwrap()
            .starts_with("firm,press,0.0,0.5,0.45")
    );
    assert_eq!(deed_words().len(), 8);
}
