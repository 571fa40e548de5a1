//! Switches a device off over a link that loses frames: sends the command until the device reports that it is off.

use super::Client;
use touchstone_link::told;
pub use touchstone_link::told::MAY_BE_ON;
use touchstone_protocol::{DeviceCommand, Reply, Request};
use touchstone_sim::error::{Error, Result};

/// Number of attempts to switch the device off before it counts as out of reach: some ten seconds if no answer arrives.
const ROUNDS: u32 = 20;

impl Client {
    /// Switches the device off if it moves or may move the shaft, and checks that it is off. Returns a description of what was
    /// done; `None` if the device was off already.
    ///
    /// If no answer arrives, the command to stop is sent nevertheless, because only the answer may be lost.
    ///
    /// # Errors
    /// The device did not confirm. It may still be on.
    pub fn switch_off(&mut self) -> Result<Option<&'static str>> {
        let mut done = None;
        for _ in 0..ROUNDS {
            match self.exchange(&Request::Status) {
                Ok(Some(Ok(Reply::Status(status)))) => match told::switched_off(status.phase) {
                    None => return Ok(done),
                    Some((command, words)) => {
                        done = Some(words);
                        self.post_off(command)?;
                    }
                },
                // `Stop` switches the device off in every state. A device that was off already then needs a calibration before
                // the next arming.
                Ok(_) => {
                    self.post_off(DeviceCommand::Stop)?;
                }
                Err(error) => return Err(self.may_be_on(&error.to_string())),
            }
        }
        Err(self.may_be_on("it does not answer"))
    }

    /// Switches the motor on (arms the device). If no answer arrives, switches it off again, because only the answer may be lost.
    /// Returns a refusal as the inner error.
    ///
    /// # Errors
    /// No connection or no answer. The error says that the device may still be on if nothing confirms that it is off.
    pub fn arm(&mut self) -> Result<Result<()>> {
        match self.ask_or_refusal(&Request::Command(DeviceCommand::Arm)) {
            Ok(answer) => Ok(answer.map(|_| ())),
            Err(error) => Err(self.left_off(error)),
        }
    }

    /// Sends a command that switches the device off. If its answer is lost, continues as [`Self::switch_off`].
    ///
    /// # Errors
    /// The device refused the command, or did not confirm. It may still be on.
    pub fn stop_by(&mut self, command: DeviceCommand) -> Result<()> {
        match self.exchange(&Request::Command(command)) {
            Ok(Some(Ok(_))) => Ok(()),
            Ok(Some(Err(refusal))) => Err(self.refused(&refusal)),
            Ok(None) => self.switch_off().map(|_| ()),
            Err(error) => Err(self.may_be_on(&error.to_string())),
        }
    }

    /// Switches the device off after a failure that ends a command. Returns the failure, which says that the device may still be on
    /// if nothing confirms that it is off.
    #[must_use]
    pub fn left_off(&mut self, failure: Error) -> Error {
        if failure.to_string().contains(MAY_BE_ON) || self.switch_off().is_ok() {
            return failure;
        }
        match failure {
            Error::Device {
                place,
                problem,
                fix,
            } => may_be_on(place, &problem, &fix),
            other => self.may_be_on(&other.to_string()),
        }
    }

    /// Sends a command that switches the device off, without waiting for its answer.
    fn post_off(&mut self, command: DeviceCommand) -> Result<()> {
        match self.post(&Request::Command(command)) {
            Ok(_) => Ok(()),
            Err(error) => Err(self.may_be_on(&error.to_string())),
        }
    }

    fn may_be_on(&self, why: &str) -> Error {
        self.wrong(
            format!("{MAY_BE_ON}: {why}"),
            "switch its power off, or pull its plug",
        )
    }
}

/// The error that a device may still be on after a failure. `problem` describes the failure; `fix` is its remedy, once the device
/// is off.
#[must_use]
pub fn may_be_on(place: String, problem: &str, fix: &str) -> Error {
    Error::Device {
        place,
        problem: format!("{MAY_BE_ON}: {problem}"),
        fix: format!("switch its power off, or pull its plug; then {fix}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::nobody;
    use super::{Client, MAY_BE_ON};
    use crate::{Received, Transport};
    use std::collections::VecDeque;
    use std::sync::{Arc, Mutex};
    use touchstone_protocol::frame::{self, Decoder, FRAME_MAX};
    use touchstone_protocol::{
        DeviceCommand, FromDevice, Phase, Refusal, Reply, Request, Status, ToDevice,
    };
    use touchstone_sim::error::{Error, Result};

    /// A simulated device behind a link that loses or damages frames at random. A seed gives the random numbers.
    struct Link {
        phase: Arc<Mutex<Phase>>,
        chance: u64,
        /// Percentage of frames that do not arrive, of requests and of answers. Half of these requests are lost, the others
        /// damaged; these answers are all lost.
        lost: [u64; 2],
        decoder: Decoder,
        answers: VecDeque<u8>,
        /// Number of requests that can be written before writing fails, as after a pulled cable.
        writes: usize,
    }

    impl Link {
        fn draw(&mut self) -> u64 {
            self.chance ^= self.chance << 13;
            self.chance ^= self.chance >> 7;
            self.chance ^= self.chance << 17;
            self.chance % 100
        }

        fn answer(&mut self, message: &ToDevice<'_>) {
            let mut phase = self.phase.lock().expect("one thread");
            let answer = match (&message.request, *phase) {
                (Request::Status, now) => Ok(Reply::Status(Status {
                    phase: now,
                    fault: None,
                    tick: 0,
                    unsaved: false,
                })),
                (Request::Command(DeviceCommand::Stop), _) => {
                    *phase = Phase::Stopped;
                    Ok(Reply::Done)
                }
                (Request::Command(DeviceCommand::Disarm), Phase::Armed) => {
                    *phase = Phase::Ready;
                    Ok(Reply::Done)
                }
                (Request::Command(DeviceCommand::Arm), Phase::Ready) => {
                    *phase = Phase::Armed;
                    Ok(Reply::Done)
                }
                (_, now) => Err(Refusal::NotNow(now)),
            };
            drop(phase);
            if self.draw() < self.lost[1] {
                return;
            }
            let mut buffer = [0; FRAME_MAX];
            let reply = FromDevice::Answer {
                id: message.id,
                answer,
            };
            let frame = frame::encode(&reply, &mut buffer).expect("it fits");
            self.answers.extend(frame.iter());
        }
    }

    impl Transport for Link {
        fn receive(&mut self, buffer: &mut [u8]) -> Result<Received> {
            if self.answers.is_empty() {
                std::thread::sleep(std::time::Duration::from_millis(1));
                return Ok(Received::Quiet);
            }
            let count = self.answers.len().min(buffer.len());
            for (place, byte) in buffer.iter_mut().zip(self.answers.drain(..count)) {
                *place = byte;
            }
            Ok(Received::Bytes(count))
        }

        fn send(&mut self, bytes: &[u8]) -> Result<()> {
            self.writes = self
                .writes
                .checked_sub(1)
                .ok_or_else(|| Error::device("test", "the cable was pulled", "plug it in"))?;
            let mut bytes = bytes.to_vec();
            match self.draw() {
                drawn if drawn < self.lost[0] / 2 => return Ok(()),
                drawn if drawn < self.lost[0] => {
                    let middle = bytes.len() / 2;
                    bytes[middle] ^= 0x55;
                }
                _ => {}
            }
            for byte in bytes {
                let Some(Ok(payload)) = self.decoder.push(byte) else {
                    continue;
                };
                let payload = payload.to_vec();
                if let Some(message) = frame::message::<ToDevice<'_>>(&payload) {
                    self.answer(&message);
                }
            }
            Ok(())
        }
    }

    fn client(seed: u64, lost: [u64; 2], begun: Phase) -> (Client, Arc<Mutex<Phase>>) {
        client_that_writes(usize::MAX, seed, lost, begun)
    }

    fn client_that_writes(
        writes: usize,
        seed: u64,
        lost: [u64; 2],
        begun: Phase,
    ) -> (Client, Arc<Mutex<Phase>>) {
        let phase = Arc::new(Mutex::new(begun));
        let link = Link {
            phase: Arc::clone(&phase),
            chance: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1,
            lost,
            decoder: Decoder::new(),
            answers: VecDeque::new(),
            writes,
        };
        let client = Client {
            transport: Box::new(link),
            place: "test".into(),
            decoder: Decoder::new(),
            next_id: 0,
            telemetry: VecDeque::new(),
            identity: nobody(),
            answer_limit: std::time::Duration::from_millis(3),
        };
        (client, phase)
    }

    fn is_off(phase: &Mutex<Phase>) -> bool {
        !matches!(
            *phase.lock().expect("one thread"),
            Phase::Armed | Phase::Calibrating
        )
    }

    #[test]
    fn whatever_the_link_loses_the_device_is_off_or_the_error_says_that_it_may_be_on() {
        let (mut confirmed, mut unsure) = (0, 0);
        for seed in 1..=1_000 {
            let lost = [(seed % 11) * 10, (seed / 11 % 11) * 10];
            let begun = if seed % 3 == 0 {
                Phase::Calibrating
            } else {
                Phase::Armed
            };
            let (mut client, phase) = client(seed, lost, begun);
            let ended = match seed % 4 {
                0 | 2 => client.switch_off().map(|_| ()),
                1 => client.tell(&Request::Command(DeviceCommand::Stop)),
                _ => client.stop_by(DeviceCommand::Stop),
            };
            match ended {
                Ok(()) => {
                    confirmed += 1;
                    assert!(is_off(&phase), "seed {seed}: armed and silent");
                }
                Err(error) => {
                    unsure += 1;
                    assert!(error.to_string().contains(MAY_BE_ON), "{error}");
                }
            }
        }
        // Both results must occur often: about one seed in six loses all frames in one direction.
        assert!(confirmed > 500 && unsure > 100, "{confirmed}, {unsure}");
    }

    #[test]
    fn arming_whose_answer_is_lost_leaves_no_device_on() {
        for seed in 1..=200 {
            let (mut client, phase) = client(seed, [0, 50], Phase::Ready);
            match client.arm() {
                Ok(answer) => assert!(answer.is_ok() && !is_off(&phase), "seed {seed}"),
                Err(_) => assert!(is_off(&phase), "seed {seed}: armed and silent"),
            }
        }
        // A refusal disturbs nothing, such as a calibration.
        let (mut client, phase) = client(7, [0, 0], Phase::Calibrating);
        assert!(client.arm().expect("an answer").is_err());
        assert_eq!(*phase.lock().expect("one thread"), Phase::Calibrating);
    }

    #[test]
    fn a_device_that_hears_but_cannot_answer_is_off_all_the_same() {
        let (mut client, phase) = client(7, [0, 100], Phase::Armed);
        let error = client.switch_off().expect_err("no answer came");
        assert!(error.to_string().contains(MAY_BE_ON), "{error}");
        assert!(is_off(&phase));
    }

    /// Lets the cable be pulled after the question for the status, once with an answer to it and once without.
    #[test]
    fn a_command_that_cannot_be_written_says_that_the_device_may_be_on() {
        for lost in [[0, 0], [0, 100]] {
            let (mut client, _) = client_that_writes(1, 7, lost, Phase::Armed);
            let error = client.switch_off().expect_err("the cable was pulled");
            let said = error.to_string();
            assert_eq!(said.matches(MAY_BE_ON).count(), 1, "{said}");
            assert!(said.contains("the cable was pulled"), "{said}");
        }
    }

    #[test]
    fn a_failed_command_leaves_the_device_off_or_says_that_it_may_be_on() {
        let failure = |client: &Client| client.wrong("the step failed", "the same command again");
        for (lost, is_sure) in [([0, 0], true), ([30, 30], true), ([0, 100], false)] {
            let (mut client, phase) = client(5, lost, Phase::Calibrating);
            let failed = failure(&client);
            let said = client.left_off(failed).to_string();
            assert!(is_off(&phase), "{lost:?}");
            assert!(said.contains("the step failed") && said.contains("the same command again"));
            assert_eq!(said.contains(MAY_BE_ON), !is_sure, "{said}");
        }
        let (mut client, _) = client(5, [100, 0], Phase::Calibrating);
        let failed = failure(&client);
        let said = client.left_off(failed);
        let again = client.left_off(said).to_string();
        assert_eq!(again.matches(MAY_BE_ON).count(), 1, "{again}");
    }

    #[test]
    fn a_refusal_stays_a_refusal_and_a_device_at_rest_is_left_alone() {
        let (mut client, phase) = client(7, [0, 0], Phase::Ready);
        assert!(client.switch_off().expect("a link without loss").is_none());
        assert_eq!(*phase.lock().expect("one thread"), Phase::Ready);
        let error = client
            .stop_by(DeviceCommand::Disarm)
            .expect_err("not armed");
        assert!(!error.to_string().contains(MAY_BE_ON), "{error}");
    }
}
