//! A page that is open in the browser: sends it batches of records, carries out its commands, and checks that it still answers.

use super::device_side::{DeviceSide, News};
use super::door::Socket;
use crate::stream::SIGN_OF_LIFE;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::ErrorKind;
use std::time::{Duration, Instant};
use touchstone_link::told;
use touchstone_protocol::DeviceCommand;
use touchstone_sim::error::{Error, Result};
use tungstenite::Message;

/// Time between two batches of records that are sent to the page.
const BATCH: Duration = Duration::from_millis(33);
/// Time after which a page that has not acknowledged a batch counts as hung. A person could not stop the device with a hung page,
/// so the device is switched off.
const HANGS: Duration = Duration::from_secs(2);
/// Largest number of batches that were sent and not yet acknowledged by the page.
const UNSEEN: u32 = 30;
/// Interval at which the device's counters of lost and damaged records are read.
const LOOK: Duration = Duration::from_secs(2);

/// A page that is open in a browser, with its WebSocket and the times of its messages.
pub struct Visitor {
    socket: Socket,
    batch: u32,
    seen: u32,
    seen_at: Instant,
    sent_at: Instant,
    looked_at: Instant,
    spoken_at: Instant,
}

/// Reason why the page counts as gone, as text.
pub type Gone = &'static str;

impl Visitor {
    pub fn new(socket: Socket, link: &mut DeviceSide) -> Self {
        let now = Instant::now();
        let mut visitor = Self {
            socket,
            batch: 0,
            seen: 0,
            seen_at: now,
            sent_at: now,
            looked_at: now,
            spoken_at: now,
        };
        link.rows.take(0);
        // If the page is gone already, its first turn notices that.
        let _ = visitor.say(&link.hello());
        let _ = visitor.state(link);
        visitor
    }

    /// Runs one pass of the loop: carries out the page's commands, and sends the page records and news of the device.
    ///
    /// # Errors
    /// The page is gone; holds the reason.
    pub fn turn(&mut self, link: &mut DeviceSide, news: News) -> std::result::Result<(), Gone> {
        self.listen(link)?;
        // Checked after all messages of the page were read: a slow device must not make the page look hung.
        if self.seen != self.batch && self.seen_at.elapsed() > HANGS {
            return Err("the page does not answer");
        }
        self.tell(link, news)?;
        if self.sent_at.elapsed() >= BATCH {
            self.sent_at = Instant::now();
            self.send_rows(link)?;
        }
        // The device gets requests, which keep its host watchdog from switching it off, only while the page answers.
        if self.spoken_at.elapsed() >= SIGN_OF_LIFE {
            self.spoken_at = Instant::now();
            let news = link.sign_of_life();
            self.tell(link, news)?;
        }
        if self.looked_at.elapsed() >= LOOK {
            self.looked_at = Instant::now();
            if let Ok((dropped, damaged)) = link.troubles() {
                self.say(&told::troubles(dropped, damaged))?;
            }
        }
        Ok(())
    }

    /// Sends the page a change of the device's state or connection.
    fn tell(&mut self, link: &mut DeviceSide, news: News) -> std::result::Result<(), Gone> {
        match news {
            News::None => {}
            News::State => self.state(link)?,
            News::Lost(why) => self.say(&told::connection(Some(&why), None))?,
            News::Back(done) => {
                self.say(&told::connection(None, done.as_deref()))?;
                self.say(&link.hello())?;
                self.state(link)?;
            }
        }
        Ok(())
    }

    fn send_rows(&mut self, link: &mut DeviceSide) -> std::result::Result<(), Gone> {
        // If the page is too slow, records wait here, and are dropped when there are too many.
        if self.batch.wrapping_sub(self.seen) >= UNSEEN {
            return Ok(());
        }
        // The page's time to answer runs from the first batch that it has not acknowledged.
        if self.seen == self.batch {
            self.seen_at = Instant::now();
        }
        self.batch = self.batch.wrapping_add(1);
        let rows = link.rows.take(self.batch);
        self.send(Message::binary(rows))
    }

    /// Carries out all commands that the page has sent. Before each one it reads what has arrived meanwhile: a command that switches
    /// the device off does not wait behind settings.
    fn listen(&mut self, link: &mut DeviceSide) -> std::result::Result<(), Gone> {
        let mut orders = VecDeque::new();
        loop {
            self.read_into(&mut orders)?;
            let off = orders.iter().position(switches_off).unwrap_or(0);
            let Some(order) = orders.remove(off) else {
                return Ok(());
            };
            self.order(&order, link)?;
        }
    }

    fn read_into(&mut self, orders: &mut VecDeque<Value>) -> std::result::Result<(), Gone> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    orders.push_back(serde_json::from_str(text.as_str()).unwrap_or_default());
                }
                Ok(Message::Close(_)) => {
                    // Reading has only queued the answer, without which the page takes the connection for lost (code 1006).
                    let _ = self.socket.flush();
                    return Err("the page was closed");
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    return Ok(());
                }
                Err(tungstenite::Error::Io(_) | tungstenite::Error::ConnectionClosed) => {
                    return Err("the page was closed");
                }
                // This program's page sends no such message.
                Err(_) => return Err("the page sent an invalid message"),
            }
        }
    }

    fn order(&mut self, order: &Value, link: &mut DeviceSide) -> std::result::Result<(), Gone> {
        if let Some(seen) = order["seen"].as_u64() {
            self.seen = seen as u32;
            self.seen_at = Instant::now();
            return Ok(());
        }
        let done = carry_out(order, link);
        let error = done.err().map(|error| error.to_string());
        self.say(
            &json!({ "type": "done", "do": order["do"], "path": order["path"], "error": error }),
        )?;
        // Records do not contain the settings. A refused value stays in the field in which it was written.
        if error.is_none() && matches!(order["do"].as_str(), Some("set" | "defaults")) {
            self.say(&link.hello())?;
        }
        self.state(link)
    }

    fn state(&mut self, link: &mut DeviceSide) -> std::result::Result<(), Gone> {
        match link.status() {
            Ok(status) => self.say(&told::state(&status)),
            // The next turn reports that the device does not answer.
            Err(_) => Ok(()),
        }
    }

    fn say(&mut self, value: &Value) -> std::result::Result<(), Gone> {
        self.send(Message::text(value.to_string()))
    }

    fn send(&mut self, message: Message) -> std::result::Result<(), Gone> {
        match self.socket.send(message) {
            // A message that does not fit into the socket's buffer now is sent with the next message.
            Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(_) => Err("the page was closed"),
            Ok(()) => Ok(()),
        }
    }
}

/// Whether a command of the page switches the device off.
fn switches_off(order: &Value) -> bool {
    matches!(order["do"].as_str(), Some("stop" | "disarm"))
}

/// Carries out one command of the page.
fn carry_out(order: &Value, link: &mut DeviceSide) -> Result<()> {
    let command = match order["do"].as_str() {
        Some("calibrate") => DeviceCommand::Calibrate,
        Some("arm") => DeviceCommand::Arm,
        Some("disarm") => DeviceCommand::Disarm,
        Some("stop") => DeviceCommand::Stop,
        Some("zero") => DeviceCommand::Zero,
        Some("save") => return link.save(),
        Some("defaults") => return link.defaults(),
        Some("set") => {
            let text = |name| order[name].as_str().unwrap_or("");
            return link.set(text("path"), text("value"));
        }
        _ => {
            return Err(Error::device(
                "page",
                "the page sent an unknown command",
                "load it again",
            ));
        }
    };
    link.command(command)
}
