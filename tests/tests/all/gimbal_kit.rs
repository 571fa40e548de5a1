//! Tests that the default settings of the board with the small gimbal motor are the wall of the shipped scene file `gimbal-knob`.

use touchstone_control::ChangeOfForce;
use touchstone_drive::wire::checked;
use touchstone_protocol::{Board, DeviceSettings};
use touchstone_sim::scene::Scene;

const BOARD: Board = Board::NucleoG474reIhm16m1;

#[test]
fn the_board_starts_with_the_scenes_wall() {
    let settings = DeviceSettings::defaults(BOARD);
    assert_eq!(checked(&settings, BOARD), Ok(()));
    let scene = Scene::load("gimbal-knob").unwrap();
    // A board reads its encoder when the force changes, and calculates its own delay.
    let mut law = settings.law();
    assert_eq!(law.guard.change, ChangeOfForce::Measured);
    law.guard.change = ChangeOfForce::Estimated;
    assert_eq!(law, scene.settings().unwrap());
}

#[test]
fn the_motor_gives_what_the_wall_asks_for() {
    let motor = DeviceSettings::defaults(BOARD).motor;
    let most = motor.torque_constant_n_m_per_a * motor.current_limit_a;
    let scene = Scene::load("gimbal-knob").unwrap();
    assert!(scene.device.torque_limit_n_m.unwrap() <= most.to_num::<f64>());
}
