//! Generates images of a device's settings as stored in flash: valid ones, damaged ones, and random bytes. Checks that an accepted
//! image passes the settings' check, and is the same after it is stored again.

use super::choices::Choices;
use touchstone_control::Si;
use touchstone_drive::wire::checked;
use touchstone_protocol::frame::crc_of;
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::stored::{self, IMAGE_MAX};
use touchstone_protocol::{Board, DeviceSettings, KeptStart, Surround};

const BOARD: Board = Board::NucleoG474re;

fn check(settings: &DeviceSettings) -> Result<(), SettingsError> {
    checked(settings, BOARD)
}

/// Makes a random image of settings with up to three damages. Most get a correct checksum afterwards, so that the content is tested
/// too.
pub fn made(seeded: &mut impl Choices) -> Vec<u8> {
    let mut settings = DeviceSettings::defaults(BOARD);
    settings.wall.k_desired_n_m_per_rad = Si::from_num(seeded.below(30) as i32);
    let kept = KeptStart {
        autostart: seeded.below(2) == 1,
        ..KeptStart::default()
    };
    let mut buffer = [0; IMAGE_MAX];
    let image = stored::encode_with(&settings, &Surround::default(), &kept, None, &mut buffer);
    let mut bytes = image.expect("room").to_vec();
    for _ in 0..seeded.below(4) {
        let at = seeded.below(bytes.len());
        match seeded.below(4) {
            0 => bytes[at] ^= 1 << seeded.below(8),
            1 => bytes[at] = [0, 0xff][seeded.below(2)],
            2 => bytes.truncate(at + 1),
            _ => bytes.insert(at, seeded.below(256) as u8),
        }
    }
    if seeded.below(8) != 0 {
        seal(&mut bytes);
    }
    bytes
}

/// Writes the correct checksum into the last four bytes of a settings image.
pub fn seal(bytes: &mut [u8]) {
    if let Some((content, sum)) = bytes.split_last_chunk_mut::<4>() {
        *sum = crc_of(content).to_le_bytes();
    }
}

/// Whether the firmware's code accepts a settings image. Asserts that an accepted image passes the settings' check, and is the same
/// after it is stored again.
pub fn is_taken(bytes: &[u8]) -> bool {
    let Ok(start) = stored::decode_with(bytes, &check) else {
        let start = stored::start(Some(bytes), DeviceSettings::defaults(BOARD), &check);
        assert!(start.refused.is_some() && start.settings == DeviceSettings::defaults(BOARD));
        return false;
    };
    assert_eq!(check(&start.settings), Ok(()));
    let mut buffer = [0; IMAGE_MAX];
    let (around, cogging) = (&start.environment, start.cogging.as_ref());
    let again = stored::encode_with(&start.settings, around, &start.kept, cogging, &mut buffer);
    let again = again.expect("room").to_vec();
    assert_eq!(stored::decode_with(&again, &check), Ok(start));
    true
}
