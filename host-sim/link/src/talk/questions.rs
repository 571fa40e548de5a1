//! The queue of requests to a device. One request at a time is sent; it is repeated if its answer is lost.

use std::collections::VecDeque;
use touchstone_protocol::frame::{self, FRAME_MAX};
use touchstone_protocol::{DeviceCommand, Request, ToDevice};

/// Longest wait for the device's answer, ms. An answer takes some milliseconds; erasing a flash page delays it by 25 ms.
pub const ANSWER_LIMIT_MS: f64 = 500.0;
/// Number of times that a request is sent before it counts as unanswered.
pub const TRIES: u32 = 3;
/// Longest wait for the answer to a command that switches the device off, ms. Carrying it out twice does no harm.
pub const OFF_LIMIT_MS: f64 = 100.0;
/// Number of times that a command that switches the device off is sent before it counts as unanswered.
pub const OFF_TRIES: u32 = 50;

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
    /// Whether the request is a command that switches the device off.
    is_off: bool,
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
    /// Starts a conversation: drops all earlier requests, except commands that switch the device off.
    pub fn begin(&mut self) {
        self.under_way.retain(|question| question.is_off);
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

    /// Sends the next request of the queue if no earlier request still waits for its answer. A command that switches the device off
    /// holds no request up.
    pub fn send(&mut self, now_ms: f64) {
        if self.under_way.iter().all(|question| question.is_off) {
            self.send_first(now_ms);
        }
    }

    /// Whether the queue holds a request.
    pub fn wait(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Call when an answer with the number `id` arrived. Returns the purpose of its request, and whether the request was to switch the
    /// device off; `None` if the answer came too late.
    pub fn answered(&mut self, id: u8) -> Option<(Purpose, bool)> {
        let at = self.under_way.iter().position(|asked| asked.id == id)?;
        let question = self.under_way.remove(at);
        Some((question.purpose, question.is_off))
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

    /// Drops all requests and returns their purposes, so that the page can report them as failed. `keep_off` keeps the commands that
    /// switch the device off and are still repeated.
    pub fn forget(&mut self, keep_off: bool) -> Vec<Purpose> {
        let under_way = std::mem::take(&mut self.under_way);
        let all = under_way.into_iter().chain(self.waiting.drain(..));
        let (kept, dropped): (Vec<_>, Vec<_>) =
            all.partition(|question| keep_off && question.is_off);
        self.under_way = kept;
        dropped
            .into_iter()
            .map(|question| question.purpose)
            .collect()
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
        let is_off = matches!(
            request,
            Request::Command(DeviceCommand::Stop | DeviceCommand::Disarm)
        );
        Question {
            id,
            frame: frame.to_vec(),
            purpose,
            is_off,
            // Another command that is carried out twice may have another effect; a second `Save` wears the flash.
            tries_left: match request {
                _ if is_off => OFF_TRIES,
                Request::Command(_) | Request::Save => 1,
                _ => TRIES,
            },
            until_ms: f64::INFINITY,
        }
    }

    fn send_first(&mut self, now_ms: f64) {
        if let Some(mut question) = self.waiting.pop_front() {
            question.tries_left -= 1;
            let limit_ms = if question.is_off {
                OFF_LIMIT_MS
            } else {
                ANSWER_LIMIT_MS
            };
            question.until_ms = now_ms + limit_ms;
            self.out.extend_from_slice(&question.frame);
            self.under_way.push(question);
        }
    }
}
