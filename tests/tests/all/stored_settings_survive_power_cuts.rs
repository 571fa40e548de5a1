//! Tests the settings that a board stores in flash: a power cut during any write or erase loses only that write, and damaged
//! settings are refused.

use touchstone_control::Si;
use touchstone_control::environment::{
    CentreSettings, ClickSettings, DrySettings, FeelSettings, InertiaSettings, MOST_POINTS, Shape,
    Spacing, ViscousSettings, WHOLE,
};
use touchstone_drive::wire::checked;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::settings::environment::{
    DetentsBeside, ENVIRONMENT_MAX, Points, ProfileBeside, TravelEnds, WallBeside,
};
use touchstone_protocol::settings::kept::MeasuredWith;
use touchstone_protocol::settings::parts::Parts;
use touchstone_protocol::stored::{self, IMAGE_MAX, LAYOUT_VERSION, Refused, Start};
use touchstone_protocol::{
    Board, CoggingHarmonic, CoggingMap, Decimal, DeviceSettings, KeptAlignment, KeptCogging,
    KeptStart, Surround, flash,
};
use touchstone_tests::flash::Flash;
use touchstone_tests::random::Random;

/// Number of flash pages in which the boards store settings.
const PAGES: usize = 8;
/// Number of times that the tests store settings: enough to use every flash page more than once.
const SAVES: u16 = 200;
const BOARD: Board = Board::NucleoG474re;

fn check(settings: &DeviceSettings) -> Result<(), SettingsError> {
    checked(settings, BOARD)
}

/// Settings that are different for each number.
fn settings(number: u16) -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(BOARD);
    settings.wall.k_desired_n_m_per_rad = Si::from_num(number);
    settings
}

/// Data for the next start (alignment and autostart) that are stored with the settings of this number.
fn kept(number: u16) -> KeptStart {
    KeptStart {
        alignment: Some(KeptAlignment::new(
            number,
            number.is_multiple_of(2),
            &settings(number),
            BOARD,
        )),
        autostart: number.is_multiple_of(3),
    }
}

/// The cogging map that is stored with the settings of this number; only even numbers have one.
fn cogging(number: u16) -> Option<KeptCogging> {
    let part = |order| CoggingHarmonic {
        order,
        cos: number.cast_signed(),
        sin: -1,
    };
    number.is_multiple_of(2).then(|| KeptCogging {
        with: MeasuredWith::new(&settings(number), BOARD),
        map: CoggingMap {
            harmonics: (1..=12).map(part).collect(),
        },
    })
}

fn save(flash: &mut Flash, number: u16) -> bool {
    let mut buffer = [0; IMAGE_MAX];
    let around = Surround::default();
    let (start, map) = (kept(number), cogging(number));
    let image = stored::encode_with(
        &settings(number),
        &around,
        &start,
        map.as_ref(),
        &mut buffer,
    );
    let image = image.expect("room");
    let pages = flash.range();
    flash::save(flash, pages, image).is_ok()
}

fn load(flash: &mut Flash) -> Start {
    let pages = flash.range();
    flash::load(flash, pages, DeviceSettings::defaults(BOARD), &check)
}

/// The number of the settings in flash, 0 for none. Asserts that the settings are exactly those of this number, and that only the
/// remains of a first write are refused.
fn number_in(flash: &mut Flash) -> u16 {
    let start = load(flash);
    if start.settings == DeviceSettings::defaults(BOARD) {
        assert!(matches!(start.refused, None | Some(Refused::Damaged)));
        return 0;
    }
    assert_eq!(start.refused, None);
    let number = start.settings.wall.k_desired_n_m_per_rad.to_num();
    assert_eq!(start.settings, settings(number));
    assert_eq!(start.kept, kept(number));
    assert_eq!(start.cogging, cogging(number));
    number
}

#[test]
fn a_cut_at_any_operation_loses_nothing_but_its_write() {
    let mut flash = Flash::erased(PAGES);
    let (mut cuts, mut kept, mut random) = (0, 0, Random::new(11));
    // Numbers from 10 on, because 5 is the default stiffness, and settings with number 5 would equal the defaults.
    for number in 10..10 + SAVES {
        let before = if number == 10 { 0 } else { number - 1 };
        assert_eq!(number_in(&mut flash), before);
        let mut whole = flash.clone();
        assert!(save(&mut whole, number));
        for operation in 0..whole.operations - flash.operations {
            // An erase that is cut (the first operation) can leave any bits.
            for _ in 0..if operation == 0 { 100 } else { 2 } {
                let mut cut = flash.clone();
                cut.cut_after(operation, random.bits());
                assert!(!save(&mut cut, number), "the write was not cut");
                cuts += 1;
                // Up to three more power cuts in the following operations.
                let mut again = cut.clone();
                let mut found = before;
                for _ in 0..random.bits() % 4 {
                    again.cut_after((random.bits() % 40) as usize, random.bits());
                    let saved = save(&mut again, number + 1);
                    again.power_on();
                    found = number_in(&mut again);
                    assert!(!saved || found == number + 1);
                }
                assert!([before, number, number + 1].contains(&found), "{found}");
                // The same with steady power.
                cut.power_on();
                let found = number_in(&mut cut);
                assert!(found == before || found == number, "{found}, not {before}");
                kept += u32::from(found == before);
                assert!(save(&mut cut, number + 1), "no write after {operation}");
                assert_eq!(number_in(&mut cut), number + 1);
            }
        }
        flash = whole;
    }
    // Nearly every cut write is lost. The exceptions are cuts after the last bit that the new settings need.
    assert!(kept > cuts / 10 * 9, "{kept} of {cuts}");
    println!("{cuts} cuts, {kept} of them lost their own write, none another");
}

#[test]
fn what_is_damaged_is_refused_and_can_be_written_over() {
    let mut random = Random::new(12);
    for byte in [0x00, 0x5a, 0xa5] {
        let mut flash = Flash::erased(PAGES);
        flash.fill(byte);
        let start = load(&mut flash);
        assert_eq!(start.settings, DeviceSettings::defaults(BOARD));
        assert!(save(&mut flash, 12), "filled with {byte}");
        assert_eq!(number_in(&mut flash), 12);
    }
    let mut buffer = [0; IMAGE_MAX];
    let image = stored::encode(&settings(3), &mut buffer)
        .expect("room")
        .to_vec();
    assert_eq!(stored::decode(&image, &check), Ok(settings(3)));
    for _ in 0..20_000 {
        let mut damaged = image.clone();
        let bit = (random.bits() % (8 * image.len() as u64)) as usize;
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(stored::decode(&damaged, &check), Err(Refused::Damaged));
        let short = (random.bits() % image.len() as u64) as usize;
        assert_eq!(
            stored::decode(&image[..short], &check),
            Err(Refused::Damaged)
        );
    }
}

/// A settings image with this content and a correct checksum.
fn sealed(content: &[u8]) -> Vec<u8> {
    let sum = touchstone_protocol::frame::crc_of(content);
    [content, &sum.to_le_bytes()].concat()
}

#[test]
fn the_layout_of_a_board_without_an_environment_is_read_with_nothing_kept() {
    let mut buffer = [0; IMAGE_MAX];
    let content = postcard(&settings(4), &mut buffer);
    let image = sealed(&[&11_u16.to_le_bytes()[..], &content].concat());
    let mut flash = Flash::erased(PAGES);
    let pages = flash.range();
    flash::save(&mut flash, pages, &image).expect("room");
    let start = load(&mut flash);
    assert_eq!(start.refused, None);
    assert_eq!(start.settings, settings(4));
    assert_eq!(start.environment, Surround::default());
    assert_eq!((start.kept, start.cogging), (KeptStart::default(), None));
}

/// Checks that the longest possible environment (all walls and detents, each number as long as it can be) fits the room of
/// `ENVIRONMENT_MAX` bytes, and decodes to the same environment.
#[test]
fn the_longest_environment_has_room() {
    let long = Decimal(Si::MIN);
    let wall = WallBeside {
        at_rad: long,
        below: true,
        stiffness_n_m_per_rad: Some(long),
    };
    let longest = Surround {
        first_wall: true,
        further: [Some(wall); 3],
        endstops: Some(TravelEnds {
            lower_rad: long,
            upper_rad: long,
            stiffness_n_m_per_rad: Some(long),
        }),
        detents: Some(DetentsBeside {
            per_rev: u16::MAX,
            pitch_rad: long,
            strength_n_m: long,
            centre_rad: long,
        }),
        profile: Some(ProfileBeside {
            per_rev: u16::MAX,
            start_rad: long,
            end_rad: long,
            strength_n_m: long,
            shape: Points(Shape::new(&[-WHOLE; MOST_POINTS]).expect("a shape")),
        }),
        change_n_m_per_s: long,
        parts: Parts(FeelSettings {
            spring: Some(CentreSettings {
                centre: Si::MIN,
                stiffness: Si::MIN,
                strength: Si::MIN,
            }),
            viscous: Some(ViscousSettings {
                damping: Si::MIN,
                bandwidth_hz: Si::MIN,
            }),
            dry: Some(DrySettings {
                strength: Si::MIN,
                stretch: Si::MIN,
            }),
            click: Some(ClickSettings {
                spacing: Spacing::Pitch(Si::MIN),
                centre: Si::MIN,
                strength: Si::MIN,
                duration_s: Si::MIN,
            }),
            inertia: Some(InertiaSettings {
                inertia: Si::MIN,
                bandwidth_hz: Si::MIN,
            }),
        }),
    };
    let mut buffer = [0; IMAGE_MAX];
    let bytes = postcard(&longest, &mut buffer);
    assert!(bytes.len() <= ENVIRONMENT_MAX, "{} bytes", bytes.len());
    assert_eq!(postcard::from_bytes(&bytes), Ok(longest));
    // A profile with an invalid number of points does not decode.
    let mut short = bytes.clone();
    let parts = postcard(&longest.parts, &mut buffer).len();
    let points = bytes.len() - parts - 3 * MOST_POINTS - 1;
    short[points] = 1;
    assert!(postcard::from_bytes::<Surround>(&short[..points + 4]).is_err());
}

fn postcard(value: &impl serde::Serialize, buffer: &mut [u8]) -> Vec<u8> {
    postcard::to_slice(value, buffer).expect("room").to_vec()
}

#[test]
fn another_layout_and_settings_out_of_range_mean_defaults_and_say_so() {
    let mut buffer = [0; IMAGE_MAX];
    let image = stored::encode(&settings(3), &mut buffer)
        .expect("room")
        .to_vec();
    let content = &image[..image.len() - 4];
    assert_eq!(sealed(content), image);

    let mut other = content.to_vec();
    other[..2].copy_from_slice(&(LAYOUT_VERSION + 1).to_le_bytes());
    let start = stored::start(Some(&sealed(&other)), settings(0), &check);
    assert_eq!(start.settings, settings(0));
    assert_eq!(
        start.refused,
        Some(Refused::OtherLayout(LAYOUT_VERSION + 1))
    );

    let long = [content, &[0]].concat();
    let start = stored::start(Some(&sealed(&long)), settings(0), &check);
    assert_eq!(start.refused, Some(Refused::Damaged));

    let mut wrong = settings(3);
    wrong.limits.bus_max_v = Si::lit("49");
    let image = stored::encode(&wrong, &mut buffer).expect("room").to_vec();
    match stored::start(Some(&image), settings(0), &check).refused {
        Some(Refused::Invalid(invalid)) => {
            assert_eq!(
                invalid.to_string(),
                "limits.bus_max_v = 49 is outside 10 to 48 V"
            );
        }
        other => panic!("{other:?}"),
    }

    // Without a stored image the device starts with the defaults and reports no refusal.
    let start = stored::start(None, settings(0), &check);
    assert_eq!((start.settings, start.refused), (settings(0), None));
}

/// Checks that the settings before the newest ones do not come back by themselves. The user replaced them, so they may be wrong for
/// the motor.
#[test]
fn invalid_settings_mean_defaults_even_if_older_ones_are_valid() {
    let mut wrong = settings(12);
    wrong.limits.bus_max_v = Si::lit("49");
    let mut buffer = [0; IMAGE_MAX];
    let image = stored::encode(&wrong, &mut buffer).expect("room");
    let mut flash = Flash::erased(PAGES);
    assert!(save(&mut flash, 11));
    let pages = flash.range();
    flash::save(&mut flash, pages, image).expect("room");
    let start = load(&mut flash);
    assert_eq!(start.settings, DeviceSettings::defaults(BOARD));
    assert!(matches!(start.refused, Some(Refused::Invalid(_))));
    assert!(save(&mut flash, 13));
    assert_eq!(number_in(&mut flash), 13);
}
