//! Questions to a device: in order, one under way at a time, repeated where the answer was lost.

use std::collections::VecDeque;
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::{Request, ToDevice};

/// An answer takes some milliseconds, the erase of a flash page 25.
pub const ANSWER_LIMIT_MS: f64 = 500.0;
/// Once more where the answer was lost or damaged.
pub const TRIES: u32 = 3;

/// Purpose of a question.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Purpose {
    Hello,
    /// All settings, after the device identified itself.
    Begin,
    /// Telemetry from now on.
    Records,
    /// All settings, after a change.
    Settings,
    State,
    /// As `State`, after a lost connection; a device that is on, without a watching person, is switched off.
    FoundAgain,
    /// Switches such a device off; with words for what was done.
    Off(&'static str),
    Troubles,
    /// A person's order: its name, and the path of a setting.
    Order(String, Option<String>),
}

/// A question under way or waiting.
#[derive(Debug)]
struct Question {
    id: u8,
    frame: Vec<u8>,
    purpose: Purpose,
    tries_left: u32,
    until_ms: f64,
}

/// The questions, and the bytes to be sent for them.
#[derive(Debug, Default)]
pub(super) struct Questions {
    next_id: u8,
    under_way: Vec<Question>,
    waiting: VecDeque<Question>,
    out: Vec<u8>,
}

impl Questions {
    /// A port is open: nothing of before counts.
    pub fn begin(&mut self) {
        self.under_way.clear();
        self.waiting.clear();
        self.out.clear();
        // Ends whatever noise or half a frame was before.
        self.out.push(0);
    }

    /// Adds a question behind those that wait.
    pub fn ask(&mut self, request: &Request<'_>, purpose: Purpose) {
        let question = self.question(request, purpose);
        self.waiting.push_back(question);
    }

    /// Sends a question at once, before all that wait or are under way.
    pub fn overtake(&mut self, request: &Request<'_>, purpose: Purpose, now_ms: f64) {
        let question = self.question(request, purpose);
        self.waiting.push_front(question);
        self.send_first(now_ms);
    }

    /// Sends the next question if none is under way.
    pub fn send(&mut self, now_ms: f64) {
        if self.under_way.is_empty() {
            self.send_first(now_ms);
        }
    }

    /// Whether one waits.
    pub fn wait(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Purpose of the question with this number; `None` if its answer comes too late.
    pub fn answered(&mut self, id: u8) -> Option<Purpose> {
        let at = self.under_way.iter().position(|asked| asked.id == id)?;
        Some(self.under_way.remove(at).purpose)
    }

    /// Repeats a question that was not answered in time; returns one that was repeated often enough.
    pub fn overdue(&mut self, now_ms: f64) -> Option<Purpose> {
        let late = |asked: &Question| asked.until_ms <= now_ms;
        while let Some(at) = self.under_way.iter().position(late) {
            let question = self.under_way.remove(at);
            if question.tries_left == 0 {
                return Some(question.purpose);
            }
            self.waiting.push_front(question);
            self.send_first(now_ms);
        }
        None
    }

    /// The questions that will have no answer.
    pub fn forget(&mut self) -> Vec<Purpose> {
        let under_way = self.under_way.drain(..);
        let all = under_way.chain(self.waiting.drain(..));
        all.map(|question| question.purpose).collect()
    }

    /// The bytes to be sent, which are then removed.
    pub fn out(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    fn question(&mut self, request: &Request<'_>, purpose: Purpose) -> Question {
        let id = self.next_id;
        self.next_id = id.wrapping_add(1);
        let mut buffer = [0; FRAME_MAX];
        let message = ToDevice {
            id,
            request: request.clone(),
        };
        // The longest request fits, which is a test of the protocol's.
        let frame = frame::encode(&message, &mut buffer).unwrap_or_default();
        Question {
            id,
            frame: frame.to_vec(),
            purpose,
            // A command that is carried out twice is another command; a second `Save` wears the flash.
            tries_left: match request {
                Request::Command(_) | Request::Save => 1,
                _ => TRIES,
            },
            until_ms: f64::INFINITY,
        }
    }

    fn send_first(&mut self, now_ms: f64) {
        if let Some(mut question) = self.waiting.pop_front() {
            question.tries_left -= 1;
            question.until_ms = now_ms + ANSWER_LIMIT_MS;
            self.out.extend_from_slice(&question.frame);
            self.under_way.push(question);
        }
    }
}
