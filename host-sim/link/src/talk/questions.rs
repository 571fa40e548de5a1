//! The queue of requests to a device. One request at a time is sent; it is repeated if its answer is lost.

use std::collections::VecDeque;
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::{Request, ToDevice};

/// Longest wait for the device's answer, ms. An answer takes some milliseconds; erasing a flash page delays it by 25 ms.
pub const ANSWER_LIMIT_MS: f64 = 500.0;
/// Number of times that a request is sent before it counts as unanswered.
pub const TRIES: u32 = 3;

/// The purpose of a request to the device, which decides what is done with the answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Purpose {
    Hello,
    /// Get all settings, after the device has identified itself.
    Begin,
    /// Start the telemetry.
    Records,
    /// Get all settings, after one was changed.
    Settings,
    State,
    /// Get the device's state after a lost connection. A device whose motor is on is then switched off, because no program watched
    /// it during the loss.
    FoundAgain,
    /// Switch off a device whose motor was on after a lost connection. Holds a message about it for the user.
    Off(&'static str),
    Troubles,
    /// Carry out a command that a person gave. Holds the command's name, and the path of the setting that it changes.
    Order(String, Option<String>),
}

/// A request in the queue or without its answer yet.
#[derive(Debug)]
struct Question {
    id: u8,
    frame: Vec<u8>,
    purpose: Purpose,
    tries_left: u32,
    until_ms: f64,
}

/// The queue of requests to the device, and the bytes to send.
#[derive(Debug, Default)]
pub(super) struct Questions {
    next_id: u8,
    under_way: Vec<Question>,
    waiting: VecDeque<Question>,
    out: Vec<u8>,
}

impl Questions {
    /// Starts a conversation on a newly opened port: drops all earlier requests.
    pub fn begin(&mut self) {
        self.under_way.clear();
        self.waiting.clear();
        self.out.clear();
        // A zero byte ends noise or half a frame that came before.
        self.out.push(0);
    }

    /// Adds a request to the device to the end of the queue.
    pub fn ask(&mut self, request: &Request<'_>, purpose: Purpose) {
        let question = self.question(request, purpose);
        self.waiting.push_back(question);
    }

    /// Sends a request at once, before all requests in the queue and the request that still waits for its answer.
    pub fn overtake(&mut self, request: &Request<'_>, purpose: Purpose, now_ms: f64) {
        let question = self.question(request, purpose);
        self.waiting.push_front(question);
        self.send_first(now_ms);
    }

    /// Sends the next request of the queue if no earlier request still waits for its answer.
    pub fn send(&mut self, now_ms: f64) {
        if self.under_way.is_empty() {
            self.send_first(now_ms);
        }
    }

    /// Whether the queue holds a request.
    pub fn wait(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Call when an answer with the number `id` arrived. Returns the purpose of its request; `None` if the answer came too late.
    pub fn answered(&mut self, id: u8) -> Option<Purpose> {
        let at = self.under_way.iter().position(|asked| asked.id == id)?;
        Some(self.under_way.remove(at).purpose)
    }

    /// Sends each request again whose answer is overdue. If all attempts of a request failed, removes it and returns its purpose;
    /// `None` if there is no such request.
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

    /// Drops all requests and returns their purposes, so that the page can report them as failed.
    pub fn forget(&mut self) -> Vec<Purpose> {
        let under_way = self.under_way.drain(..);
        let all = under_way.chain(self.waiting.drain(..));
        all.map(|question| question.purpose).collect()
    }

    /// Returns the bytes to send to the device and removes them.
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
        // The longest request fits into the buffer; a test of the protocol checks it.
        let frame = frame::encode(&message, &mut buffer).unwrap_or_default();
        Question {
            id,
            frame: frame.to_vec(),
            purpose,
            // A command that is carried out twice may have another effect; a second `Save` wears the flash.
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
