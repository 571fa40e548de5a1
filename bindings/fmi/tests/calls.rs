//! Tests of FMI's functions as an importing program calls them: the bits of the run, wrong calls, random calls.

use core::ffi::{CStr, c_char, c_void};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use touchstone_fmi::calls::*;
use touchstone_fmi::fmi3Status::{self, Error, Ok as Done};
use touchstone_fmi::unsupported::*;
use touchstone_fmu::Half;
use touchstone_fmu::description::token;
use touchstone_fmu::variables::Name;
use touchstone_sim::run::{Recorder, Tick, watch};
use touchstone_sim::scene::Scene;

/// Messages of an instance.
type Said = Vec<(fmi3Status, String)>;

extern "C" fn log(said: *mut c_void, status: fmi3Status, _: *const c_char, text: *const c_char) {
    // SAFETY: the tests hand over a `Said`, and the library a text.
    #[allow(unsafe_code)]
    unsafe {
        let text = CStr::from_ptr(text).to_string_lossy().into_owned();
        (*said.cast::<Said>()).push((status, text));
    }
}

fn resources(name: &str, scene: &Scene, half: Half) -> (PathBuf, String) {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("calls-{name}-{}", half.word()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let text = scene.to_toml();
    std::fs::write(folder.join(half.scene_file()), &text).expect("a file");
    (folder, token(&text, half))
}

fn made(folder: &Path, token: &str, said: &mut Said) -> *mut c_void {
    let token = CString::new(token).expect("a text");
    let folder = CString::new(folder.to_str().expect("UTF-8")).expect("a text");
    let said: *mut Said = said;
    fmi3InstantiateCoSimulation(
        c"one".as_ptr(),
        token.as_ptr(),
        folder.as_ptr(),
        false,
        false,
        false,
        false,
        null(),
        0,
        said.cast(),
        Some(log),
        null(),
    )
}

fn get(instance: *mut c_void, name: Name) -> f64 {
    let (reference, mut value) = (name as u32, f64::NAN);
    assert_eq!(
        fmi3GetFloat64(instance, &raw const reference, 1, &raw mut value, 1),
        Done
    );
    value
}

fn set(instance: *mut c_void, name: Name, value: f64) {
    let reference = name as u32;
    assert_eq!(
        fmi3SetFloat64(instance, &raw const reference, 1, &raw const value, 1),
        Done
    );
}

fn step(instance: *mut c_void, begins_s: f64, step_s: f64) -> fmi3Status {
    let (mut no, mut last_s) = ([true; 3], f64::NAN);
    let [event, terminate, early] = &mut no;
    let status = fmi3DoStep(
        instance,
        begins_s,
        step_s,
        true,
        event,
        terminate,
        early,
        &raw mut last_s,
    );
    assert_eq!(no, [false; 3]);
    assert!(last_s.is_finite());
    status
}

struct All(Vec<Tick>);

impl Recorder for All {
    fn record(&mut self, tick: &Tick) {
        self.0.push(*tick);
    }
}

#[test]
fn the_calls_give_the_bits_of_the_run() {
    let scene = Scene::load("thesis-knob").expect("a scene");
    let mut said = Said::new();
    let [law, plant] = Half::ALL.map(|half| {
        let (folder, token) = resources("run", &scene, half);
        let instance = made(&folder, &token, &mut said);
        assert!(!instance.is_null());
        assert_eq!(
            fmi3EnterInitializationMode(instance, false, 0.0, 5.0, false, 0.0),
            Done
        );
        assert_eq!(fmi3ExitInitializationMode(instance), Done);
        instance
    });
    let period_s = scene.timing.period_s();
    for tick in &watch(&scene, All(Vec::new())).expect("a run").0 {
        let angle_rad = get(plant, Name::Angle);
        assert_eq!(
            angle_rad.to_bits(),
            tick.angle_rad.to_bits(),
            "{}",
            tick.index
        );
        set(law, Name::MeasuredAngle, angle_rad);
        assert_eq!(step(law, 5.0 + tick.time_s, period_s), Done);
        let torque_n_m = get(law, Name::Torque);
        assert_eq!(torque_n_m, -tick.force_n_m, "{}", tick.index);
        set(plant, Name::Command, torque_n_m);
        assert_eq!(step(plant, 5.0 + tick.time_s, period_s), Done);
    }
    for instance in [law, plant] {
        assert_eq!(fmi3Terminate(instance), Done);
        fmi3FreeInstance(instance);
    }
    assert!(said.is_empty(), "{said:?}");
}

/// Checks that every refusal is an error status with one message that has place, problem and remedy.
#[test]
fn wrong_calls_are_errors_with_a_message() {
    let scene = Scene::load("tap").expect("a scene");
    let (folder, token) = resources("wrong", &scene, Half::Law);
    let mut said = Said::new();
    let is_told = |said: &mut Said| {
        let told: Vec<_> = std::mem::take(said);
        let [(status, text)] = &told[..] else {
            panic!("{told:?}");
        };
        assert!(
            text.contains(": ") && text.contains("; ") && !text.contains('\n'),
            "{text}"
        );
        *status
    };
    assert!(made(&folder, "other", &mut said).is_null());
    assert_eq!(is_told(&mut said), Error);
    assert!(made(&folder.join("none"), &token, &mut said).is_null());
    assert_eq!(is_told(&mut said), Error);
    let law = made(&folder, &token, &mut said);
    assert!(!law.is_null() && said.is_empty());
    let period_s = scene.timing.period_s();
    assert_eq!(step(law, 0.0, period_s), Error, "not initialised");
    assert_eq!(is_told(&mut said), Error);
    assert_eq!(fmi3ExitInitializationMode(law), Done);
    let (angle, torque, mut value) = (Name::MeasuredAngle as u32, Name::Torque as u32, 0.0);
    for wrong in [
        step(law, 1.0, period_s),
        step(law, 0.0, 0.3 * period_s),
        fmi3EnterInitializationMode(law, false, 0.0, 0.0, false, 0.0),
        fmi3SetFloat64(law, null(), 1, &raw const value, 1),
        fmi3SetFloat64(law, &raw const angle, 1, null(), 1),
        fmi3SetFloat64(law, &raw const angle, 1, &raw const value, 0),
        fmi3SetFloat64(law, &raw const torque, 1, &raw const value, 1),
        fmi3SetFloat64(law, &raw const angle, 1, &f64::NAN, 1),
        fmi3GetFloat64(law, null(), 1, &raw mut value, 1),
        fmi3GetFloat64(law, &raw const angle, 1, null_mut(), 1),
        fmi3GetFloat64(law, &99, 1, &raw mut value, 1),
        fmi3GetBoolean(law, &raw const angle, 1, &mut false, 1),
        fmi3EnterEventMode(law),
        fmi3GetFMUState(law, null_mut()),
        fmi3SetTime(law, 0.0),
    ] {
        assert_eq!(wrong, Error);
    }
    assert_eq!(said.len(), 15, "{said:?}");
    said.clear();
    // The law's half warns once if a step has several control periods.
    assert_eq!(step(law, 0.0, 4.0 * period_s), Done);
    assert_eq!(is_told(&mut said), fmi3Status::Warning);
    assert_eq!(step(law, 4.0 * period_s, 4.0 * period_s), Done);
    assert_eq!(fmi3Reset(law), Done);
    assert_eq!(get(law, Name::Time), 0.0);
    assert!(said.is_empty(), "{said:?}");
    fmi3FreeInstance(law);
    // Without an instance, every call is an error.
    fmi3FreeInstance(null_mut());
    for wrong in [
        fmi3DoStep(
            null_mut(),
            0.0,
            period_s,
            true,
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
        ),
        fmi3Reset(null_mut()),
        fmi3GetFloat64(null_mut(), &raw const angle, 1, &raw mut value, 1),
        fmi3GetClock(null_mut(), null(), 0, null_mut()),
    ] {
        assert_eq!(wrong, Error);
    }
    assert!(
        fmi3InstantiateModelExchange(null(), null(), null(), false, false, null_mut(), null())
            .is_null()
    );
    assert_eq!(token.matches("law").count(), 1);
}

/// The guard of this scene relies on the angle at which the torque changed. The law's half warns once if that angle is never set.
#[test]
fn a_law_without_the_angle_at_the_change_of_torque_warns_once() {
    let sets = [
        "timing.computational_delay_s=1e-4",
        "law.guard.delay_s=1e-4",
        "law.guard.change=measured",
    ];
    let scene = Scene::load("tap").expect("a scene");
    let scene = scene.with_overrides(&sets).expect("a scene");
    let (folder, token) = resources("change", &scene, Half::Law);
    let period_s = scene.timing.period_s();
    for is_set in [false, true] {
        let mut said = Said::new();
        let law = made(&folder, &token, &mut said);
        assert_eq!(fmi3ExitInitializationMode(law), Done);
        for tick in 0..3 {
            if is_set {
                set(law, Name::MeasuredChange, 0.1);
            }
            assert_eq!(step(law, f64::from(tick) * period_s, period_s), Done);
        }
        assert_eq!(said.len(), usize::from(!is_set), "{said:?}");
        fmi3FreeInstance(law);
    }
}

/// Checks that random calls with odd numbers, in any order, end no instance fatally. Every output is finite, until a step was
/// refused because the device is too far away.
#[test]
fn random_calls_are_harmless() {
    let scene = Scene::load("thesis-knob").expect("a scene");
    let mut said = Said::new();
    let instances = Half::ALL.map(|half| {
        let (folder, token) = resources("random", &scene, half);
        made(&folder, &token, &mut said)
    });
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let odd = [
        0.0,
        -0.0,
        1e-300,
        1.0,
        -3.0,
        1e9,
        -1e300,
        f64::NAN,
        f64::INFINITY,
        f64::MAX,
    ];
    let (mut time_s, mut far, mut steps) = ([0.0; 2], [false; 2], 0);
    let period_s = scene.timing.period_s();
    for _ in 0..100_000 {
        let which = (random() % 2) as usize;
        let (instance, odd) = (instances[which], odd[(random() % 10) as usize]);
        let reference = (random() % 20) as u32;
        let mut value = odd;
        let one = &raw const reference;
        let status = match random() % 16 {
            0 => fmi3ExitInitializationMode(instance),
            1 if random() % 50 == 0 => {
                (time_s[which], far[which]) = (0.0, false);
                fmi3Reset(instance)
            }
            2 => fmi3EnterInitializationMode(instance, true, odd, 0.0, true, odd),
            3 if random() % 50 == 0 => fmi3Terminate(instance),
            4 => step(instance, odd, odd),
            5 => fmi3GetBoolean(instance, one, 1, &mut false, 1),
            6 | 7 => fmi3GetFloat64(instance, one, 1, &raw mut value, 1),
            8..=10 => fmi3SetFloat64(instance, one, 1, &raw const value, 1),
            _ => {
                let status = step(instance, time_s[which], period_s);
                if status == Done {
                    time_s[which] += period_s;
                    steps += 1;
                }
                status
            }
        };
        if status == Done && !far[which] {
            assert!(
                odd.is_nan() || odd.is_infinite() || value.is_finite(),
                "{reference}: {value}"
            );
        }
        said.retain(|(status, text)| {
            assert_ne!(*status, fmi3Status::Fatal, "{text}");
            far[which] |= text.contains("the device is at");
            false
        });
    }
    assert!(steps > 1000, "{steps}");
    for instance in instances {
        fmi3FreeInstance(instance);
    }
}
