//! `touchstone live --port`: shows a board on a page in the browser; only this machine can open the page.
//!
//! ```text
//! device -> link: records, commands -> batches 30 times a second -> page
//! ```
//!
//! This program runs between device and page. It switches the device off when the page is gone, because a wall must not stay on
//! when no person can stop it.

mod device_side;
mod door;
mod visitor;

use super::browser::open;
use super::device::warn_unwatched;
use super::interrupt::noted;
use super::out::{note, result, tell};
use device_side::DeviceSide;
use door::Door;
use std::sync::atomic::Ordering;
use touchstone_device::{Address, Client};
use touchstone_live::board_page as page;
use touchstone_sim::error::Result;
use visitor::Visitor;

/// Serves the page of the board at `address` until Ctrl-C. `opens` says whether to open the browser as well.
pub fn main(address: &Address, opens: bool) -> Result<()> {
    let stop = noted()?;
    let mut link = DeviceSide::new(address.clone(), Client::connect(address)?)?;
    warn_unwatched(&link.settings);
    let program = super::report_options::program_name();
    let door = Door::open(|socket| {
        page::render(&page::Content {
            way: page::Way::Socket(socket),
            columns: &touchstone_link::rows::COLUMNS,
            place: &address.to_string(),
            program: &program,
        })
    })?;
    result(
        || serde_json::json!({ "page": door.address, "device": address.to_string() }),
        || {
            tell!("page    {}", door.address);
            tell!("device  {address}; Ctrl-C ends it, and disarms the device");
            Ok(())
        },
    )?;
    if opens && !open(std::ffi::OsStr::new(&door.address)) {
        note!("note: no browser was found; open {} in one", door.address);
    }
    let mut page: Option<Visitor> = None;
    let mut served = false;
    while !stop.load(Ordering::Relaxed) {
        if page.is_none()
            && let Ok(socket) = door.sockets.try_recv()
        {
            served = true;
            page = Some(Visitor::new(socket, &mut link));
        }
        let news = link.turn();
        let Some(visitor) = &mut page else { continue };
        if let Err(gone) = visitor.turn(&mut link, news) {
            page = None;
            door.taken.store(false, Ordering::SeqCst);
            match link.off() {
                Ok(Some(what)) => note!("note: {gone}: {what}"),
                Ok(None) => tell!("{gone}"),
                // The device may still be on, so the error is printed even with --quiet. The next page can try again.
                Err(error) => eprintln!("error: {}", super::complain::line(&error.to_string())),
            }
        }
    }
    // The page ends with this program, so no person can stop an armed device: it is switched off.
    let off = if served { link.off() } else { Ok(None) };
    if let Ok(Some(what)) = &off {
        note!("note: the program ends: {what}");
    }
    link.leave();
    off.map(|_| ())
}
