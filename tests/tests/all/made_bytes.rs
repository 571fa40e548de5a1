//! Tests the reading of random bytes from the serial line and random settings images. The generators are those of the fuzzer, with
//! seeds.

#[path = "../../made/choices.rs"]
mod choices;
#[path = "../../made/image.rs"]
mod image;
#[path = "../../made/wire.rs"]
mod wire;

use choices::Seeded;

const NUMBER: usize = 50_000;

#[test]
fn made_frames_are_messages_or_nothing() {
    let mut seeded = Seeded(51);
    let each = |_| wire::messages(&wire::made(&mut seeded));
    let messages: usize = (0..NUMBER).map(each).sum();
    println!("{messages} messages of {NUMBER} pieces of the wire");
    assert!(messages > NUMBER / 4);
}

#[test]
fn made_images_are_taken_or_refused() {
    let mut seeded = Seeded(52);
    let taken = (0..NUMBER)
        .filter(|_| image::is_taken(&image::made(&mut seeded)))
        .count();
    println!("{taken} of {NUMBER} images were taken");
    assert!(taken > NUMBER / 10 && taken < NUMBER - NUMBER / 10);
}
